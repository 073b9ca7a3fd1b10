// The switches, plain HTML: each has a label and works from the keyboard.

/** @typedef {[value: string, text: string][]} Choices */

/** @type {Choices} */
const ARROW_CHOICES = [
  ["none", "none"],
  ["x", "x"],
  ["y", "y"],
  ["z", "z"],
  ["components", "x, y and z"],
  ["resultant", "resultant"],
];

/** @type {Choices} */
const VISIBILITY_CHOICES = [
  ["solid", "solid"],
  ["clear", "see-through"],
  ["none", "hidden"],
];

/** @type {ViewName[]} */
const VIEW_NAMES = ["iso", "top", "front", "side"];

let choosersMade = 0;

/**
 * Makes a labelled list of choices.
 * @param {string} name
 * @param {(value: string) => void} choose
 */
function makeChooser(name, choose) {
  choosersMade += 1;
  const id = `ss-field-${choosersMade}`;
  const list = element("select", { id, name: name.toLowerCase().replace(/ /g, "-") });
  const label = element("label", { htmlFor: id, textContent: name });
  list.addEventListener("change", () => choose(list.value));
  return { list, box: element("div", { class: "ss-field" }, label, list) };
}

/**
 * Shows choices; hides the list if it has only one choice.
 * @param {ReturnType<typeof makeChooser>} chooser
 * @param {Choices} choices
 * @param {string} value
 */
function showChoices({ list, box }, choices, value) {
  const key = JSON.stringify(choices);
  if (list.dataset.choices !== key) {
    list.dataset.choices = key;
    list.replaceChildren(
      ...choices.map(([one, text]) => element("option", { value: one, textContent: text })),
    );
  }
  list.value = value;
  box.hidden = choices.length < 2;
}

/**
 * Makes a button.
 * @param {string} text
 * @param {() => void} press
 * @param {Record<string, unknown>} [properties]
 */
function makeButton(text, press, properties = {}) {
  const button = element("button", { type: "button", textContent: text, ...properties });
  button.addEventListener("click", press);
  return button;
}

/**
 * Returns the index of the lens with a model and a reading. If there is no such lens, returns a lens with
 * that reading.
 * @param {View} view
 * @param {string} model
 * @param {string} reading
 */
function lensWith(view, model, reading) {
  const { lenses } = view.drawing;
  const exact = lensIn(view.drawing, { model, reading, signed: false });
  return exact >= 0 ? exact : lenses.findIndex((lens) => lens.reading === reading);
}

/**
 * Makes the switches.
 * @param {View} view
 * @param {HTMLElement} host
 * @param {(wanted: Partial<ViewerState>) => void} show
 * @param {(name: ViewName | "reset") => void} look
 */
function makeControls(view, host, show, look) {
  const indexOf = (/** @type {string} */ value) => (value === "" ? null : Number(value));
  const lens = () => view.drawing.lenses[view.lens];
  const choosers = {
    drawing: makeChooser("Layout", (value) => show({ drawing: Number(value) })),
    operation: makeChooser("Operation", (value) => show({ operation: indexOf(value) })),
    // Names of senses are arbitrary: a prefix distinguishes them from the empty choice.
    sense: makeChooser("Sense", (value) => show({ sense: value === "" ? null : value.slice(1) })),
    reading: makeChooser("Reading", (value) => show({ lens: lensWith(view, lens().model, value) })),
    model: makeChooser("Model", (value) => show({ lens: lensWith(view, value, lens().reading) })),
    arrows: makeChooser("Arrows", (value) => show({ arrows: /** @type {ArrowChoice} */ (value) })),
    robot: makeChooser("Robot", (value) => show({ robot: /** @type {Visibility} */ (value) })),
    solids: makeChooser("Equipment", (value) => show({ solids: /** @type {Visibility} */ (value) })),
    compareTo: makeChooser("Compare with", (value) => show({ compareTo: indexOf(value) })),
  };
  const envelope = element("input", { type: "checkbox", name: "envelope" });
  envelope.addEventListener("change", () => show({ envelope: envelope.checked }));
  const envelopeLabel = element("label", { class: "ss-check" }, envelope, " Working envelope");
  const views = [...VIEW_NAMES, /** @type {const} */ ("reset")].map((name) =>
    makeButton(name, () => look(name), { name: `view-${name}` }),
  );
  const grid = element("div", { class: "ss-grid" }, ...Object.values(choosers).map(({ box }) => box));
  const viewGroup = element("div", { class: "ss-views", role: "group", ariaLabel: "View" }, ...views);
  const row = element("div", { class: "ss-row" }, envelopeLabel, viewGroup);
  const summary = element("summary", { textContent: "Display" });
  const box = element("details", { class: "ss-controls" }, summary, grid, row);
  box.open = host.clientWidth > 620;
  host.prepend(box);
  return { choosers, envelope, envelopeLabel };
}

/**
 * Returns an index as the value of a choice; empty for null.
 * @param {number | null} index
 */
const indexChoice = (index) => (index === null ? "" : String(index));

/**
 * Returns names as choices by their index.
 * @param {{ name: string }[]} all
 * @returns {Choices}
 */
const indexedChoices = (all) => all.map(({ name }, k) => [String(k), name]);

/**
 * Shows the state of the viewer in the switches.
 * @param {ReturnType<typeof makeControls>} controls
 * @param {View} view
 */
function showControls({ choosers, envelope, envelopeLabel }, view) {
  const { drawing, state, model } = view;
  const layouts = indexedChoices(model.drawings);
  showChoices(choosers.drawing, layouts, String(state.drawing));
  const operations = indexedChoices(drawing.operations);
  if (operations.length > 1) operations.unshift(["", "all"]);
  const alone = operations.length === 1 && state.operation === null;
  showChoices(choosers.operation, operations, alone ? "0" : indexChoice(state.operation));
  showSenses(choosers.sense, view);
  const lens = drawing.lenses[view.lens];
  const distinct = (/** @type {"reading" | "model"} */ key) =>
    [...new Set(drawing.lenses.map((one) => one[key]))].map(
      (text) => /** @type {[string, string]} */ ([text, text]),
    );
  showChoices(choosers.reading, distinct("reading"), lens.reading);
  showChoices(choosers.model, distinct("model"), lens.model);
  showChoices(choosers.arrows, ARROW_CHOICES, state.arrows);
  showChoices(choosers.robot, VISIBILITY_CHOICES, state.robot);
  showChoices(choosers.solids, VISIBILITY_CHOICES, state.solids);
  const others = layouts.filter(([index]) => Number(index) !== state.drawing);
  if (others.length) others.unshift(["", "nothing"]);
  showChoices(choosers.compareTo, others, indexChoice(state.compareTo));
  envelope.checked = state.envelope;
  envelopeLabel.hidden = !drawing.envelopes.length;
}

/**
 * Shows the senses. If all operations state the same sense, the list contains this sense only as the default.
 * @param {ReturnType<typeof makeChooser>} chooser
 * @param {View} view
 */
function showSenses(chooser, view) {
  const { state } = view;
  const names = shownFields(view).flatMap((field) => field.senses.map((sense) => sense.name));
  const own = senseWords({ ...view, state: { ...state, sense: null } });
  /** @type {Choices} */
  const choices = [["", `default (${own})`]];
  for (const name of new Set(names)) if (name !== own) choices.push([`=${name}`, name]);
  const isOwn = state.sense === null || state.sense === own;
  showChoices(chooser, choices, isOwn ? "" : `=${state.sense}`);
}
