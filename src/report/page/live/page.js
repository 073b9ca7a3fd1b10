// The page: what was answered last, and everything that asks anew.
let cell, plan, form, now, revision = 0, solid = null;
// How long each change took from the request to the drawn map, ms, and where in the 3-D view an equipment
// is: for tests/browser/view.mjs.
const drawn = (window.sweetspotDrawn = []);
window.sweetspotSpot = (name) => solid.spot(cell.equipment.findIndex((e) => e.name === name));

// While something is dragged one request is under way; of those that wait the last is sent.
let trying = false, waiting = null, serial = 0;
async function attempt(numbers) {
  waiting = numbers;
  if (trying) return;
  trying = true;
  while (waiting) {
    const [asked, own] = [waiting, serial];
    waiting = null;
    try {
      // Only where it is dragged is the map of the 3-D view followed, too.
      const { answer, numbers, drawing } = await ask(solid && solid.held ? "try-drawing" : "try", asked);
      // Dropped in the meantime: that answer counts.
      if (own === serial) {
        plan.draw(answer);
        form.show(numbers);
        verdict(answer, null);
        if (drawing) {
          solid.replace(drawing);
          if (solid.held) solid.move(solid.held.index, solid.held.now);
        }
      }
    } catch (e) {
      if (own === serial) fault(e.message);
    }
    // No faster than it can be seen: pictures that queue up hold up the drop.
    await new Promise(painted);
  }
  trying = false;
}

// After what is drawn now is seen.
const painted = (then) => requestAnimationFrame(() => setTimeout(then));

async function change(what, body, entry) {
  const began = performance.now();
  const own = ++serial;
  waiting = null;
  try {
    const answer = await ask(what, body);
    fault("");
    if (own !== serial) return;
    show(answer);
    painted(() => drawn.push(performance.now() - began));
  } catch (e) {
    if (entry) form.refuse(entry, e.message);
    else fault(e.message);
    if (now && own === serial && !entry) show(now);
  }
}

let slow = 0;
function show(answer) {
  now = answer;
  revision = answer.revision;
  plan.draw(answer.answer);
  form.show(answer.numbers);
  verdict(answer.answer, answer);
  $("undo").disabled = answer.undo === 0;
  $("redo").disabled = answer.redo === 0;
  $("depth").textContent = answer.undo ? `${answer.undo} step${answer.undo > 1 ? "s" : ""}` : "as drawn";
  asked(answer);
  // The map first: where no graphics card helps, the 3-D view holds up everything after it.
  painted(refresh);
  // What takes longer comes when the hand rests.
  clearTimeout(slow);
  slow = setTimeout(behind, 150);
}

// The 3-D view follows the plan.
async function refresh() {
  if (!solid) return;
  const own = revision;
  try {
    const written = await ask("drawing");
    if (own === revision && !solid.held) solid.replace(written);
  } catch (e) {
    fault(e.message);
  }
}

async function behind() {
  const own = revision;
  try {
    const { outlines } = await ask("reach");
    if (own === revision) plan.reached(outlines);
  } catch (e) {
    fault(e.message);
  }
}

function verdict(answer, step) {
  $("value").textContent = answer.objective === null ? "—" : error(answer.objective);
  $("unit").textContent = answer.unit;
  $("word").textContent = `${answer.word} in ${[...new Set(answer.operations.map((o) => o.sense))].join(", ")}`;
  const limited = answer.operations.some((o) => o.limit !== null);
  const chip = $("chip");
  const good = answer.feasible && answer.met;
  chip.className = good ? "good" : "bad";
  chip.textContent = !answer.feasible ? "✗ not feasible" : !answer.met ? "✗ requirement missed" : limited ? "✓ requirement met" : "✓ feasible";
  $("reasons").replaceChildren(...answer.reasons.map((r) => make("li", {}, r)));
  const cells = (tag, texts) => make("tr", {}, ...texts.map((t) => make(tag, {}, t)));
  const row = (o) => cells("td", [o.name, o.value === null ? "no spot" : `${error(o.value)} ${answer.unit}`,
    o.limit === null ? "" : `${error(o.limit)} (${o.margin < 0 ? "misses by" : "left"} ${error(Math.abs(o.margin))})`,
    `${o.counts.ok} of ${Object.values(o.counts).reduce((a, b) => a + b, 0)}`]);
  $("operations").replaceChildren(cells("th", ["operation", "at its spot", limited ? "limit" : "", "usable nodes"]), ...answer.operations.map(row));
  const change = $("change");
  change.replaceChildren();
  if (!step) return;
  change.append(`${step.what}`);
  if (step.before === undefined || !step.undo) return;
  const [was, is] = [step.before, answer.objective];
  const word = (v) => (v === null ? "not feasible" : `${error(v)} ${answer.unit}`);
  change.append(`: ${word(was)} → ${word(is)}`);
  if (was > 0 && is !== null) {
    const less = (100 * (was - is)) / was;
    const kind = less > 0.05 ? "less" : less < -0.05 ? "more" : "";
    change.append(" ", make("b", { className: kind }, kind ? `${Math.abs(less).toFixed(1)} % ${kind}` : "the same"));
  }
}

