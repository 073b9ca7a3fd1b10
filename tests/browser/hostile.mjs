// 500 names that try to be markup, scripts, formulas, control codes or templates, through every page
// and file that shows names. See README.md for how to run it.
import { createRequire } from "node:module";
import { spawnSync } from "node:child_process";
import { mkdtempSync, writeFileSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const { chromium } = createRequire(import.meta.url)("playwright-core");
const [program, robot] = process.argv.slice(2).map((p) => resolve(p));
if (!robot) {
  console.error("usage: node hostile.mjs PROGRAM CELLS/robots/hitachi_pw10.toml");
  process.exit(2);
}

const MARK = "hit";
const run = `window.${MARK}=1`;
const PAYLOADS = [
  `<script>${run}</script>`, `</script><script>${run}</script>`, `<img src=x onerror="${run}">`,
  `"><svg onload="${run}">`, `' onmouseover='${run}`, `" autofocus onfocus="${run}" x="`,
  `<iframe srcdoc="<script>parent.hit=1</script>">`, `<a href="javascript:${run}">a</a>`,
  `]]><script>${run}</script>`, `--><script>${run}</script><!--`, `<!--<script>`, `</title><script>${run}</script>`,
  `</style><script>${run}</script>`, `</textarea><script>${run}</script>`, `</svg><script>${run}</script>`,
  `<base href="http://127.0.0.1:9/">`, `<meta http-equiv=refresh content="0;url=//127.0.0.1:9/">`,
  `<link rel=stylesheet href=http://127.0.0.1:9/a.css>`, `<form action=http://127.0.0.1:9/><input name=a>`,
  `<style>*{display:none}</style>`, `url(http://127.0.0.1:9/b)`, `{{7*7}}`, `{% raw %}`, `{%- if 1 -%}`, `\${${run}}`,
  `=1+1`, `=HYPERLINK("http://127.0.0.1:9/","x")`, `+1+1`, `-1+1`, `@SUM(1+1)`, `=cmd|' /C calc'!A0`, `%0d%0aSet-Cookie:a=b`,
  `&lt;script&gt;`, `&#60;script&#62;`, `&amp;`, `%3Cscript%3E`, `\\u003cscript\\u003e`, `\\x3cscript\\x3e`,
  `%%c`, `\\P{\\fArial;x}`, `"quoted, with; separators"`, `a'b"c\`d`, `../../etc/passwd`, `C:\\con\\nul`, `$(touch /tmp/x)`,
  `; rm -rf x`, `| less`, `__proto__`, `constructor`, `toString`,
];
const names = Array.from({ length: 500 }, (_, k) => `${PAYLOADS[k % PAYLOADS.length]} ${k}`);
const text = (s) => JSON.stringify(s).replace(/[\u007f-\uffff]/g, (c) => "\\u" + c.charCodeAt(0).toString(16).padStart(4, "0"));

/** A cell whose every name is hostile: 20 tables, 20 operations, 230 obstacles of one solid each. */
function cell() {
  let next = 0;
  const name = () => text(names[next++]);
  const lines = [
    'schema = "sweetspot/cell/1"', 'units = { length = "mm", angle = "deg" }', 'name = ' + text(PAYLOADS[0]),
    'source = ' + text(PAYLOADS[1]), 'errors = "table-2"', "[robot]", 'from = "robot.toml"',
  ];
  const operations = [];
  for (let k = 0; k < 20; k++) {
    const [table, x, y] = [name(), 700 + 90 * (k % 5), -300 + 200 * Math.floor(k / 5)];
    lines.push(`[equipment.${table}]`, "surface = { size_mm = [80, 80] }", "footprint = { size_mm = [80, 80] }",
      `solid = [{ name = ${name()}, box = { centre_mm = [0, 0, -10], size_mm = [80, 80, 20] } }]`,
      `placement = { x_mm = ${x}, y_mm = ${y}, z_mm = 600 }`);
    operations.push([name(), table]);
  }
  for (const [operation, table] of operations) {
    lines.push(`[operation.${operation}]`, `on = ${table}`, "grid = [1, 1]", "standoff_mm = 100", "bend_deg = -90", 'sense = "xy"');
  }
  for (let k = 0; next + 2 <= names.length; k++) {
    lines.push(`[obstacle.${name()}]`,
      `solid = [{ name = ${name()}, box = { centre_mm = [0, 0, 0], size_mm = [20, 20, 20] } }]`,
      `placement = { x_mm = ${-2000 + 100 * (k % 20)}, y_mm = ${-2500 + 100 * Math.floor(k / 20)}, z_mm = 20 }`);
  }
  if (next !== names.length) throw new Error(`${next} names used`);
  return lines.join("\n") + "\n";
}

const folder = mkdtempSync(join(tmpdir(), "sweetspot-hostile-"));
const at = (file) => join(folder, file);
const failures = [];
const check = (good, what) => { if (!good) failures.push(what); };
const sweetspot = (...args) => {
  const ran = spawnSync(program, args, { cwd: folder, maxBuffer: 1 << 28 });
  check(ran.status === 0, `${args.join(" ")} ended with ${ran.status}: ${ran.stderr}`);
  return ran.stdout;
};
try {
  writeFileSync(at("cell.toml"), cell());
  writeFileSync(at("robot.toml"), readFileSync(robot));
  // What would talk to the terminal, or turn the reading order, is refused, and told harmlessly.
  for (const code of ["\u001b[2J", "\u0007", "\u009b31m", "\u202e", "\u2028", "\u0000"]) {
    writeFileSync(at("escape.toml"), cell().replace(text(PAYLOADS[0]), text(code + "x")));
    const refused = spawnSync(program, ["check", "escape.toml"], { cwd: folder });
    check(refused.status === 2, `a name with ${text(code)} was accepted`);
    check(!/[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u202a-\u202e\u2028\u2029]/.test(refused.stderr.toString()), `${text(code)} reached the terminal`);
  }
  const said = sweetspot("map", "cell.toml").toString();
  check(!/[\u0000-\u0008\u000b-\u001f\u007f]/.test(said), "control characters on the terminal");
  sweetspot("report", "cell.toml", "-o", "report.html");
  sweetspot("compare", "cell.toml", "cell.toml", "-o", "compare.html");
  for (const to of ["dxf", "glb", "svg", "csv", "json", "parquet", "png"]) sweetspot("export", "cell.toml", "--to", to, "-o", `out.${to}`);
  const csv = readFileSync(at("out.csv"), "utf8");
  // A cell that begins with one of these is run by a spreadsheet.
  check(!/(^|,)"?[=+@\t\r]/m.test(csv), "a formula in the CSV");
  check(!/(^|,)"?-[^\d.]/m.test(csv), "a formula in the CSV that begins with a minus");

  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
      "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  for (const file of ["report.html", "compare.html", "out.svg"]) {
    const page = await browser.newPage();
    page.on("dialog", (d) => { failures.push(`${file}: a dialog`); d.dismiss(); });
    page.on("console", (m) => { if (m.type() === "error") failures.push(`${file}: ${m.text()}`); });
    page.on("pageerror", (e) => failures.push(`${file}: ${e.message}`));
    page.on("request", (r) => { if (!r.url().startsWith("file:") && !r.url().startsWith("data:")) failures.push(`${file}: request ${r.url()}`); });
    await page.goto(pathToFileURL(at(file)).href);
    await page.waitForTimeout(1500);
    // Hovering is what unescaped attributes wait for.
    for (let k = 0; k < 30; k++) await page.mouse.move(40 + 41 * (k % 20), 60 + 23 * k);
    const found = await page.evaluate((mark) => ({
      ran: mark in window,
      foreign: document.querySelectorAll("iframe, base, form, link, meta[http-equiv=refresh], img[src=x], [onerror], [onload], [onfocus], [onmouseover], a[href^='javascript']").length,
      templates: document.body ? /(^|\s)49(\s\d|$)/.test(document.body.innerText.slice(0, 2000)) : false,
      shown: (document.body ?? document.documentElement).textContent.includes("<script>window."),
    }), MARK);
    check(!found.ran, `${file}: a name was run`);
    check(found.foreign === 0, `${file}: ${found.foreign} elements came from names`);
    check(!found.templates, `${file}: a template in a name was filled in`);
    check(found.shown, `${file}: the names are not shown as they are`);
    await page.close();
  }
  await browser.close();
} finally {
  rmSync(folder, { recursive: true, force: true });
}
failures.forEach((f) => console.error("FAILED " + f));
console.log(failures.length ? `${failures.length} failures` : "500 hostile names: all neutral");
process.exit(failures.length ? 1 : 0);
