// Requests to the server of this page, and elements of the page.

/**
 * Returns the element with an id.
 * @template {HTMLElement} [Kind=HTMLElement]
 * @param {string} id
 * @returns {Kind}
 */
const byId = (id) => {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element ${id}`);
  return /** @type {Kind} */ (found);
};

/**
 * Returns the input with an id.
 * @param {string} id
 * @returns {HTMLInputElement}
 */
const inputById = (id) => byId(id);

/**
 * Returns the button with an id.
 * @param {string} id
 * @returns {HTMLButtonElement}
 */
const buttonById = (id) => byId(id);

/**
 * Makes an HTML element. Names of a cell become text nodes, never markup.
 * @template {keyof HTMLElementTagNameMap} Name
 * @param {Name} name
 * @param {Record<string, unknown>} [properties]
 * @param {(Node | string)[]} children
 * @returns {HTMLElementTagNameMap[Name]}
 */
function make(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in made) Reflect.set(made, key, value);
    else made.setAttribute(key, String(value));
  }
  made.append(...children);
  return made;
}

/**
 * Shows an error message; an empty text hides the message.
 * @param {string} text
 */
function showFault(text) {
  byId("fault").hidden = !text;
  byId("fault").textContent = text;
}

/**
 * Returns the message of an error.
 * @param {unknown} error
 */
const messageOf = (error) => (error instanceof Error ? error.message : String(error));

/** A request that the server refused. */
class Refused extends Error {
  /**
   * @param {number} status
   * @param {Refusal | null} answer
   */
  constructor(status, answer) {
    super(answer?.error || `the server answered with status ${status}`);
    this.answer = answer;
  }
}

/**
 * Sends a request to the server: POST with a body, GET without.
 * @template {keyof Answers} Name
 * @param {Name} name
 * @param {unknown} [body]
 * @returns {Promise<Answers[Name]>}
 */
async function ask(name, body) {
  const headers = { "Content-Type": "application/json" };
  const options = body === undefined ? {} : { method: "POST", body: JSON.stringify(body), headers };
  let response;
  try {
    response = await fetch(name, options);
  } catch {
    throw new Error("cannot reach the server: sweetspot view has ended (saved cells are kept)");
  }
  const answer = await response.json();
  if (!response.ok) throw new Refused(response.status, answer);
  return answer;
}

/**
 * Calls `then` after the browser has shown the next frame.
 * @param {() => void} then
 */
const afterPaint = (then) => {
  requestAnimationFrame(() => setTimeout(then));
};

/**
 * Formats a number of mm or degrees without needless digits.
 * @param {number} value
 * @param {number} [digits]
 */
const shortNumber = (value, digits = 3) => String(Number(value.toFixed(digits)));

/**
 * Formats an error with about four significant digits.
 * @param {number} value
 */
function errorFigure(value) {
  const limits = [100, 10, 1, 0.01];
  const digits = [1, 2, 3, 4, 6];
  const place = limits.findIndex((limit) => Math.abs(value) >= limit);
  return value.toFixed(digits[place < 0 ? limits.length : place]);
}
