// Every layout has a view of its own; cameras and switches are shared. Without WebGL the pictures stay.
(function () {
  "use strict";
  var SHARED = ["operation", "lens", "sense", "arrows", "envelope", "robot", "solids"];
  var hosts = Array.prototype.slice.call(document.querySelectorAll(".viewer"));
  var shown = JSON.parse(document.getElementById("drawings").textContent);
  var views = [];
  try {
    hosts.forEach(function (host, k) { views.push(sweetspotViewer(host, shown, { drawing: k })); });
    sweetspotViewer.link(views);
  } catch (e) {
    return;
  }
  var busy = false;
  views.forEach(function (view) {
    view.on("state", function (state) {
      if (busy) return;
      busy = true;
      var same = {};
      SHARED.forEach(function (key) { same[key] = state[key]; });
      views.forEach(function (other) { if (other !== view) other.show(same); });
      busy = false;
    });
  });
})();
