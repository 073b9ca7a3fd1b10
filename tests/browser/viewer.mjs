// Looks at a page of ours in a real Chromium: nothing is wrong, nothing is asked for, every switch shows.
// See README.md beside this file. Exit code 0: all holds, 1: something does not, 2: it could not be tried.

import { mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const BROWSER = process.env.CHROMIUM || "/usr/bin/chromium";
const CALM = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync"];
const DRAWN_BY_SOFTWARE = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

const faults = [];
let checked = 0;
function check(holds, what) {
  checked += 1;
  if (!holds) faults.push(what);
  console.log(`${holds ? "ok  " : "FAIL"} ${what}`);
}

function playwright() {
  // NODE_PATH, or the folder that holds playwright-core.
  const folders = [process.env.PLAYWRIGHT, ...(process.env.NODE_PATH || "").split(":")].filter(Boolean);
  for (const folder of folders) {
    try {
      return createRequire(join(resolve(folder), "x.js"))("playwright-core");
    } catch {}
  }
  console.error("playwright-core is not found: set NODE_PATH to the node_modules that holds it");
  process.exit(2);
}

/** A page that tells everything it should not do. */
async function open(browser, url, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 }, ...options });
  const said = [];
  page.on("console", (m) => ["error", "warning"].includes(m.type()) && said.push(`${m.type()}: ${m.text()}`));
  page.on("pageerror", (e) => said.push(`error: ${e.message}`));
  page.on("dialog", (d) => {
    said.push(`dialog: ${d.message()}`);
    d.dismiss();
  });
  page.on("request", (r) => r.url() !== url && !r.url().startsWith("data:") && said.push(`request: ${r.url()}`));
  await page.goto(url);
  await page.waitForTimeout(400);
  return { page, said };
}

/** Two pictures drawn after a change. */
const settled = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 60)))));

/** What the canvas shows, in few numbers: of a coarse grid of pixels their colours. */
const seen = (page) => page.evaluate(() => {
  const canvas = document.querySelector(".ss-stage canvas");
  const small = document.createElement("canvas");
  [small.width, small.height] = [240, 160];
  const pen = small.getContext("2d");
  pen.drawImage(canvas, 0, 0, 240, 160);
  return [...pen.getImageData(0, 0, 240, 160).data];
});

const changed = (a, b) => {
  let count = 0;
  for (let k = 0; k < a.length; k += 4) {
    if (Math.abs(a[k] - b[k]) + Math.abs(a[k + 1] - b[k + 1]) + Math.abs(a[k + 2] - b[k + 2]) + Math.abs(a[k + 3] - b[k + 3]) > 24) count += 1;
  }
  return count;
};

/** Every choice of every switch, one after another: the picture or the legend must not stay as it was. */
async function trySwitches(page) {
  await page.evaluate(() => document.querySelectorAll(".ss-controls").forEach((d) => (d.open = true)));
  const names = await page.$$eval(".ss-viewer:first-of-type .ss-field:not([hidden]) select", (all) => all.map((s) => s.name));
  for (const name of [...new Set(names)]) {
    const list = page.locator(`.ss-viewer select[name="${name}"]`).first();
    const choices = await list.locator("option").evaluateAll((all) => all.map((o) => o.value));
    const first = await list.inputValue();
    for (const choice of choices.filter((c) => c !== first)) {
      const before = [await seen(page), await page.locator(".ss-legend").first().innerText(), await page.locator(".ss-labels").first().innerText()];
      await list.selectOption(choice);
      await settled(page);
      const after = [await seen(page), await page.locator(".ss-legend").first().innerText(), await page.locator(".ss-labels").first().innerText()];
      const pixels = changed(before[0], after[0]);
      const said = before[1] !== after[1] || before[2] !== after[2];
      check(pixels > 2 || said, `${name}: ${JSON.stringify(choice)} shows (${pixels} of 38400 places${said ? ", and in words" : ""})`);
      // Each against what was there at first.
      await list.selectOption(first);
      await settled(page);
    }
  }
}

