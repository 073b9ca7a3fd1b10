// The picture on the page, with its labels and legend, and the times at which it is drawn.

/** Times between two pictures, ms: above the first, drawing is slow; above the second, it is interrupted. */
const SLOW = 60;
const INTERRUPTED = 400;

/** Resolution of the canvas while drawing is slow and things move. */
const COARSE = 0.55;

/** Time at rest after which the full resolution is restored, ms. */
const REST_BEFORE_FINE = 260;

/** Ratio of width to height below which the camera moves back. */
const LEAST_RATIO = 1.2;

/**
 * Returns the factor of the camera's distance with which a narrow picture still shows the whole width.
 * @param {number} ratio of width to height
 */
const widening = (ratio) => Math.max(1, LEAST_RATIO / ratio);

class Picture {
  /**
   * @param {View} view
   * @param {HTMLCanvasElement} canvas
   * @param {(now: number) => boolean} advance advances all motions; returns whether a motion continues
   * @param {(data: boolean) => void} shown called after every picture
   */
  constructor(view, canvas, advance, shown) {
    this.view = view;
    this.canvas = canvas;
    this.advance = advance;
    this.shown = shown;
    this.stage = element("div", { class: "ss-stage" }, canvas);
    this.root = element("div", { class: "ss-viewer" }, this.stage);
    this.tip = makeTip(this.stage);
    this.labels = makeLabels(this.stage);
    this.legend = makeLegend(this.root);
    /** Whether the picture has a size yet. */
    this.isSized = false;
    /** Whether the data shown have changed since the last picture, and whether a picture is queued. */
    this.dirty = { data: true, queued: false };
    /** Time of the last picture, number of slow pictures, and resolution. */
    this.pace = { last: 0, slow: 0, coarse: 1, timer: 0 };
    /** Scale that the legend shows, px per mm. */
    this.legendScale = 0;
  }

  /** Follows the size and the colours of the page, and draws the first picture. */
  start() {
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => this.restoreGraphics());
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.setTheme(false));
    addEventListener("beforeprint", () => this.setTheme(true));
    addEventListener("afterprint", () => this.setTheme(false));
    new ResizeObserver(() => this.resize()).observe(this.stage);
    this.resize();
    this.setTheme(false);
  }

  /**
   * Requests a picture.
   * @param {boolean} data whether the buffers must be filled with changed data
   */
  request(data) {
    this.dirty.data ||= data;
    if (this.dirty.queued) return;
    this.dirty.queued = true;
    requestAnimationFrame((now) => this.tick(now));
  }

  /** @param {number} now ms */
  tick(now) {
    this.dirty.queued = false;
    this.keepPace(now);
    const goesOn = this.advance(now);
    this.render();
    if (goesOn) this.request(false);
  }

  /**
   * Lowers the resolution during motion if drawing is slow (no graphics card). Restores the resolution at
   * rest.
   * @param {number} now ms
   */
  keepPace(now) {
    const { pace } = this;
    const gap = now - pace.last;
    pace.last = now;
    if (gap <= INTERRUPTED) pace.slow = clamp(pace.slow + (gap > SLOW ? 1 : -1), 0, 4);
    if (pace.slow < 3 && pace.coarse === 1) return;
    this.fitCanvas(pace.slow < 1 ? 1 : COARSE);
    clearTimeout(pace.timer);
    pace.timer = setTimeout(() => {
      pace.slow = 2;
      this.fitCanvas(1);
      this.render();
    }, REST_BEFORE_FINE);
  }

  /**
   * Sets the resolution of the canvas.
   * @param {number} coarse share of the full resolution
   */
  fitCanvas(coarse) {
    const { view, canvas } = this;
    this.pace.coarse = coarse;
    view.ratio = Math.min(devicePixelRatio || 1, 3) * coarse;
    const [width, height] = [Math.round(view.width * view.ratio), Math.round(view.height * view.ratio)];
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
  }

  render() {
    const { view, dirty, canvas } = this;
    if (!this.isSized || view.graphics.gl.isContextLost()) return;
    const { data } = dirty;
    dirty.data = false;
    view.frames = framesAt(view.drawing.movement, view.state.time);
    view.optics = opticsOf(view);
    if (data) fillBatches(view);
    drawPicture(view, canvas.width, canvas.height);
    drawLabels(view, this.labels);
    showTip(this.tip, view);
    if (data || Math.abs(this.legendScale - view.optics.pixelsPerMm) > 1e-9) {
      this.legendScale = view.optics.pixelsPerMm;
      showLegend(this.legend, view);
    }
    if (data) this.describe();
    this.shown(data);
  }

  /** Describes the picture for screen readers. */
  describe() {
    const { cell, name } = this.view.drawing;
    const what = `Three-dimensional view of ${cell}, layout ${name}: robot, equipment and error map.`;
    this.canvas.setAttribute("aria-label", `${what} Arrow keys rotate it.`);
  }

  /** Draws again at once, after the canvas has lost its content or the colours have changed. */
  redraw() {
    this.dirty.data = true;
    this.render();
  }

  resize() {
    const { view } = this;
    const box = this.stage.getBoundingClientRect();
    const [width, height] = [Math.round(box.width), Math.round(box.height)];
    if (width < 2 || height < 2) return;
    const before = widening(view.width / view.height);
    view.width = width;
    view.height = height;
    this.fitCanvas(1);
    if (!this.isSized) view.camera = fittedCamera(view, "iso");
    else view.camera.distance *= widening(width / height) / before;
    this.isSized = true;
    this.redraw();
  }

  /**
   * Adopts the light or dark theme of the page.
   * @param {boolean} printing
   */
  setTheme(printing) {
    const dark = getComputedStyle(this.root).getPropertyValue("--ss-dark").trim() === "1";
    this.view.theme = dark && !printing ? "dark" : "light";
    this.redraw();
  }

  /** Creates everything on the graphics card again after a loss of the WebGL context. */
  restoreGraphics() {
    const { view } = this;
    view.graphics = makeGraphics(view.graphics.gl);
    for (const mesh of view.model.meshes) mesh.buffers = null;
    view.shadowKey = "";
    this.request(true);
  }
}
