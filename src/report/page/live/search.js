// Two panels: one panel searches from the layout shown, the other panel saves the layout as a file.

/** Intervals between two requests to the server, ms: during a search, and at other times. */
const SEARCH_INTERVAL = 250;
const IDLE_INTERVAL = 1000;

class SearchPanel {
  /** @param {Page} page */
  constructor(page) {
    this.page = page;
    const { budget, seed, can_search } = page.cell;
    inputById("budget").value = String(budget);
    inputById("seed").value = String(seed);
    if (!can_search) {
      buttonById("start").disabled = true;
      byId("found").textContent = "nothing to search: the cell file fixes every placement";
    }
    byId("search").addEventListener("submit", (event) => {
      event.preventDefault();
      this.start();
    });
    byId("stop").addEventListener("click", () => this.send("stop", {}));
    byId("accept").addEventListener("click", () => page.change("accept", {}));
  }

  async start() {
    const numberIn = (/** @type {string} */ id) => {
      const text = inputById(id).value.trim();
      return text === "" ? null : Number(text);
    };
    await this.send("search", { budget: numberIn("budget"), seed: numberIn("seed") });
    await this.look();
  }

  /**
   * @param {"search" | "stop"} request
   * @param {object} body
   */
  async send(request, body) {
    try {
      this.show((await ask(request, body)).search);
      showFault("");
    } catch (error) {
      showFault(messageOf(error));
    }
  }

  /** @param {SearchRecord | null} search */
  show(search) {
    if (!search) return;
    const { running, evaluations, budget } = search;
    buttonById("start").disabled = running || !this.page.cell.can_search;
    buttonById("stop").disabled = !running;
    buttonById("accept").disabled = running || !search.acceptable;
    const bar = /** @type {HTMLProgressElement} */ (byId("bar"));
    bar.hidden = false;
    bar.max = budget;
    bar.value = running ? evaluations : budget;
    byId("found").replaceChildren(...searchLines(search).flatMap((line) => [line, make("br")]));
  }

  /**
   * Asks the server for changes by other pages and for the progress of a search; returns whether a search
   * runs.
   */
  async look() {
    const { page } = this;
    const fault = byId("fault");
    try {
      const { revision, search } = await ask("pulse");
      this.show(search);
      if (revision !== page.now.revision && !page.isBusy()) page.show(await ask("now"));
      if (fault.dataset.gone) {
        showFault("");
        delete fault.dataset.gone;
      }
      return Boolean(search?.running);
    } catch (error) {
      showFault(messageOf(error));
      fault.dataset.gone = "yes";
      return false;
    }
  }

  /** Polls the server while the page is visible. */
  async watch() {
    const isRunning = document.hidden ? false : await this.look();
    setTimeout(() => this.watch(), isRunning ? SEARCH_INTERVAL : IDLE_INTERVAL);
  }
}

/**
 * Describes the state of a search, line by line.
 * @param {SearchRecord} search
 */
function searchLines({
  evaluations,
  budget,
  seconds,
  seed,
  start,
  best,
  gain_percent: gain,
  unit,
  ended,
  fault,
}) {
  const words = (/** @type {number | null} */ value) =>
    value === null ? "not feasible" : `${errorFigure(value)} ${unit}`;
  let gained = "";
  if (gain !== null && best !== null) gained = gain > 0.05 ? `, ${gain.toFixed(1)} % less` : ", no gain";
  const lines = [
    `${evaluations} of ${budget} layouts, ${seconds.toFixed(1)} s, seed ${seed}`,
    `start ${words(start)}, best ${words(best)}${gained}`,
  ];
  if (ended) lines.push(`ended: ${ended}`);
  if (fault) lines.push(fault);
  return lines;
}

/** Connects the panel that saves the layout as a cell file. */
function connectSaving() {
  const say = (/** @type {string} */ text, /** @type {boolean} */ isBad) => {
    byId("saved").textContent = text;
    byId("saved").className = isBad ? "bad-word" : "";
  };
  const save = async (/** @type {boolean} */ overwrite) => {
    byId("overwrite").hidden = true;
    try {
      const { saved } = await ask("save", { name: inputById("name").value, overwrite });
      say(`saved; next: sweetspot map ${saved}`, false);
    } catch (error) {
      say(messageOf(error), true);
      byId("overwrite").hidden = !(error instanceof Refused && error.answer?.taken);
    }
  };
  byId("save").addEventListener("submit", (event) => {
    event.preventDefault();
    save(false);
  });
  byId("overwrite").addEventListener("click", () => save(true));
  byId("name").addEventListener("input", () => {
    byId("overwrite").hidden = true;
  });
}