async function tryViews(page) {
  const tick = page.locator('.ss-viewer input[name="envelope"]').first();
  if (await tick.isVisible()) {
    const before = await seen(page);
    await tick.check();
    await settled(page);
    check(changed(before, await seen(page)) > 100, "the envelope shows");
    await tick.uncheck();
  }
  for (const name of ["top", "front", "side", "iso"]) {
    const before = await seen(page);
    await page.locator(`.ss-viewer button[name="view-${name}"]`).first().click();
    await page.waitForTimeout(600);
    check(changed(before, await seen(page)) > 400, `view ${name} shows`);
  }
}

async function tryHand(page) {
  const canvas = page.locator(".ss-stage canvas").first();
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const moves = {
    "a drag turns": async () => {
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 120, y + 30, { steps: 4 });
      await page.mouse.up();
    },
    "a drag with shift shifts": async () => {
      await page.keyboard.down("Shift");
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 90, y, { steps: 4 });
      await page.mouse.up();
      await page.keyboard.up("Shift");
    },
    "the wheel zooms": () => page.mouse.wheel(0, -240),
    "an arrow key turns": () => page.keyboard.press("ArrowLeft"),
    "the key Home goes back": () => page.keyboard.press("Home"),
  };
  for (const [what, move] of Object.entries(moves)) {
    const before = await seen(page);
    await move();
    await page.waitForTimeout(500);
    check(changed(before, await seen(page)) > 200, what);
  }
  const tip = page.locator(".ss-tip").first();
  let told = "";
  for (let k = 0; k < 400 && !told; k++) {
    await page.mouse.move(box.x + (0.15 + 0.7 * ((k % 20) / 20)) * box.width, box.y + (0.25 + 0.6 * (Math.floor(k / 20) / 20)) * box.height);
    if (await tip.isVisible()) told = await tip.innerText();
  }
  check(/node \(\d+, \d+\)/.test(told), `a node tells what it is: ${told.split("\n")[0]}`);
}

async function tryTime(page) {
  const play = page.locator('.ss-viewer button[name="play"]').first();
  if (!(await play.isVisible())) return;
  const slider = page.locator('.ss-viewer input[name="time"]').first();
  await slider.fill("0");
  await settled(page);
  const [home, start] = [await seen(page), Number(await slider.inputValue())];
  await play.click();
  // However slow the machine is: until the rest at home is over.
  for (let k = 0; k < 60 && Number(await slider.inputValue()) < 1.5; k++) await page.waitForTimeout(250);
  await play.click();
  await settled(page);
  const now = Number(await slider.inputValue());
  check(now > start, `the time runs: ${start} to ${now} s`);
  check(changed(home, await seen(page)) > 50, "the robot moves");
  const stops = await page.locator(".ss-ticks button").allInnerTexts();
  check(stops[0] === "home" && stops.length > 2, `stops of the movement: ${stops.join(", ")}`);
}

/** Nothing is drawn while nothing changes. */
async function tryRest(page) {
  const frames = await page.evaluate(async () => {
    let count = 0;
    const own = globalThis.requestAnimationFrame;
    globalThis.requestAnimationFrame = (f) => {
      count += 1;
      return own.call(globalThis, f);
    };
    await new Promise((done) => setTimeout(done, 700));
    globalThis.requestAnimationFrame = own;
    return count;
  });
  check(frames === 0, `at rest nothing is drawn (${frames} pictures)`);
}

async function tryLoss(page) {
  const before = await seen(page);
  const lost = await page.evaluate(async () => {
    const gl = document.querySelector(".ss-stage canvas").getContext("webgl2");
    const loss = gl.getExtension("WEBGL_lose_context");
    if (!loss) return false;
    loss.loseContext();
    await new Promise((done) => setTimeout(done, 200));
    loss.restoreContext();
    await new Promise((done) => setTimeout(done, 900));
    return true;
  });
  if (!lost) return;
  await settled(page);
  check(changed(before, await seen(page)) < 200, "after a loss of the graphics card the picture is as before");
}

