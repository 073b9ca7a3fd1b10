// A search from the layout shown, and the layout as a file.
function searching(state) {
  $("budget").value = state.budget;
  $("seed").value = state.seed;
  if (!state.can_search) {
    $("start").disabled = true;
    $("found").textContent = "every placement is fixed in the file: nothing to search";
  }
  $("search").onsubmit = async (e) => {
    e.preventDefault();
    const whole = (id) => ($(id).value.trim() === "" ? null : Number($(id).value));
    await told("search", { budget: whole("budget"), seed: whole("seed") });
    pulse();
  };
  $("stop").onclick = () => told("stop", {});
  $("accept").onclick = () => change("accept", {});
}

async function told(what, body) {
  try {
    progress((await ask(what, body)).search);
    fault("");
  } catch (e) {
    fault(e.message);
  }
}

function progress(search) {
  if (!search) return;
  const { running, evaluations, budget, best, start, gain_percent: gain, unit } = search;
  $("start").disabled = running || !cell.can_search;
  $("stop").disabled = !running;
  $("accept").disabled = running || !search.acceptable;
  $("bar").hidden = false;
  $("bar").max = budget;
  $("bar").value = running ? evaluations : budget;
  const word = (v) => (v === null ? "not feasible" : `${error(v)} ${unit}`);
  const share = gain === null ? "" : gain > 0.05 ? `, ${gain.toFixed(1)} % less` : ", nothing gained";
  const lines = [`${evaluations} of ${budget} layouts, ${search.seconds.toFixed(1)} s, seed ${search.seed}`,
    `start ${word(start)}, best ${word(best)}${best === null ? "" : share}`];
  if (search.ended) lines.push(`ended: ${search.ended}`);
  if (search.fault) lines.push(search.fault);
  $("found").replaceChildren(...lines.flatMap((line) => [line, make("br")]));
}

// Looks now and then whether another page has changed something, and how far a search is.
async function pulse() {
  try {
    const { revision: theirs, search } = await ask("pulse");
    progress(search);
    if (theirs !== revision && !plan.held && !waiting && !trying) show(await ask("now"));
    if ($("fault").dataset.gone) {
      fault("");
      delete $("fault").dataset.gone;
    }
    return search && search.running;
  } catch (e) {
    fault(e.message);
    $("fault").dataset.gone = "yes";
    return false;
  }
}

async function watch() {
  const running = document.hidden ? false : await pulse();
  setTimeout(watch, running ? 250 : 1000);
}

function saving() {
  const say = (text, bad) => {
    $("saved").textContent = text;
    $("saved").className = bad ? "bad-word" : "";
  };
  const save = async (overwrite) => {
    $("overwrite").hidden = true;
    try {
      const { saved } = await ask("save", { name: $("name").value, overwrite });
      say(`saved: sweetspot map ${saved}`);
    } catch (e) {
      say(e.message, true);
      $("overwrite").hidden = !(e.answer && e.answer.taken);
    }
  };
  $("save").onsubmit = (e) => {
    e.preventDefault();
    save(false);
  };
  $("overwrite").onclick = () => save(true);
  $("name").oninput = () => ($("overwrite").hidden = true);
}
