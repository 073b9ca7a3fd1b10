// The page reads without it: the view in three dimensions takes the place of the picture, and what is
// folded opens for print.
(function () {
  "use strict";
  var host = document.getElementById("viewer");
  var still = document.getElementById("still");
  if (typeof sweetspotViewer === "function") {
    host.hidden = false;
    try {
      sweetspotViewer(host, JSON.parse(document.getElementById("drawings").textContent), {});
      still.classList.add("only-print");
    } catch (e) {
      // No WebGL: the picture stays.
      host.hidden = true;
    }
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
