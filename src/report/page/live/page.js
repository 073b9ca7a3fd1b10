// The page of `sweetspot view`: the step shown, and the controls that change it.

/** Delay between the last change and the slow requests, ms. */
const PAUSE = 150;

class Page {
  /** @param {CellRecord} cell */
  constructor(cell) {
    this.cell = cell;
    this.now = cell.now;
    const onMove = (
      /** @type {number} */ index,
      /** @type {Placement} */ world,
      /** @type {boolean} */ isSettled,
    ) => this.move(index, world, isSettled);
    this.plan = new Plan(/** @type {SVGSVGElement} */ (/** @type {Element} */ (byId("plan"))), cell, onMove);
    this.plan.onGrip = (index) => this.showStanding(index);
    this.form = new Form(byId("form"), cell.form, (numbers, row) => this.change("layout", numbers, row));
    /** @type {View3d | null} */
    this.view3d = null;
    /**
     * Numbers of the layout to be tried next, while a request is under way.
     * @type {object | null}
     */
    this.waiting = null;
    this.isTrying = false;
    /** Number of the last change; answers to earlier changes are dropped. */
    this.serial = 0;
    this.pauseTimer = 0;
    this.connect();
  }

  connect() {
    const { cell, robot, errors, file } = this.cell;
    document.title = `${cell} · sweetspot view`;
    byId("title").textContent = cell;
    byId("subtitle").textContent = `${robot}, errors ${errors} · ${file}`;
    for (const request of /** @type {const} */ (["undo", "redo", "reset"])) {
      byId(request).addEventListener("click", () => this.change(request, {}));
    }
    for (const id of ["sense", "reading", "model"]) {
      byId(id).addEventListener("change", () => this.changeQuestion());
    }
    document.addEventListener("keydown", (event) => this.pressKey(event));
    // Texts break differently in a window of another width, so the height kept by showRoom no longer fits.
    addEventListener("resize", () => byId("room").style.removeProperty("min-height"));
    new ResizeObserver(() => {
      if (!this.plan.held) this.plan.draw(this.now.answer);
    }).observe(byId("plan"));
  }

  /** @param {KeyboardEvent} event */
  pressKey(event) {
    const isTyping = event.target instanceof HTMLInputElement;
    if (!(event.ctrlKey || event.metaKey) || isTyping) return;
    const key = event.key.toLowerCase();
    const isUndo = key === "z" && !event.shiftKey;
    const isRedo = key === "y" || (key === "z" && event.shiftKey);
    if (!isUndo && !isRedo) return;
    event.preventDefault();
    this.change(isUndo ? "undo" : "redo", {});
  }

  /** Returns whether a drag or the evaluation of a dragged layout is under way. */
  isBusy() {
    return Boolean(this.plan.held || this.waiting || this.isTrying);
  }

  /**
   * Shows the map of a layout during a drag. Sends one request at a time; after each answer, only the newest
   * layout is sent.
   * @param {object} numbers
   */
  async attempt(numbers) {
    this.waiting = numbers;
    if (this.isTrying) return;
    this.isTrying = true;
    while (this.waiting) {
      const [asked, serial] = [this.waiting, this.serial];
      this.waiting = null;
      try {
        // The 3-D view shows the new map only during a drag in that view.
        const answer = await ask(this.view3d?.held ? "try-drawing" : "try", asked);
        // If the equipment was dropped in the meantime, the answer to the drop takes precedence.
        if (serial === this.serial) this.showAttempt(answer);
      } catch (error) {
        if (serial === this.serial) showFault(messageOf(error));
      }
      // Waits until the picture is shown: a queue of pictures would delay the drop.
      await new Promise((done) => afterPaint(() => done(null)));
    }
    this.isTrying = false;
  }

  /** @param {TryRecord} record */
  showAttempt({ answer, numbers, drawing }) {
    this.plan.draw(answer);
    this.form.show(numbers);
    showVerdict(answer, null);
    const { view3d } = this;
    if (!drawing || !view3d) return;
    view3d.replace(drawing);
    if (view3d.held) view3d.move(view3d.held.index, view3d.held.now);
  }

  /**
   * Changes the layout or the evaluation settings (sense, reading, model), and shows the answer.
   * @param {ChangeRequest} request
   * @param {object} body
   * @param {FormRow} [row] row of the form in which the change was typed
   */
  async change(request, body, row) {
    const began = performance.now();
    this.serial += 1;
    const { serial } = this;
    this.waiting = null;
    try {
      const step = await ask(request, body);
      showFault("");
      if (serial !== this.serial) return;
      this.show(step);
      afterPaint(() => window.sweetspotDrawn.push(performance.now() - began));
    } catch (error) {
      if (row) this.form.refuse(row, messageOf(error));
      else showFault(messageOf(error));
      if (serial === this.serial && !row) this.show(this.now);
    }
  }

  changeQuestion() {
    const [sense, reading, model] = ["sense", "reading", "model"].map((id) => inputById(id).value);
    this.change("question", { sense: sense || null, reading, model });
  }

  /** @param {StepRecord} step */
  show(step) {
    this.now = step;
    this.plan.draw(step.answer);
    this.form.show(step.numbers);
    showVerdict(step.answer, step);
    const { undo, redo } = step;
    buttonById("undo").disabled = undo === 0;
    buttonById("redo").disabled = redo === 0;
    byId("depth").textContent = undo ? `${undo} step${undo > 1 ? "s" : ""}` : "as in the file";
    this.showQuestion(step);
    // The map is drawn first, because the 3-D view is slow without a graphics card.
    afterPaint(() => this.refreshView3d());
    clearTimeout(this.pauseTimer);
    showRoom(ROOM_IN_WORK);
    this.pauseTimer = setTimeout(async () => {
      await this.refreshReach();
      await this.refreshRoom();
    }, PAUSE);
  }

