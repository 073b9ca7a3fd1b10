// Mouse, touch and keys: they rotate, shift and zoom the picture, and pick nodes.

/**
 * Actions of the pointer on a viewer.
 * @typedef {object} PointerTarget
 * @property {(dx: number, dy: number) => void} turn
 * @property {(dx: number, dy: number) => void} shift
 * @property {(factor: number, at?: number[]) => void} zoom
 * @property {(name: ViewName | "reset") => void} look
 * @property {(at: number[] | null, radius: number, clicked?: boolean) => void} hover
 * @property {(text: string) => void} hint
 */

/** Distance within which a pointer picks a node, px. */
const PICK_RADIUS = 14;
const TOUCH_RADIUS = 26;

/** @type {Record<string, [number, number]>} */
const ARROW_KEYS = {
  ArrowLeft: [-24, 0],
  ArrowRight: [24, 0],
  ArrowUp: [0, -24],
  ArrowDown: [0, 24],
};

/**
 * Listens to pointer, wheel and keys.
 * @param {PointerTarget} target
 * @param {HTMLCanvasElement} canvas
 * @param {ViewerOptions} options
 */
function listenToPointer(target, canvas, options) {
  /** Whether the wheel zooms. The wheel zooms after a click; before a click, it scrolls the page. */
  let taken = options.wheel === "always";
  canvas.style.touchAction = taken ? "none" : "pan-y";
  listenToDrags(target, canvas, () => {
    taken = true;
  });
  // A touch pointer leaves the canvas after every tap, but the tip must remain visible.
  canvas.addEventListener("pointerleave", (event) => {
    if (event.pointerType !== "touch") target.hover(null, 0);
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("blur", () => {
    taken = options.wheel === "always";
  });
  const wheel = (/** @type {WheelEvent} */ event) => {
    if (!taken && !event.ctrlKey) {
      target.hint("click the picture to zoom with the wheel");
      return;
    }
    event.preventDefault();
    const pixelsPerUnit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    const travelled = clamp(event.deltaY * pixelsPerUnit, -200, 200);
    target.zoom(Math.exp(travelled * 0.0016), placeOf(canvas, event));
  };
  canvas.addEventListener("wheel", wheel, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    if (pressKey(target, event)) event.preventDefault();
  });
}

/**
 * Returns the position of an event in the picture, px.
 * @param {Element} canvas
 * @param {MouseEvent} event
 */
function placeOf(canvas, event) {
  const box = canvas.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

/**
 * Listens to drags, pinches and clicks.
 * @param {PointerTarget} target
 * @param {HTMLCanvasElement} canvas
 * @param {() => void} begin
 */
function listenToDrags(target, canvas, begin) {
  /**
   * Places of the pointers that are down.
   * @type {Map<number, number[]>}
   */
  const down = new Map();
  let travelled = 0;
  canvas.addEventListener("pointerdown", (event) => {
    // A page may handle the drag itself.
    if (event.defaultPrevented) return;
    down.set(event.pointerId, placeOf(canvas, event));
    travelled = 0;
    begin();
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
  });
  canvas.addEventListener("pointermove", (event) => {
    const at = placeOf(canvas, event);
    const before = down.get(event.pointerId);
    if (!before) {
      if (event.pointerType !== "touch") target.hover(at, PICK_RADIUS);
      return;
    }
    const [dx, dy] = [at[0] - before[0], at[1] - before[1]];
    travelled += Math.hypot(dx, dy);
    const other = [...down].find(([id]) => id !== event.pointerId)?.[1];
    const shifts = event.shiftKey || (event.buttons & 0b110) !== 0;
    if (other) pinch(target, before, at, other);
    else if (shifts) target.shift(dx, dy);
    else if (travelled > 3) target.turn(dx, dy);
    down.set(event.pointerId, at);
  });
  const release = (/** @type {PointerEvent} */ event) => {
    const isClick = down.delete(event.pointerId) && travelled < 6 && event.type === "pointerup";
    const radius = event.pointerType === "touch" ? TOUCH_RADIUS : PICK_RADIUS;
    if (isClick) target.hover(placeOf(canvas, event), radius, true);
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
}

/**
 * Zooms and shifts with two fingers.
 * @param {PointerTarget} target
 * @param {number[]} before
 * @param {number[]} at
 * @param {number[]} other
 */
function pinch(target, before, at, other) {
  const [was, is] = [before, at].map((place) => Math.hypot(place[0] - other[0], place[1] - other[1]));
  if (was > 1) target.zoom(was / Math.max(is, 1));
  target.shift((at[0] - before[0]) / 2, (at[1] - before[1]) / 2);
}

/**
 * Handles a key; returns whether the key has an action.
 * @param {PointerTarget} target
 * @param {KeyboardEvent} event
 */
function pressKey(target, event) {
  const step = ARROW_KEYS[event.key];
  if (step && event.shiftKey) target.shift(...step);
  else if (step) target.turn(...step);
  else if (event.key === "+" || event.key === "=") target.zoom(0.85);
  else if (event.key === "-") target.zoom(1 / 0.85);
  else if (event.key === "Home") target.look("reset");
  else if (event.key === "Escape") target.hover(null, 0);
  else return false;
  return true;
}
