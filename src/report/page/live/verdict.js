// The verdict on the layout shown, and the change that the last step caused.

/**
 * Shows the error of a layout, whether it is feasible, and what the step changed.
 * @param {AnswerRecord} answer
 * @param {StepRecord | null} step `null` while something is dragged
 */
function showVerdict(answer, step) {
  const { objective, operations } = answer;
  const senses = [...new Set(operations.map(({ sense }) => sense))].join(", ");
  byId("value").textContent = objective === null ? "—" : errorFigure(objective);
  byId("unit").textContent = answer.unit;
  byId("word").textContent = `${answer.word} in ${senses}`;
  const chip = byId("chip");
  chip.className = answer.feasible && answer.met && answer.certified !== false ? "good" : "bad";
  chip.textContent = verdictWords(answer);
  byId("reasons").replaceChildren(...answer.reasons.map((reason) => make("li", {}, reason)));
  showOperations(answer);
  byId("change").replaceChildren(...(step ? changeWords(step) : []));
}

/**
 * States whether a layout is feasible and meets its requirements.
 * @param {AnswerRecord} answer
 */
function verdictWords({ feasible, met, certified, operations }) {
  if (!feasible) return "✗ not feasible";
  if (!met) return "✗ requirement missed";
  if (certified === false) return "✗ not certified within the placement tolerances";
  return hasLimit(operations) ? "✓ requirement met" : "✓ feasible";
}

/**
 * Returns whether an operation has a limit.
 * @param {OperationAnswer[]} operations
 */
const hasLimit = (operations) => operations.some(({ limit }) => limit !== null);

/**
 * Shows the table of the operations.
 * @param {AnswerRecord} answer
 */
function showOperations({ operations, unit }) {
  const cells = (/** @type {"td" | "th"} */ tag, /** @type {string[]} */ texts) =>
    make("tr", {}, ...texts.map((text) => make(tag, {}, text)));
  const isBounded = operations.some(({ worst }) => worst !== null);
  const head = cells("th", [
    "operation",
    "at the spot",
    isBounded ? "misplaced at most" : "",
    hasLimit(operations) ? "limit" : "",
    "joints near a limit",
    "usable nodes",
  ]);
  const rows = operations.map((operation) => {
    const { name, value, worst, counts, near_limits: near } = operation;
    const nodes = Object.values(counts).reduce((sum, count) => sum + count, 0);
    const error = value === null ? "no spot" : `${errorFigure(value)} ${unit}`;
    const most = worst === null ? "" : errorFigure(worst);
    const joints = near.join(", ") || "none";
    return cells("td", [name, error, most, limitWords(operation), joints, `${counts.ok} of ${nodes}`]);
  });
  byId("operations").replaceChildren(head, ...rows);
}

/** State of the room to place while the server computes it. */
const ROOM_IN_WORK = "being computed";

/**
 * Shows how far each piece may be displaced and rotated, and what limits its room.
 * @param {RoomRecord | string} room record, or a phrase that states why there is none
 */
function showRoom(room) {
  const block = byId("room");
  // The block never shrinks, so the buttons below do not move away while the user clicks them.
  block.style.minHeight = `${block.getBoundingClientRect().height}px`;
  block.setAttribute("aria-busy", String(room === ROOM_IN_WORK));
  if (typeof room === "string" || room.regions.length === 0) {
    const why = typeof room === "string" ? room : "none, because the layout is infeasible or misses a limit";
    block.replaceChildren(`Room to place: ${why}.`);
    return;
  }
  const cells = (/** @type {"td" | "th"} */ tag, /** @type {string[]} */ texts) =>
    make("tr", {}, ...texts.map((text) => make(tag, {}, text)));
  const figure = (/** @type {number | null} */ value) => (value === null ? "–" : shortNumber(value, 2));
  const rows = room.regions.map(({ equipment, room_mm: mm, room_deg: deg, ends_with: end }) =>
    cells("td", [equipment, figure(mm), figure(deg), end]),
  );
  const table = make("table", {}, cells("th", ["room to place", "± mm", "± deg", "ends where"]), ...rows);
  const turn = room.whole_cell;
  const whole = turn && `The whole cell may be rotated by ${turn.turn_deg[0]} to ${turn.turn_deg[1]} deg.`;
  block.replaceChildren(table, ...(whole ? [make("p", {}, whole)] : []));
}

/**
 * Describes the limit of an operation and the margin to it.
 * @param {OperationAnswer} operation
 */
function limitWords({ limit, margin }) {
  if (limit === null || margin === null) return limit === null ? "" : errorFigure(limit);
  const word = margin < 0 ? "exceeded by" : "margin";
  return `${errorFigure(limit)} (${word} ${errorFigure(Math.abs(margin))})`;
}

/**
 * Returns what a step changed, with the objective before and after.
 * @param {StepRecord} step
 * @returns {(Node | string)[]}
 */
function changeWords({ what, before, undo, answer }) {
  if (!undo) return [what];
  const { objective, unit } = answer;
  const words = (/** @type {number | null} */ value) =>
    value === null ? "not feasible" : `${errorFigure(value)} ${unit}`;
  const change = `${what}: ${words(before)} → ${words(objective)}`;
  if (before === null || !(before > 0) || objective === null) return [change];
  const gain = (100 * (before - objective)) / before;
  const isSame = Math.abs(gain) <= 0.05;
  const kind = gain > 0 ? "less" : "more";
  const text = isSame ? "unchanged" : `${Math.abs(gain).toFixed(1)} % ${kind}`;
  return [change, " ", make("b", { className: isSame ? "" : kind }, text)];
}
