// The 3-D view beside the plan. The user can drag equipment in it, too.

/** Longest time to draw a picture at which the view still follows a drag in the plan, ms. */
const QUICK = 40;

/**
 * A drag in the 3-D view.
 * @typedef {object} Drag3d
 * @property {number} index of the equipment
 * @property {number} height of the point that is held, mm
 * @property {FloorPoint} start
 * @property {Placement} from
 * @property {Placement} now
 * @property {number} pointer
 */

class View3d {
  /**
   * @param {Page} page
   * @param {DrawingDocument} written
   */
  constructor(page, written) {
    this.page = page;
    this.host = byId("viewer");
    this.viewer = sweetspotViewer(this.host, written, { controls: true });
    /** @type {Drag3d | null} */
    this.held = null;
    this.isQuick = false;
    this.isLookedAt = false;
    this.copy = make("canvas", { className: "copy", hidden: true });
    this.viewer.canvas?.after(this.copy);
    afterPaint(() => afterPaint(() => this.measure(written)));
    // Sense, reading and model are chosen at the top of the page; the switches of the viewer are folded.
    for (const details of this.host.querySelectorAll("details")) details.open = false;
    this.listen();
  }

  listen() {
    const { host } = this;
    host.addEventListener("pointerdown", (event) => this.grip(event), true);
    host.addEventListener("pointermove", (event) => this.drag(event));
    host.addEventListener("pointerup", (event) => this.drop(event));
    host.addEventListener("pointercancel", (event) => this.drop(event));
    for (const begin of ["pointerenter", "focusin"]) host.addEventListener(begin, () => this.wake());
    for (const end of ["pointerleave", "focusout"]) host.addEventListener(end, () => this.rest());
  }

  /**
   * Returns the position of an event in the picture, px.
   * @param {MouseEvent} event
   */
  placeOf(event) {
    const box = this.viewer.canvas?.getBoundingClientRect();
    return [event.clientX - (box?.left ?? 0), event.clientY - (box?.top ?? 0)];
  }

  /** @param {PointerEvent} event */
  grip(event) {
    const isPlain = event.button === 0 && !event.shiftKey && event.target === this.viewer.canvas;
    if (!isPlain || !inputById("grab").checked) return;
    const [x, y] = this.placeOf(event);
    const hit = this.viewer.pickEquipment(x, y);
    const start = hit && this.viewer.pickFloor(x, y, hit.at[2]);
    if (!hit || !start) return;
    // The viewer ignores a drag whose event is marked like this.
    event.preventDefault();
    const { plan } = this.page;
    const [index, pointer] = [hit.equipment, event.pointerId];
    const from = plan.pieces[index].at.slice();
    this.held = { index, height: hit.at[2], start, from, now: from, pointer };
    plan.held = { index, turns: false, from, start: [0, 0], now: from, pointer: null };
    this.host.setPointerCapture(pointer);
  }

  /** @param {PointerEvent} event */
  drag(event) {
    if (!this.held || event.pointerId !== this.held.pointer) return;
    const { index, from, start, height } = this.held;
    const [x, y] = this.placeOf(event);
    const to = this.viewer.pickFloor(x, y, height);
    if (!to) return;
    const [newX, newY] = [Math.round(from[0] + to.x - start.x), Math.round(from[1] + to.y - start.y)];
    this.held.now = this.page.move(index, [newX, newY, from[2], from[3]], false);
    this.page.plan.show(index, this.held.now);
  }

  /** @param {PointerEvent} event */
  drop(event) {
    if (!this.held || event.pointerId !== this.held.pointer) return;
    const { index, from, now } = this.held;
    this.held = null;
    this.page.plan.held = null;
    const isMoved = now.some((value, k) => value !== from[k]);
    if (event.type === "pointerup" && isMoved) this.page.move(index, now, true);
    else this.page.show(this.page.now);
  }

  /**
   * Moves equipment before the map at its new placement has arrived.
   * @param {number} index
   * @param {Placement} placement
   */
  move(index, [x_mm, y_mm, z_mm, yaw_deg]) {
    this.viewer.movePart(index, { x_mm, y_mm, z_mm, yaw_deg });
  }

  /**
   * Returns the position of the origin of a piece of equipment in the picture, px.
   * @param {number} index
   */
  spot(index) {
    const [x, y, z] = this.page.plan.pieces[index].at;
    const point = this.viewer.project(x, y, z);
    return point && [point.x, point.y];
  }

  /**
   * Measures whether pictures are drawn fast enough to follow a drag in the plan.
   * @param {DrawingDocument} written
   */
  measure(written) {
    const began = performance.now();
    this.replace(written);
    afterPaint(() => {
      const gl = this.viewer.canvas?.getContext("webgl2");
      // Reading a pixel waits until the picture is drawn.
      gl?.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      this.isQuick = performance.now() - began < QUICK;
      if (!this.isLookedAt) this.rest();
      // A copy of another size would be distorted.
      new ResizeObserver(() => this.restAfterPaint()).observe(this.host);
    });
  }

  /** @param {DrawingDocument} written */
  replace(written) {
    this.viewer.replace(written);
    this.restAfterPaint();
  }

  /** Shows a still copy as soon as the picture is drawn, unless the user looks at the view. */
  restAfterPaint() {
    if (this.isQuick || this.isLookedAt) return;
    afterPaint(() =>
      afterPaint(() => {
        if (!this.isLookedAt) this.rest();
      }),
    );
  }

  /** Shows a still copy while the view is idle. Without a graphics card, a live picture slows the page. */
  rest() {
    this.isLookedAt = false;
    const { canvas } = this.viewer;
    if (this.isQuick || this.held || !canvas?.width) return;
    this.copy.width = canvas.width;
    this.copy.height = canvas.height;
    this.copy.getContext("2d", { willReadFrequently: true })?.drawImage(canvas, 0, 0);
    this.copy.hidden = false;
    canvas.style.visibility = "hidden";
  }

  wake() {
    this.isLookedAt = true;
    this.copy.hidden = true;
    if (this.viewer.canvas) this.viewer.canvas.style.visibility = "";
  }
}
