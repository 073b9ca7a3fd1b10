// Every layout has a separate view; cameras and switches are shared. Without WebGL, the still pictures
// remain.
(() => {
  /** @type {(keyof ViewerState)[]} */
  const SHARED = ["operation", "lens", "sense", "arrows", "envelope", "robot", "solids"];

  const written = document.getElementById("drawings")?.textContent;
  if (!written || !sweetspotViewer.supported()) return;
  /** @type {DrawingDocument} */
  const drawings = JSON.parse(written);
  /** @type {HTMLElement[]} */
  const hosts = [...document.querySelectorAll(".viewer")].filter((host) => host instanceof HTMLElement);
  const views = hosts.map((host, drawing) => sweetspotViewer(host, drawings, { drawing }));
  sweetspotViewer.link(views);

  let isSharing = false;
  for (const view of views) {
    view.on("state", (state) => {
      if (isSharing) return;
      isSharing = true;
      const shared = Object.fromEntries(SHARED.map((key) => [key, state[key]]));
      for (const other of views) if (other !== view) other.show(shared);
      isSharing = false;
    });
  }
})();