/** Of a page that shows its viewer as `viewer`: what a page that drags equipment asks of it. */
async function tryDragging(page) {
  if (!(await page.evaluate(() => !!globalThis.viewer && !!document.getElementById("document")))) return;
  const told = await page.evaluate(() => {
    const read = () => JSON.parse(document.getElementById("document").textContent);
    const { equipment } = read().drawings[viewer.state().drawing];
    const index = equipment.findIndex((e) => !e.obstacle && e.at);
    const [x, y, z] = equipment[index].at.slice(9);
    const p = viewer.project(x, y, z);
    const back = viewer.pickFloor(p.x, p.y, z);
    const heard = [];
    viewer.on("state", (s) => heard.push(s));
    const was = viewer.camera();
    viewer.setCamera({ azimuth: was.azimuth + 0.3 });
    const now = viewer.camera();
    viewer.setCamera(was);
    viewer.show({ arrows: "none" }).show({ arrows: "resultant" });
    return { index, x, y, z, off: Math.hypot(back.x - x, back.y - y), hit: viewer.pickEquipment(p.x, p.y, true), turned: now.azimuth - was.azimuth, heard: heard.length };
  });
  check(told.off < 0.5, `a point of the picture is found again on the floor (${told.off.toExponential(1)} mm)`);
  check(told.hit && told.hit.equipment !== null, "equipment is found under the pointer");
  check(Math.abs(told.turned - 0.3) < 1e-9 && told.heard === 2, "camera and state are told");
  await settled(page);
  const before = await seen(page);
  await page.evaluate(({ index, x, y, z }) => viewer.movePart(index, { x_mm: x + 150, y_mm: y + 150, z_mm: z, yaw_deg: 20 }), told);
  await settled(page);
  const during = await seen(page);
  check(changed(before, during) > 100, "equipment moves while it is dragged");
  await page.evaluate(() => viewer.replace(JSON.parse(document.getElementById("document").textContent)));
  await settled(page);
  check(changed(before, await seen(page)) < 30, "a new document puts it where it is");
}

async function shoot(browser, url, folder) {
  mkdirSync(folder, { recursive: true });
  const name = basename(url).replace(/\.html?$/, "");
  for (const width of [400, 1600]) {
    for (const colorScheme of ["light", "dark"]) {
      const { page } = await open(browser, url, { viewport: { width, height: 1000 }, colorScheme });
      await page.waitForTimeout(500);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      check(wide <= 0, `no sideways scrolling at ${width} px`);
      await page.screenshot({ path: join(folder, `${name}-${width}-${colorScheme}.png`), fullPage: true });
      await page.close();
    }
  }
}

const given = process.argv.slice(2);
const at = given.indexOf("--shots");
const shots = at < 0 ? null : given.splice(at, 2)[1];
if (given.length !== 1) {
  console.error("usage: node tests/browser/viewer.mjs PAGE.html [--shots DIR]");
  process.exit(2);
}
const url = pathToFileURL(resolve(given[0])).href;
const { chromium } = playwright();

const browser = await chromium.launch({ executablePath: BROWSER, args: [...CALM, ...DRAWN_BY_SOFTWARE] });
const { page, said } = await open(browser, url);
const colours = new Set();
const first = await seen(page);
for (let k = 0; k < first.length; k += 4) colours.add(first.slice(k, k + 4).map((v) => v >> 4).join());
check(colours.size > 30, `the canvas is not blank (${colours.size} colours)`);
await tryRest(page);
await trySwitches(page);
await tryViews(page);
await tryHand(page);
await tryTime(page);
await tryDragging(page);
await tryLoss(page);
// A picture is read back only here: what the browser says of that is no fault of the page.
const wrong = said.filter((line) => !/GPU stall due to ReadPixels/.test(line));
check(wrong.length === 0, `nothing is said and nothing asked for ${wrong.slice(0, 5).join(" | ")}`);
if (shots) await shoot(browser, url, shots);
await browser.close();

const without = await chromium.launch({ executablePath: BROWSER, args: [...CALM, "--disable-gpu", "--disable-3d-apis"] });
const plain = await open(without, url);
check((await plain.page.locator(".ss-viewer").count()) === 0 && plain.said.length === 0, `without WebGL the page keeps its still picture ${plain.said.slice(0, 3).join(" | ")}`);
await without.close();

console.log(faults.length ? `${faults.length} of ${checked} checks fail` : `all ${checked} checks hold`);
process.exit(faults.length ? 1 : 0);
