// Every number of the layout, to be typed.
const WORDS = { x_mm: "x", y_mm: "y", z_mm: "z", yaw_deg: "yaw", bend_deg: "bend", azimuth_deg: "azimuth", spin_deg: "spin" };

// What is sent for one number of a group.
const named = (group, key, value) =>
  group.group === "robot_base" ? { robot_base: { [key]: value } } : { [group.group]: { [group.name]: { [key]: value } } };
const owned = (numbers, group) => (group.group === "robot_base" ? numbers.robot_base : numbers[group.group][group.name]);

class Form {
  // `typed(numbers, row)`: a number was typed.
  constructor(host, groups, typed) {
    this.rows = [];
    const free = (group) => group.numbers.some((n) => n.free);
    for (const group of groups) {
      const quiet = groups.some(free) ? !free(group) : group.group === "robot_base";
      const card = make(quiet ? "details" : "section", { className: "card" });
      card.append(quiet ? make("summary", {}, group.name) : make("h2", {}, group.name));
      for (const number of group.numbers) card.append(this.row(group, number, typed));
      host.append(card);
    }
  }

  row(group, number, typed) {
    const unit = number.key.endsWith("_deg") ? "°" : "mm";
    const label = `${group.name} ${WORDS[number.key]}`;
    let input;
    if (number.list) {
      input = make("select", { "aria-label": label }, ...number.list.map((v) => make("option", { value: String(v) }, short(v))));
    } else {
      input = make("input", { type: "number", step: unit === "°" ? "0.5" : "1", "aria-label": label });
      if (number.free) Object.assign(input, { min: number.min, max: number.max });
    }
    const range = number.list ? `${unit}, one of ${number.list.length}`
      : number.free ? `${unit}, ${short(number.min)} … ${short(number.max)}` : `${unit}, fixed in the file`;
    const why = make("span", { className: "why", hidden: true });
    const row = make("label", { className: "number" }, make("span", {}, WORDS[number.key]), input, make("small", {}, range), why);
    const entry = { group, number, input, row, why };
    input.dataset.of = `${group.group}/${group.name}/${number.key}`;
    input.addEventListener("change", () => {
      const value = input.value.trim() === "" ? NaN : Number(input.value);
      if (!Number.isFinite(value)) return this.refuse(entry, "it must be a number");
      typed(named(group, number.key, value), entry);
    });
    this.rows.push(entry);
    return row;
  }

  refuse(entry, text) {
    entry.row.classList.add("bad");
    entry.why.textContent = text;
    entry.why.hidden = false;
  }

  show(numbers) {
    for (const entry of this.rows) {
      const { group, number, input, row, why } = entry;
      row.classList.remove("bad");
      why.hidden = true;
      const value = owned(numbers, group)[number.key];
      if (number.list) {
        const near = number.list.reduce((a, b) => (Math.abs(b - value) < Math.abs(a - value) ? b : a));
        input.value = String(near);
      } else if (document.activeElement !== input || Number(input.value) !== value) {
        input.value = short(value, 6);
      }
    }
  }
}