// The senses, readings and models, and what is asked now.
function asked({ question, lenses }) {
  const fill = (id, all, chosen) => {
    $(id).replaceChildren(...all.map(([value, text]) => make("option", { value, selected: value === chosen }, text)));
  };
  fill("sense", [["", "as in the cell"], ...cell.senses.map((s) => [s, s])], question.sense || "");
  const words = new Map(lenses.map((l) => [l.reading, l.word]));
  fill("reading", [...words], question.reading);
  fill("model", [...new Set(lenses.map((l) => l.model))].map((m) => [m, m]), question.model);
}

function askOtherwise() {
  change("question", { sense: $("sense").value || null, reading: $("reading").value, model: $("model").value });
}

// A placement in the world as the numbers that may change for it, and where that leaves it.
function numbersOf(index, world) {
  const { name, on } = cell.equipment[index];
  const group = cell.form.find((g) => g.group === "equipment" && g.index === index);
  const under = on === null ? [0, 0, 0, 0] : plan.pieces[on].at;
  const [own, was] = [seenFrom(world, under), owned(now.numbers, group)];
  const held = {};
  const free = (k) => group.numbers[k].free;
  const result = group.numbers.map((n, k) => {
    // What the file fixes stays, unless it fixes the place altogether.
    const may = k === 2 ? false : k === 3 ? true : free(k) || (!free(0) && !free(1));
    if (!may || Math.abs(own[k] - was[n.key]) < 1e-4) return was[n.key];
    let value = +own[k].toFixed(3);
    if (k === 3 && n.free && !n.list) while (value > n.max && value - 360 >= n.min) value -= 360;
    if (k === 3 && n.free && !n.list) while (value < n.min && value + 360 <= n.max) value += 360;
    if (n.list) value = n.list.reduce((a, b) => (Math.abs(b - value) < Math.abs(a - value) ? b : a));
    else if (n.free) value = Math.min(Math.max(value, n.min), n.max);
    held[n.key] = value;
    return value;
  });
  return { numbers: { equipment: { [name]: held } }, world: carried(result, under), moves: Object.keys(held).length > 0 };
}

function moved(index, world, settled) {
  const { numbers, world: there, moves } = numbersOf(index, world);
  if (solid && (solid.held || solid.quick)) solid.move(index, there);
  if (settled) {
    if (moves) change("layout", numbers);
    else if (now) show(now);
  } else attempt(moves ? numbers : {});
  return there;
}

async function begin() {
  const state = await ask("state");
  cell = state;
  document.title = `${state.cell} · sweetspot view`;
  $("title").textContent = state.cell;
  $("subtitle").textContent = `${state.robot}, errors ${state.errors} · ${state.file}`;
  plan = new Plan($("plan"), state, moved);
  form = new Form($("form"), state.form, (numbers, entry) => change("layout", numbers, entry));
  $("undo").onclick = () => change("undo", {});
  $("redo").onclick = () => change("redo", {});
  $("reset").onclick = () => change("reset", {});
  for (const id of ["sense", "reading", "model"]) $(id).onchange = askOtherwise;
  document.addEventListener("keydown", (e) => {
    if (!(e.ctrlKey || e.metaKey) || e.target.matches("input")) return;
    const back = e.key === "z" && !e.shiftKey;
    if (back || e.key === "y" || (e.key.toLowerCase() === "z" && e.shiftKey)) {
      e.preventDefault();
      change(back ? "undo" : "redo", {});
    }
  });
  new ResizeObserver(() => now && !plan.held && plan.draw(now.answer)).observe($("plan"));
  searching(state);
  saving();
  show(state.now);
  await beginSolid();
  watch();
}

begin().catch((e) => fault(e.message));
