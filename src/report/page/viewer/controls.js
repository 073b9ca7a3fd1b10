// Switches and the time line, plain HTML: every one has a label and works from the keyboard.

const ARROWS = [["none", "none"], ["x", "x"], ["y", "y"], ["z", "z"], ["components", "x, y and z"], ["resultant", "resultant"]];
const SEEN = [["solid", "solid"], ["clear", "see-through"], ["none", "hidden"]];
const VIEWS = ["iso", "top", "front", "side"];

let fieldsMade = 0;

/** A labelled list of choices, [value, word] each. */
function chooser(name, choose) {
  fieldsMade += 1;
  const id = `ss-field-${fieldsMade}`;
  const list = element("select", { id });
  const box = element("div", { class: "ss-field" }, element("label", { htmlFor: id, textContent: name }), list);
  list.addEventListener("change", () => choose(list.value));
  const fill = (choices, value) => {
    const now = JSON.stringify(choices);
    if (list.dataset.choices !== now) {
      list.dataset.choices = now;
      list.replaceChildren(...choices.map(([v, word]) => element("option", { value: v, textContent: word })));
    }
    list.value = value;
    box.hidden = choices.length < 2;
  };
  list.name = name.toLowerCase().replace(/ /g, "-");
  return { box, fill };
}

function button(words, press, attributes = {}) {
  const made = element("button", { type: "button", textContent: words, ...attributes });
  made.addEventListener("click", press);
  return made;
}

function makeControls(view, host, show) {
  const asIndex = (v) => (v === "" ? null : Number(v));
  const lensOf = (model, reading) => {
    const { lenses } = view.drawing;
    const exact = lenses.findIndex((l) => l.model === model && l.reading === reading);
    return exact >= 0 ? exact : lenses.findIndex((l) => l.reading === reading);
  };
  const now = () => view.drawing.lenses[Math.max(view.lens, 0)];
  const fields = {
    drawing: chooser("Layout", (v) => show({ drawing: Number(v) })),
    operation: chooser("Operation", (v) => show({ operation: asIndex(v) })),
    sense: chooser("Sense", (v) => show({ sense: v === "" ? null : v.slice(1) })),
    reading: chooser("Reading", (v) => show({ lens: lensOf(now().model, v) })),
    model: chooser("Model", (v) => show({ lens: lensOf(v, now().reading) })),
    arrows: chooser("Arrows", (v) => show({ arrows: v })),
    robot: chooser("Robot", (v) => show({ robot: v })),
    solids: chooser("Equipment", (v) => show({ solids: v })),
    compareTo: chooser("Against", (v) => show({ compareTo: asIndex(v) })),
  };
  const tick = element("input", { type: "checkbox", name: "envelope" });
  tick.addEventListener("change", () => show({ envelope: tick.checked }));
  const envelope = element("label", { class: "ss-check" }, tick, " Working envelope");
  const views = VIEWS.map((name) => button(name, () => view.look(name), { name: `view-${name}` }));
  views.push(button("reset", () => view.look("reset"), { name: "view-reset" }));
  const grid = element("div", { class: "ss-grid" }, ...Object.values(fields).map((f) => f.box));
  const row = element("div", { class: "ss-row" }, envelope,
    element("div", { class: "ss-views", role: "group", ariaLabel: "View" }, ...views));
  const box = element("details", { class: "ss-controls" }, element("summary", { textContent: "What is shown" }), grid, row);
  box.open = host.clientWidth > 620;
  host.prepend(box);
  return { box, fields, tick, envelope };
}

function showControls(controls, view) {
  const { fields } = controls;
  const { drawing, state, model } = view;
  const indexed = (all) => all.map((one, k) => [String(k), one.name]);
  fields.drawing.fill(indexed(model.drawings), String(state.drawing));
  const own = indexed(drawing.operations);
  fields.operation.fill(own.length > 1 ? [["", "all"], ...own] : own, state.operation === null ? (own.length > 1 ? "" : "0") : String(state.operation));
  const senses = [...new Set(shownFields(drawing, state.operation).flatMap((f) => f.senses.map((s) => s.name)))];
  // A sense may be called anything: its value is marked. What all operations ask for is not told twice.
  const asked = senseWords({ ...view, state: { ...state, sense: null } });
  fields.sense.fill([["", `own (${asked})`], ...senses.filter((s) => s !== asked).map((s) => [`=${s}`, s])],
    state.sense === null || state.sense === asked ? "" : `=${state.sense}`);
  const lens = drawing.lenses[Math.max(view.lens, 0)];
  const words = (key) => [...new Set(drawing.lenses.map((l) => l[key]))].map((w) => [w, w]);
  fields.reading.fill(words("reading"), lens.reading);
  fields.model.fill(words("model"), lens.model);
  fields.arrows.fill(ARROWS, state.arrows);
  fields.robot.fill(SEEN, state.robot);
  fields.solids.fill(SEEN, state.solids);
  const others = indexed(model.drawings).filter(([k]) => Number(k) !== state.drawing);
  fields.compareTo.fill(others.length ? [["", "nothing"], ...others] : [], state.compareTo === null ? "" : String(state.compareTo));
  controls.tick.checked = state.envelope;
  controls.envelope.hidden = !drawing.envelopes.length;
}

function makeTimeline(view, host, show) {
  const play = button("Play", () => view.play(!view.playing), { class: "ss-play", name: "play" });
  fieldsMade += 1;
  const slider = element("input", { type: "range", min: "0", step: "0.01", name: "time", ariaLabel: "Time of the movement" });
  slider.addEventListener("input", () => {
    view.play(false);
    show({ time: Number(slider.value) });
  });
  const ticks = element("div", { class: "ss-ticks" });
  const clock = element("output", { class: "ss-clock" });
  const box = element("div", { class: "ss-timeline" }, play, element("div", { class: "ss-track" }, slider, ticks), clock);
  host.append(box);
  return { box, play, slider, ticks, clock, of: null };
}

function showTimeline(line, view, show) {
  const { movement } = view.drawing;
  const end = movement.times_s.length ? movement.times_s[movement.times_s.length - 1] : 0;
  line.box.hidden = movement.stops.length < 2;
  if (line.of !== movement) {
    line.of = movement;
    line.slider.max = String(end);
    const shares = movement.stops.map((stop) => clamp(stop.time_s / (end || 1), 0, 1));
    line.ticks.replaceChildren(...movement.stops.map((stop, n) => {
      const tick = button(short(stop.name), () => {
        view.play(false);
        show({ time: stop.time_s + (stop.operation === null ? 0 : 0.3) });
      });
      const share = shares[n];
      const room = Math.min(...shares.filter((_, k) => k !== n).map((s) => Math.abs(s - share)));
      tick.style.maxWidth = `${(100 * room).toFixed(1)}%`;
      tick.title = stop.name;
      tick.style.left = `${(100 * share).toFixed(2)}%`;
      tick.style.transform = `translateX(${(-100 * share).toFixed(1)}%)`;
      return tick;
    }));
  }
  line.slider.value = String(view.state.time);
  line.play.textContent = view.playing ? "Pause" : "Play";
  const words = `${view.state.time.toFixed(1)} s of ${end.toFixed(1)} s`;
  line.clock.textContent = movement.checked ? words : `${words}, ways not checked`;
  line.clock.title = movement.checked ? "" : "The ways between the spots were not checked for collision (a cell with [transfer] has them checked).";
}
