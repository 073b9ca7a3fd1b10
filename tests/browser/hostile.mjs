// Tests every page and file that shows names with 500 hostile names. They try to be markup, scripts,
// formulas, control codes or templates. See README.md.

import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { check, checkFaults, launch, open, PATIENCE, run, soon, usage } from "./harness.mjs";

const [program, robot] = process.argv.slice(2).map((path) => resolve(path));
if (!robot) usage("node tests/browser/hostile.mjs PROGRAM cells/robots/hitachi_pw10.toml");

/** Script that leaves a trace if a name is run. */
const ATTACK = "window.hit=1";
const PAYLOADS = [
  `<script>${ATTACK}</script>`,
  `</script><script>${ATTACK}</script>`,
  `<img src=x onerror="${ATTACK}">`,
  `"><svg onload="${ATTACK}">`,
  `' onmouseover='${ATTACK}`,
  `" autofocus onfocus="${ATTACK}" x="`,
  `<iframe srcdoc="<script>parent.hit=1</script>">`,
  `<a href="javascript:${ATTACK}">a</a>`,
  `]]><script>${ATTACK}</script>`,
  `--><script>${ATTACK}</script><!--`,
  `<!--<script>`,
  `</title><script>${ATTACK}</script>`,
  `</style><script>${ATTACK}</script>`,
  `</textarea><script>${ATTACK}</script>`,
  `</svg><script>${ATTACK}</script>`,
  `<base href="http://127.0.0.1:9/">`,
  `<meta http-equiv=refresh content="0;url=//127.0.0.1:9/">`,
  `<link rel=stylesheet href=http://127.0.0.1:9/a.css>`,
  `<form action=http://127.0.0.1:9/><input name=a>`,
  `<style>*{display:none}</style>`,
  `url(http://127.0.0.1:9/b)`,
  `{{7*7}}`,
  `{% raw %}`,
  `{%- if 1 -%}`,
  `\${${ATTACK}}`,
  `=1+1`,
  `=HYPERLINK("http://127.0.0.1:9/","x")`,
  `+1+1`,
  `-1+1`,
  `@SUM(1+1)`,
  `=cmd|' /C calc'!A0`,
  `%0d%0aSet-Cookie:a=b`,
  `&lt;script&gt;`,
  `&#60;script&#62;`,
  `&amp;`,
  `%3Cscript%3E`,
  `\\u003cscript\\u003e`,
  `\\x3cscript\\x3e`,
  `%%c`,
  `\\P{\\fArial;x}`,
  `"quoted, with; separators"`,
  `a'b"c\`d`,
  `../../etc/passwd`,
  `C:\\con\\nul`,
  `$(touch /tmp/x)`,
  `; rm -rf x`,
  `| less`,
  `__proto__`,
  `constructor`,
  `toString`,
];
const NAMES = Array.from({ length: 500 }, (_, k) => `${PAYLOADS[k % PAYLOADS.length]} ${k}`);

/** Control codes that would control a terminal, and characters that reverse the reading order. */
const CONTROL_CODES = ["\u001b[2J", "\u0007", "\u009b31m", "\u202e", "\u2028", "\u0000"];

/** Elements and attributes that can come only from an unescaped name. */
const FOREIGN = [
  "iframe",
  "base",
  "form",
  "link",
  "meta[http-equiv=refresh]",
  "img[src=x]",
  "[onerror]",
  "[onload]",
  "[onfocus]",
  "[onmouseover]",
  "a[href^='javascript']",
];

/**
 * Returns whether a text has a control code, or a character that reverses the reading order.
 * @param {string} text
 * @param {boolean} bidirectional
 */
function hasControlCode(text, bidirectional) {
  return [...text].some((character) => {
    const code = character.codePointAt(0) ?? 0;
    const isControl = code < 32 && character !== "\n" && character !== "\t";
    const turns = (code >= 0x202a && code <= 0x202e) || code === 0x2028 || code === 0x2029;
    return isControl || code === 0x7f || (bidirectional && ((code >= 0x80 && code <= 0x9f) || turns));
  });
}

/**
 * Returns a text as a TOML string in ASCII.
 * @param {string} text
 */
const quoted = (text) =>
  JSON.stringify(text).replace(
    /[\u007f-\uffff]/g,
    (character) => `\\u${character.charCodeAt(0).toString(16).padStart(4, "0")}`,
  );

