// The page reads without it: the view in three dimensions takes the place of the picture, and what is
// folded opens for print.
(function () {
  "use strict";
  var host = document.getElementById("viewer");
  try {
    var shown = JSON.parse(document.getElementById("drawings").textContent);
    // The layout that is recommended comes last.
    sweetspotViewer(host, shown, { drawing: shown.drawings.length - 1 });
  } catch (e) {
    // No WebGL: the picture stays.
  }
  var folded = [];
  window.addEventListener("beforeprint", function () {
    folded = Array.prototype.slice.call(document.querySelectorAll("details:not([open])"));
    folded.forEach(function (d) { d.open = true; });
  });
  window.addEventListener("afterprint", function () {
    folded.forEach(function (d) { d.open = false; });
  });
})();
