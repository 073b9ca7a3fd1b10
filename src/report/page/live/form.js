// The form: every number of the layout.

/**
 * Names of the numbers by their keys.
 * @type {Record<string, string>}
 */
const NUMBER_NAMES = {
  x_mm: "x",
  y_mm: "y",
  z_mm: "z",
  yaw_deg: "yaw",
  bend_deg: "bend",
  azimuth_deg: "azimuth",
  spin_deg: "spin",
};

/**
 * Returns the request that changes one number.
 * @param {NumberGroup} group
 * @param {string} key
 * @param {number} value
 */
function numberRequest({ group, name }, key, value) {
  return { [group]: group === "robot_base" ? { [key]: value } : { [name]: { [key]: value } } };
}

/**
 * Returns the numbers of a group.
 * @param {LayoutNumbers} numbers
 * @param {NumberGroup} group
 */
const numbersIn = (numbers, { group, name }) =>
  group === "robot_base" ? numbers.robot_base : numbers[group][name];

/**
 * A row of the form.
 * @typedef {object} FormRow
 * @property {NumberGroup} group
 * @property {NumberRecord} number
 * @property {HTMLInputElement | HTMLSelectElement} input
 * @property {HTMLElement} label
 * @property {HTMLElement} refusal
 */

class Form {
  /**
   * @param {HTMLElement} host
   * @param {NumberGroup[]} groups
   * @param {(numbers: object, row: FormRow) => void} onChange
   */
  constructor(host, groups, onChange) {
    this.onChange = onChange;
    /** @type {FormRow[]} */
    this.rows = [];
    const isFree = (/** @type {NumberGroup} */ group) => group.numbers.some((number) => number.free);
    const anyFree = groups.some(isFree);
    for (const group of groups) {
      // Groups that a search cannot change are folded.
      const isFolded = anyFree ? !isFree(group) : group.group === "robot_base";
      const card = make(isFolded ? "details" : "section", { className: "card" });
      card.append(make(isFolded ? "summary" : "h2", {}, group.name));
      card.append(...group.numbers.map((number) => this.makeRow(group, number)));
      host.append(card);
    }
  }

  /**
   * @param {NumberGroup} group
   * @param {NumberRecord} number
   */
  makeRow(group, number) {
    const name = NUMBER_NAMES[number.key];
    const unit = number.key.endsWith("_deg") ? "°" : "mm";
    const input = numberInput(number, unit, `${group.name} ${name}`);
    const refusal = make("span", { className: "why", hidden: true });
    const range = make("small", {}, rangeWords(number, unit));
    const label = make("label", { className: "number" }, make("span", {}, name), input, range, refusal);
    const row = { group, number, input, label, refusal };
    input.dataset.of = `${group.group}/${group.name}/${number.key}`;
    input.addEventListener("change", () => this.read(row));
    this.rows.push(row);
    return label;
  }

  /** @param {FormRow} row */
  read(row) {
    const text = row.input.value.trim();
    const value = text === "" ? Number.NaN : Number(text);
    if (Number.isFinite(value)) this.onChange(numberRequest(row.group, row.number.key, value), row);
    else this.refuse(row, "enter a number");
  }

  /**
   * Shows beside a number why the number is refused.
   * @param {FormRow} row
   * @param {string} text
   */
  refuse({ label, refusal }, text) {
    label.classList.add("bad");
    refusal.textContent = text;
    refusal.hidden = false;
  }

  /** @param {LayoutNumbers} numbers */
  show(numbers) {
    for (const { group, number, input, label, refusal } of this.rows) {
      label.classList.remove("bad");
      refusal.hidden = true;
      const value = numbersIn(numbers, group)[number.key];
      const isTyped = document.activeElement === input && Number(input.value) === value;
      if (number.list) input.value = String(nearest(number.list, value));
      else if (!isTyped) input.value = shortNumber(value, 6);
    }
  }
}

/**
 * Makes the input of a number: a list of choices or a field.
 * @param {NumberRecord} number
 * @param {string} unit
 * @param {string} label
 */
function numberInput(number, unit, label) {
  if (number.list) {
    const options = number.list.map((value) => make("option", { value: String(value) }, shortNumber(value)));
    return make("select", { "aria-label": label }, ...options);
  }
  const input = make("input", { type: "number", step: unit === "°" ? "0.5" : "1", "aria-label": label });
  if (number.free) Object.assign(input, { min: number.min, max: number.max });
  return input;
}

/**
 * Describes the values that a number may have.
 * @param {NumberRecord} number
 * @param {string} unit
 */
function rangeWords({ list, min, max }, unit) {
  if (list) return `${unit}, one of ${list.length} values`;
  if (min === null || max === null) return `${unit}, fixed in the file`;
  return `${unit}, ${shortNumber(min)} … ${shortNumber(max)}`;
}
