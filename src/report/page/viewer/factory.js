// Entry point for a page: the global function `sweetspotViewer`.

/** Returns whether the browser offers WebGL 2. */
function isSupported() {
  try {
    return Boolean(document.createElement("canvas").getContext("webgl2"));
  } catch {
    return false;
  }
}

/**
 * Returns a viewer for a browser without WebGL: it shows nothing, and the page keeps its content.
 * @returns {SweetspotViewer}
 */
function unsupportedViewer() {
  /** @type {SweetspotViewer} */
  const viewer = {
    canvas: null,
    supported: () => false,
    show: () => viewer,
    replace: () => viewer,
    movePart: () => undefined,
    setCamera: () => undefined,
    linked: () => undefined,
    state: () => ({}),
    camera: () => ({}),
    on: () => viewer,
    project: () => null,
    pickFloor: () => null,
    pickEquipment: () => null,
    look: () => undefined,
    play: () => undefined,
  };
  return viewer;
}

/**
 * Shows a document in a host element. Without WebGL the host keeps its content.
 * @param {HTMLElement} host
 * @param {DrawingDocument} written
 * @param {ViewerOptions} [options]
 * @returns {SweetspotViewer}
 */
function makeViewer(host, written, options = {}) {
  if (!isSupported()) return unsupportedViewer();
  const canvas = element("canvas", { tabIndex: 0, role: "img" });
  let graphics;
  try {
    graphics = makeGraphics(contextOf(canvas));
  } catch (error) {
    console.warn(error);
    return unsupportedViewer();
  }
  return new Viewer(host, written, options, canvas, graphics);
}

/**
 * Makes several viewers share one camera.
 * @param {SweetspotViewer[]} viewers
 */
function linkViewers(viewers) {
  for (const viewer of viewers) {
    viewer.on("camera", (camera) => {
      for (const other of viewers) if (other !== viewer) other.linked(camera);
    });
  }
}

globalThis.sweetspotViewer = Object.assign(makeViewer, {
  supported: isSupported,
  link: linkViewers,
  nodeSigns: NODE_SIGNS,
  marks: MARKS,
});
