// Requests to the server that made this page, and what comes of faults.
const $ = (id) => document.getElementById(id);

function make(tag, attributes = {}, ...inside) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in element && key !== "list") element[key] = value;
    else element.setAttribute(key, value);
  }
  // Names of a cell are texts, never markup.
  element.append(...inside);
  return element;
}

function fault(text) {
  $("fault").hidden = !text;
  $("fault").textContent = text || "";
}

class Refused extends Error {
  constructor(status, answer) {
    super((answer && answer.error) || `the server answered ${status}`);
    this.status = status;
    this.answer = answer;
  }
}

async function ask(what, body, signal) {
  const options = body === undefined
    ? { signal }
    : { method: "POST", body: JSON.stringify(body), headers: { "Content-Type": "application/json" }, signal };
  let response;
  try {
    response = await fetch(what, options);
  } catch (e) {
    if (e.name === "AbortError") throw e;
    throw new Error("the program that showed this page has ended; what was saved is kept");
  }
  const answer = await response.json();
  if (!response.ok) throw new Refused(response.status, answer);
  return answer;
}

// mm and degrees as a person writes them: no more digits than say something.
const short = (v, digits = 3) => (Object.is(v, null) ? "" : String(+(+v).toFixed(digits)));
const error = (v) => {
  const size = Math.abs(v);
  return v.toFixed(size >= 100 ? 1 : size >= 10 ? 2 : size >= 1 ? 3 : size >= 0.01 ? 4 : 6);
};