/** Returns a cell whose names are all hostile: 20 tables, 20 operations, 230 obstacles of one solid each. */
function hostileCell() {
  let next = 0;
  const name = () => quoted(NAMES[next++]);
  const solid = (/** @type {string} */ numbers) => `solid = [{ name = ${name()}, box = { ${numbers} } }]`;
  const lines = [
    'schema = "sweetspot/cell/1"',
    'units = { length = "mm", angle = "deg" }',
    `name = ${quoted(PAYLOADS[0])}`,
    `source = ${quoted(PAYLOADS[1])}`,
    'errors = "table-2"',
    "[robot]",
    'from = "robot.toml"',
  ];
  const operations = [];
  for (let k = 0; k < 20; k++) {
    const [table, x, y] = [name(), 700 + 90 * (k % 5), -300 + 200 * Math.floor(k / 5)];
    lines.push(
      `[equipment.${table}]`,
      "surface = { size_mm = [80, 80] }",
      "footprint = { size_mm = [80, 80] }",
      solid("centre_mm = [0, 0, -10], size_mm = [80, 80, 20]"),
      `placement = { x_mm = ${x}, y_mm = ${y}, z_mm = 600 }`,
    );
    operations.push([name(), table]);
  }
  for (const [operation, table] of operations) {
    lines.push(
      `[operation.${operation}]`,
      `on = ${table}`,
      "grid = [1, 1]",
      "standoff_mm = 100",
      "bend_deg = -90",
      'sense = "xy"',
    );
  }
  for (let k = 0; next + 2 <= NAMES.length; k++) {
    const [x, y] = [-2000 + 100 * (k % 20), -2500 + 100 * Math.floor(k / 20)];
    lines.push(
      `[obstacle.${name()}]`,
      solid("centre_mm = [0, 0, 0], size_mm = [20, 20, 20]"),
      `placement = { x_mm = ${x}, y_mm = ${y}, z_mm = 20 }`,
    );
  }
  if (next !== NAMES.length) throw new Error(`${next} names used`);
  return `${lines.join("\n")}\n`;
}

const folder = mkdtempSync(join(tmpdir(), "sweetspot-hostile-"));
const pathOf = (/** @type {string} */ file) => join(folder, file);

/**
 * Runs the program.
 * @param {string[]} args
 */
const sweetspot = (...args) =>
  spawnSync(program, args, { cwd: folder, maxBuffer: 1 << 28, encoding: "utf8", timeout: PATIENCE });

/**
 * Runs the program, which must succeed, and returns its standard output.
 * @param {string[]} args
 */
function succeed(...args) {
  const { status, stderr, stdout } = sweetspot(...args);
  check(status === 0, `sweetspot ${args.join(" ")} succeeds${status === 0 ? "" : `: ${status}, ${stderr}`}`);
  return stdout;
}

async function testTerminal() {
  const cell = hostileCell();
  writeFileSync(pathOf("cell.toml"), cell);
  writeFileSync(pathOf("robot.toml"), readFileSync(robot));
  for (const code of CONTROL_CODES) {
    writeFileSync(pathOf("escape.toml"), cell.replace(quoted(PAYLOADS[0]), quoted(`${code}x`)));
    const { status, stderr } = sweetspot("check", "escape.toml");
    check(status === 2, `a name with ${quoted(code)} is refused`);
    check(!hasControlCode(stderr, true), `the message about ${quoted(code)} has no control code`);
  }
  const shown = succeed("map", "cell.toml");
  check(!hasControlCode(shown, false), "the map on the terminal has no control code");
}

async function testFiles() {
  succeed("report", "cell.toml", "-o", "report.html");
  succeed("compare", "cell.toml", "cell.toml", "-o", "compare.html");
  for (const format of ["dxf", "glb", "svg", "csv", "json", "parquet", "png"]) {
    succeed("export", "cell.toml", "--to", format, "-o", `out.${format}`);
  }
  const csv = readFileSync(pathOf("out.csv"), "utf8");
  // A spreadsheet treats a cell that begins with one of these characters as a formula.
  check(!/(^|,)"?[=+@\t\r]/m.test(csv), "the CSV file has no formula");
  check(!/(^|,)"?-[^\d.]/m.test(csv), "the CSV file has no formula that begins with a minus");
}

/**
 * Tests one page with hostile names.
 * @param {import("playwright-core").Browser} browser
 * @param {string} file
 */
async function testPage(browser, file) {
  const url = pathToFileURL(pathOf(file)).href;
  const { page, faults } = await open(browser, url);
  const text = () => page.evaluate(() => (document.body ?? document.documentElement).textContent ?? "");
  check(
    await soon(async () => (await text()).includes("<script>window.")),
    `${file}: names are shown as they are`,
  );
  // After this time, the viewer has drawn, and every script that waits for the end of loading has run.
  await page.waitForTimeout(1000);
  // Event handlers in unescaped attributes would run when the pointer moves over their elements.
  for (let k = 0; k < 30; k++) await page.mouse.move(40 + 41 * (k % 20), 60 + 23 * k);
  const found = await page.evaluate(
    (selector) => ({
      isHit: "hit" in window,
      foreign: document.querySelectorAll(selector).length,
      head: document.body?.innerText.slice(0, 2000) ?? "",
    }),
    FOREIGN.join(", "),
  );
  check(!found.isHit, `${file}: no name is run`);
  check(found.foreign === 0, `${file}: no element comes from a name (${found.foreign})`);
  check(!/(^|\s)49(\s\d|$)/.test(found.head), `${file}: no template in a name is filled in`);
  checkFaults(faults, file);
  await page.close();
}

async function testPages() {
  const browser = await launch();
  for (const file of ["report.html", "compare.html", "out.svg"]) await testPage(browser, file);
}

await run("hostile", { terminal: testTerminal, files: testFiles, pages: testPages }, () =>
  rmSync(folder, { recursive: true, force: true }),
);
