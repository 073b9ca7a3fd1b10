// Mouse, touch and keys: turn, shift, zoom, and what the pointer is at.

/** Wheel: "always" zooms at once; else the page scrolls until the picture was clicked. */
function makeHand(view, canvas, options) {
  const down = new Map();
  let [travelled, taken] = [0, false];
  const spot = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  canvas.style.touchAction = options.wheel === "always" ? "none" : "pan-y";

  canvas.addEventListener("pointerdown", (event) => {
    if (event.defaultPrevented) return;
    down.set(event.pointerId, spot(event));
    [travelled, taken] = [0, true];
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
  });
  canvas.addEventListener("pointermove", (event) => {
    const at = spot(event);
    const before = down.get(event.pointerId);
    if (!before) {
      if (event.pointerType !== "touch") view.hover(at, 14);
      return;
    }
    const [dx, dy] = [at[0] - before[0], at[1] - before[1]];
    travelled += Math.hypot(dx, dy);
    if (down.size >= 2) {
      const other = [...down].find(([id]) => id !== event.pointerId)[1];
      const [far, was] = [at, before].map((p) => Math.hypot(p[0] - other[0], p[1] - other[1]));
      if (was > 1) view.zoom(was / Math.max(far, 1));
      view.shift(dx / 2, dy / 2);
    } else if (event.buttons & 2 || event.shiftKey || event.buttons & 4) view.shift(dx, dy);
    else if (travelled > 3) view.turn(dx, dy);
    down.set(event.pointerId, at);
  });
  const up = (event) => {
    const was = down.delete(event.pointerId);
    if (was && travelled < 6 && event.type === "pointerup") view.hover(spot(event), event.pointerType === "touch" ? 26 : 14, true);
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  // A finger leaves with every tap: what it asked for stays.
  canvas.addEventListener("pointerleave", (event) => event.pointerType !== "touch" && view.hover(null, 0));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("blur", () => (taken = false));
  canvas.addEventListener("wheel", (event) => {
    if (!taken && options.wheel !== "always" && !event.ctrlKey) {
      view.hint("click the picture, then the wheel zooms");
      return;
    }
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    view.zoom(Math.exp(clamp(event.deltaY * lines, -200, 200) * 0.0016), spot(event));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-24, 0], ArrowRight: [24, 0], ArrowUp: [0, -24], ArrowDown: [0, 24] }[event.key];
    if (step) (event.shiftKey ? view.shift : view.turn)(...step);
    else if (event.key === "+" || event.key === "=") view.zoom(0.85);
    else if (event.key === "-") view.zoom(1 / 0.85);
    else if (event.key === "Home") view.look("reset");
    else if (event.key === "Escape") view.hover(null, 0);
    else return;
    event.preventDefault();
  });
}

/** The node nearest to a place in the picture, no farther than so many px. */
function nodeNear(view, at, reach) {
  let best = null;
  for (const field of shownFields(view.drawing, view.state.operation)) {
    for (let k = 0; k < field.count; k++) {
      const p = seenAt(view, placeOf(view, field, nodeAt(field, k)));
      const far = Math.hypot(p.x - at[0], p.y - at[1]);
      if (p.visible && far < reach && (!best || far < best.far)) best = { field, k, far, x: p.x, y: p.y };
    }
  }
  return best;
}

/** What is known of a node, line by line. */
function nodeWords(view, { field, k }) {
  const { drawing, lens } = view;
  const place = nodeAt(field, k).map((v) => v.toFixed(0)).join(", ");
  const [i, j] = field.nodes[k];
  const lines = [`${drawing.operations[field.operation].name}, node (${i}, ${j})`, `at ${place} mm`];
  if (field.status[k] !== "ok") lines.push(field.reason[k] || field.status[k]);
  else if (lens >= 0) {
    const { reading, model, signed } = drawing.lenses[lens];
    lines.push(`${reading}, ${model}:`);
    field.senses.forEach((s, n) => {
      const value = field.takes[lens].values[n][k];
      if (!isNaN(value)) lines.push(`${n === senseIn(field, view.state.sense) ? "\u25b8 " : "   "}${s.name}  ${figure(value)} ${s.unit}`);
    });
    const error = errorAt(field, lens, k);
    if (error && signed) lines.push(`error ${error.map(figure).join(", ")} mm`);
    const far = view.scale.other ? differenceAt(view, field, k) : null;
    if (far !== null) lines.push(`${figure(Math.abs(far))} ${far > 0 ? "worse" : "better"} than in ${view.scale.other.name}`);
  }
  const joints = field.joints[k];
  if (joints) lines.push(joints.map((q, n) => `${drawing.joints[n].name} ${q.toFixed(1)}${drawing.joints[n].unit === "deg" ? "\u00b0" : " mm"}`).join("  "));
  return lines;
}

function makeTip(stage) {
  const box = element("div", { class: "ss-tip", role: "status" });
  box.hidden = true;
  stage.append(box);
  return box;
}

function showTip(box, view) {
  const { found } = view;
  box.hidden = !found;
  if (!found) return;
  const at = seenAt(view, placeOf(view, found.field, nodeAt(found.field, found.k)));
  box.replaceChildren(...nodeWords(view, found).map((line) => element("div", { textContent: line })));
  const [w, h] = [box.offsetWidth, box.offsetHeight];
  const x = at.x + 16 + w > view.width ? at.x - 16 - w : at.x + 16;
  const y = clamp(at.y - h / 2, 4, Math.max(view.height - h - 4, 4));
  box.style.transform = `translate(${Math.max(x, 4).toFixed(0)}px, ${y.toFixed(0)}px)`;
}
