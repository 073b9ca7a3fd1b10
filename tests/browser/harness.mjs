// Common part of the browser tests: Chromium, watched pages, checks and their summary.
//
// Exit codes of a test: 0 if every check holds, 1 if a check fails, 2 if the arguments are wrong.

import { setTimeout as sleep } from "node:timers/promises";
import { chromium } from "playwright-core";

/** Flags of Chromium: nothing from outside, no sandbox (root), WebGL by software. */
const FLAGS = [
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];
const SOFTWARE_WEBGL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const NO_WEBGL = ["--disable-3d-apis"];

/** Longest time that any step may take on a busy machine, ms. */
export const PATIENCE = 300_000;

/** Messages about reading a picture back, which only the tests do. */
const HARMLESS = /GPU stall due to ReadPixels/;

let count = 0;
/** @type {string[]} */
const failures = [];

/**
 * Records whether a check holds.
 * @param {boolean} holds
 * @param {string} what
 */
export function check(holds, what) {
  count += 1;
  if (!holds) failures.push(what);
  console.log(`${holds ? "ok  " : "FAIL"} ${what}`);
}

/**
 * Waits until a condition holds, and records whether this happened in time.
 * @param {() => Promise<boolean>} holds
 * @param {string} what
 */
export async function checkSoon(holds, what) {
  check(await soon(holds), what);
}

/**
 * Waits until a condition holds. Returns whether this happened in time.
 * @param {() => Promise<boolean>} holds
 * @param {number} [patience] ms
 */
export async function soon(holds, patience = 60_000) {
  const end = performance.now() + patience;
  while (!(await holds())) {
    if (performance.now() > end) return false;
    await sleep(50);
  }
  return true;
}

/**
 * Runs the parts of a test one after another, prints how long each part took, and ends the process.
 * @param {string} name
 * @param {Record<string, () => Promise<void>>} parts
 * @param {() => void} [cleanUp]
 * @returns {Promise<never>}
 */
export async function run(name, parts, cleanUp = () => undefined) {
  const start = performance.now();
  for (const [part, test] of Object.entries(parts)) {
    const began = performance.now();
    try {
      await test();
    } catch (error) {
      check(false, `${part} runs to its end: ${error instanceof Error ? error.stack : error}`);
    }
    console.log(`     ${part}: ${seconds(began)}`);
  }
  for (const browser of browsers) await browser.close();
  cleanUp();
  for (const failure of failures) console.error(`FAILED ${failure}`);
  const result = failures.length ? `${failures.length} of ${count} checks fail` : `all ${count} checks hold`;
  console.log(`${name}: ${result}, ${seconds(start)}`);
  process.exit(failures.length ? 1 : 0);
}

/**
 * Formats the time since a moment.
 * @param {number} since ms
 */
const seconds = (since) => `${((performance.now() - since) / 1000).toFixed(1)} s`;

/**
 * Ends the process with a usage message.
 * @param {string} text
 * @returns {never}
 */
export function usage(text) {
  console.error(`usage: ${text}`);
  process.exit(2);
}

/** @type {import("playwright-core").Browser[]} */
const browsers = [];

/**
 * Starts Chromium with a new, empty profile.
 * @param {{ webgl?: boolean }} [options]
 */
export async function launch({ webgl = true } = {}) {
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
    args: [...FLAGS, ...(webgl ? SOFTWARE_WEBGL : NO_WEBGL)],
    timeout: PATIENCE,
  });
  browsers.push(browser);
  return browser;
}

/**
 * Opens a page and records its errors, warnings, dialogs and requests, which should not occur.
 * @param {import("playwright-core").Browser} browser
 * @param {string} url
 * @param {object} [options]
 * @param {import("playwright-core").BrowserContextOptions} [options.context]
 * @param {(url: string) => boolean} [options.mayAsk] whether the page may request an address besides its own
 * @param {RegExp} [options.expected] messages that are expected
 */
export async function open(browser, url, { context = {}, mayAsk = () => false, expected = HARMLESS } = {}) {
  const page = await browser.newPage({ viewport: { width: 520, height: 520 }, ...context });
  page.setDefaultTimeout(PATIENCE);
  /** @type {string[]} */
  const faults = [];
  page.on("console", (message) => {
    const isBad = ["error", "warning"].includes(message.type());
    const text = message.text();
    if (isBad && !HARMLESS.test(text) && !expected.test(text)) faults.push(`${message.type()}: ${text}`);
  });
  page.on("pageerror", (error) => faults.push(`error: ${error.message}`));
  page.on("dialog", (dialog) => {
    faults.push(`dialog: ${dialog.message()}`);
    dialog.dismiss();
  });
  page.on("request", (request) => {
    const asked = request.url();
    if (asked !== url && !asked.startsWith("data:") && !mayAsk(asked)) faults.push(`request: ${asked}`);
  });
  await page.goto(url);
  return { page, faults };
}

/**
 * Checks that a page had no errors, warnings, dialogs or unexpected requests.
 * @param {string[]} faults
 * @param {string} name
 */
export function checkFaults(faults, name) {
  const list = faults.length ? `: ${faults.slice(0, 5).join(" | ")}` : "";
  check(faults.length === 0, `${name}: no error, no warning, no dialog, no request${list}`);
}
