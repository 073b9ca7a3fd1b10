// The 3-D view beside the plan: equipment is dragged there, too.
async function beginSolid() {
  if (!sweetspotViewer.supported()) return;
  $("solid").hidden = false;
  document.querySelector("main").classList.add("both");
  solid = new Solid(await ask("drawing"));
}

// ms for a picture.
const QUICK = 40;

class Solid {
  constructor(written) {
    this.viewer = sweetspotViewer($("viewer"), written, { controls: true });
    [this.held, this.quick, this.written, this.looked] = [null, false, written, false];
    this.copy = make("canvas", {});
    Object.assign(this.copy.style, { position: "absolute", inset: 0, width: "100%", height: "100%", pointerEvents: "none", display: "none" });
    this.viewer.canvas.after(this.copy);
    painted(() => painted(() => this.pace()));
    // What is asked is chosen at the top of the page; there is more for who looks for it.
    for (const details of $("viewer").querySelectorAll("details")) details.open = false;
    const host = $("viewer");
    host.addEventListener("pointerdown", (e) => this.grip(e), true);
    host.addEventListener("pointermove", (e) => this.drag(e));
    for (const begin of ["pointerenter", "focusin"]) host.addEventListener(begin, () => this.wake());
    for (const end of ["pointerleave", "focusout"]) host.addEventListener(end, () => this.rest());
    for (const end of ["pointerup", "pointercancel"]) host.addEventListener(end, (e) => this.drop(e));
  }

  at(e) {
    const box = this.viewer.canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  }

  grip(e) {
    if (!$("grab").checked || e.button !== 0 || e.shiftKey || e.target !== this.viewer.canvas || !now) return;
    const hit = this.viewer.pickEquipment(...this.at(e));
    if (!hit) return;
    const start = this.viewer.pickFloor(...this.at(e), hit.at[2]);
    if (!start) return;
    // The viewer leaves alone what is taken.
    e.preventDefault();
    const from = plan.pieces[hit.equipment].at.slice();
    this.held = { index: hit.equipment, z: hit.at[2], start, from, now: from, pointer: e.pointerId };
    plan.held = { index: hit.equipment, from, now: from, at: [0, 0], pointer: null };
    $("viewer").setPointerCapture(e.pointerId);
  }

  drag(e) {
    if (!this.held || e.pointerId !== this.held.pointer) return;
    const { index, from, start, z } = this.held;
    const to = this.viewer.pickFloor(...this.at(e), z);
    if (!to) return;
    const wanted = [Math.round(from[0] + to.x - start.x), Math.round(from[1] + to.y - start.y), from[2], from[3]];
    this.held.now = moved(index, wanted, false);
    plan.show(index, this.held.now);
  }

  drop(e) {
    if (!this.held || e.pointerId !== this.held.pointer) return;
    const { index, from, now: there } = this.held;
    this.held = plan.held = null;
    if (e.type === "pointerup" && there.some((v, k) => v !== from[k])) moved(index, there, true);
    else show(now);
  }

  // Where a piece stands, before the map is there.
  move(index, [x_mm, y_mm, z_mm, yaw_deg]) {
    this.viewer.movePart(index, { x_mm, y_mm, z_mm, yaw_deg });
  }

  // Where in the picture the middle of an equipment is, px.
  spot(index) {
    const [x, y, z] = plan.pieces[index].at;
    const p = this.viewer.project(x, y, z);
    return [p.x, p.y];
  }

  // Whether it is drawn fast enough to follow a hand in the plan: by a graphics card it is.
  pace() {
    const began = performance.now();
    this.replace(this.written);
    painted(() => {
      const gl = this.viewer.canvas.getContext("webgl2");
      // Waits until the picture is there.
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      this.quick = performance.now() - began < QUICK;
      this.written = null;
      if (!this.looked) this.rest();
    });
  }

  replace(written) {
    this.viewer.replace(written);
    if (!this.quick && !this.looked) painted(() => painted(() => this.looked || this.rest()));
  }

  // Without a graphics card a live picture slows whatever else the page draws: while nobody is at it, a
  // copy stands in for it.
  rest() {
    this.looked = false;
    const { canvas } = this.viewer;
    if (this.quick || this.held || !canvas.width) return;
    [this.copy.width, this.copy.height] = [canvas.width, canvas.height];
    this.copy.getContext("2d", { willReadFrequently: true }).drawImage(canvas, 0, 0);
    this.copy.style.display = "block";
    canvas.style.visibility = "hidden";
  }

  wake() {
    this.looked = true;
    this.copy.style.display = "none";
    this.viewer.canvas.style.visibility = "";
  }
}