  /**
   * Shows the senses, readings and models to choose from.
   * @param {StepRecord} step
   */
  showQuestion({ question, lenses }) {
    const fill = (
      /** @type {string} */ id,
      /** @type {[string, string][]} */ all,
      /** @type {string} */ chosen,
    ) => {
      const options = all.map(([value, text]) => make("option", { value, selected: value === chosen }, text));
      byId(id).replaceChildren(...options);
    };
    const same = (/** @type {string} */ text) => /** @type {[string, string]} */ ([text, text]);
    fill("sense", [["", "as in the cell"], ...this.cell.senses.map(same)], question.sense || "");
    fill("reading", [...new Map(lenses.map(({ reading, word }) => [reading, word]))], question.reading);
    fill("model", [...new Set(lenses.map(({ model }) => model))].map(same), question.model);
  }

  async refreshView3d() {
    if (!this.view3d) return;
    const { revision } = this.now;
    try {
      const written = await ask("drawing");
      if (revision === this.now.revision && !this.view3d.held) this.view3d.replace(written);
    } catch (error) {
      showFault(messageOf(error));
    }
  }

  async refreshRoom() {
    const { revision } = this.now;
    try {
      const room = await ask("room");
      if (revision === this.now.revision) showRoom(room);
    } catch (error) {
      showRoom("not known");
      showFault(messageOf(error));
    }
  }

  /**
   * Shows where a gripped piece may stand: first coarsely, then finely if the user still holds the piece.
   * @param {number} index
   */
  async showStanding(index) {
    const { held } = this.plan;
    for (const refined of [false, true]) {
      try {
        const { outline } = await ask("standing", { equipment: index, refined });
        if (this.plan.held !== held) return;
        this.plan.showStanding(outline);
      } catch (error) {
        showFault(messageOf(error));
        return;
      }
      await this.plan.stillness();
      if (this.plan.held !== held) return;
    }
  }

  async refreshReach() {
    const { revision } = this.now;
    try {
      const { outlines } = await ask("reach");
      if (revision === this.now.revision) this.plan.showReach(outlines);
    } catch (error) {
      showFault(messageOf(error));
    }
  }

  /**
   * Moves a piece of equipment, and returns the allowed placement that is nearest to the wanted placement.
   * @param {number} index
   * @param {Placement} world
   * @param {boolean} isSettled whether the drag has ended
   */
  move(index, world, isSettled) {
    const { numbers, allowed, moves } = this.numbersOf(index, world);
    if (this.view3d && (this.view3d.held || this.view3d.isQuick)) this.view3d.move(index, allowed);
    if (!isSettled) this.attempt(moves ? numbers : {});
    else if (moves) this.change("layout", numbers);
    else this.show(this.now);
    return allowed;
  }

  /**
   * Returns the numbers that change for a placement in the world, and the placement that they allow.
   * @param {number} index
   * @param {Placement} world
   */
  numbersOf(index, world) {
    const { name, on } = this.cell.equipment[index];
    const under = on === null ? [0, 0, 0, 0] : this.plan.pieces[on].at;
    const group = this.cell.form.find((one) => one.group === "equipment" && one.index === index);
    /** @type {Numbers} */
    const changed = {};
    if (!group) return { numbers: {}, allowed: world, moves: false };
    const wanted = placementIn(world, under);
    const current = numbersIn(this.now.numbers, group);
    const allowed = group.numbers.map((number, k) => {
      const before = current[number.key];
      if (!mayMove(group, k) || Math.abs(wanted[k] - before) < 1e-4) return before;
      const value = allowedValue(number, Number(wanted[k].toFixed(3)), k === 3);
      changed[number.key] = value;
      return value;
    });
    const moves = Object.keys(changed).length > 0;
    return { numbers: { equipment: { [name]: changed } }, allowed: placementFrom(allowed, under), moves };
  }

  /** Shows the 3-D view if the browser supports WebGL. */
  async addView3d() {
    if (!sweetspotViewer.supported()) return;
    byId("solid").hidden = false;
    document.querySelector("main")?.classList.add("both");
    this.view3d = new View3d(this, await ask("drawing"));
  }
}

/**
 * Returns whether a drag may change number `k` of x, y, z and yaw. A drag may always change yaw and never z.
 * A drag may change x or y if this coordinate is free, or if the file fixes both x and y.
 * @param {NumberGroup} group
 * @param {number} k
 */
function mayMove({ numbers }, k) {
  if (k === 2) return false;
  return k === 3 || numbers[k].free || (!numbers[0].free && !numbers[1].free);
}

/**
 * Returns the allowed value of a number that is nearest to the wanted value.
 * @param {NumberRecord} number
 * @param {number} wanted
 * @param {boolean} isAngle
 */
function allowedValue({ list, min, max }, wanted, isAngle) {
  if (list) return nearest(list, wanted);
  if (min === null || max === null) return wanted;
  let value = wanted;
  if (isAngle) {
    while (value > max && value - 360 >= min) value -= 360;
    while (value < min && value + 360 <= max) value += 360;
  }
  return Math.min(Math.max(value, min), max);
}

/** Starts the page. */
async function begin() {
  const page = new Page(await ask("state"));
  window.sweetspotDrawn = [];
  window.sweetspotSpot = (name) =>
    page.view3d?.spot(page.cell.equipment.findIndex((one) => one.name === name)) ?? null;
  connectSaving();
  const search = new SearchPanel(page);
  page.show(page.now);
  await page.addView3d();
  search.watch();
}

begin().catch((error) => showFault(messageOf(error)));
