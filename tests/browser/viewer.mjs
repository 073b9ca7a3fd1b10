// Tests the 3-D view of a report in Chromium. Every switch, view, key and drag must change the picture, and
// the page must report no error. See README.md.

import { mkdirSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { check, checkFaults, checkSoon, launch, open, run, soon, usage } from "./harness.mjs";

/** Size of the picture that is compared, pixels. */
const [WIDTH, HEIGHT] = [240, 160];

/** @typedef {import("playwright-core").Page} Page */

/**
 * Returns the canvas in the page, reduced to a coarse grid of pixels.
 * @param {Page} page
 */
const picture = (page) =>
  page.evaluate(
    ([width, height]) => {
      const canvas = document.querySelector(".ss-stage canvas");
      const small = new OffscreenCanvas(width, height);
      const pen = small.getContext("2d");
      if (!(canvas instanceof HTMLCanvasElement) || !pen) throw new Error("no canvas");
      pen.drawImage(canvas, 0, 0, width, height);
      return [...pen.getImageData(0, 0, width, height).data];
    },
    [WIDTH, HEIGHT],
  );

/**
 * Returns the number of pixels that differ.
 * @param {number[]} a
 * @param {number[]} b
 */
function changed(a, b) {
  let count = 0;
  for (let k = 0; k < a.length; k += 4) {
    const difference = [0, 1, 2, 3].reduce((sum, c) => sum + Math.abs(a[k + c] - b[k + c]), 0);
    if (difference > 24) count += 1;
  }
  return count;
}

/**
 * Returns the number of frames that the page requests within a time.
 * @param {Page} page
 * @param {number} time ms
 */
const frames = (page, time) =>
  page.evaluate(async (duration) => {
    let count = 0;
    const original = globalThis.requestAnimationFrame;
    globalThis.requestAnimationFrame = (callback) => {
      count += 1;
      return original.call(globalThis, callback);
    };
    await new Promise((done) => setTimeout(done, duration));
    globalThis.requestAnimationFrame = original;
    return count;
  }, time);

/**
 * Waits until two successive pictures are equal, and returns the last picture.
 * @param {Page} page
 */
async function still(page) {
  let before = await picture(page);
  await soon(async () => {
    const waiting = await frames(page, 120);
    const now = await picture(page);
    const isSame = waiting === 0 && changed(before, now) === 0;
    before = now;
    return isSame;
  });
  return before;
}

/**
 * Checks that an action changes the picture.
 * @param {Page} page
 * @param {string} what
 * @param {number} pixels
 * @param {() => Promise<unknown>} action
 */
async function checkShows(page, what, pixels, action) {
  const before = await still(page);
  await action();
  await checkSoon(async () => changed(before, await picture(page)) > pixels, what);
}

/**
 * Returns the texts of the legend and the labels.
 * @param {Page} page
 */
const texts = async (page) => {
  const all = [".ss-legend", ".ss-labels"].map((selector) => page.locator(selector).first().innerText());
  return (await Promise.all(all)).join("\n");
};

/** @param {Page} page */
async function testPicture(page) {
  const pixels = await still(page);
  const colours = new Set();
  for (let k = 0; k < pixels.length; k += 4) {
    colours.add(
      pixels
        .slice(k, k + 4)
        .map((value) => value >> 4)
        .join(),
    );
  }
  check(colours.size > 30, `the canvas is not blank (${colours.size} colours)`);
  await checkSoon(async () => (await frames(page, 600)) === 0, "nothing is drawn at rest");
}

/**
 * Compares every choice of every switch with the first choice: picture, legend or labels must differ.
 * @param {Page} page
 */
async function testSwitches(page) {
  await page.evaluate(() => {
    for (const details of document.querySelectorAll("details.ss-controls")) details.setAttribute("open", "");
  });
  const fields = page.locator(".ss-viewer").first().locator(".ss-field:not([hidden]) select");
  for (const list of await fields.all()) {
    const name = await list.getAttribute("name");
    const values = await list
      .locator("option")
      .evaluateAll((all) => all.map((one) => one.getAttribute("value") ?? ""));
    const first = await list.inputValue();
    const before = await still(page);
    const textBefore = await texts(page);
    for (const value of values.filter((one) => one !== first)) {
      await list.selectOption(value);
      const shows = async () =>
        changed(before, await picture(page)) > 2 || (await texts(page)) !== textBefore;
      await checkSoon(shows, `switch ${name}: ${JSON.stringify(value)} shows`);
    }
    await list.selectOption(first);
    const isBack = async () =>
      changed(before, await picture(page)) <= 2 && (await texts(page)) === textBefore;
    await checkSoon(isBack, `switch ${name}: ${JSON.stringify(first)} shows the same as before`);
  }
}

/** @param {Page} page */
async function testViews(page) {
  const envelope = page.locator('.ss-viewer input[name="envelope"]').first();
  if (await envelope.isVisible()) {
    await checkShows(page, "the working envelope shows", 100, () => envelope.check());
    await envelope.uncheck();
  }
  for (const name of ["top", "front", "side", "iso"]) {
    const button = page.locator(`.ss-viewer button[name="view-${name}"]`).first();
    await checkShows(page, `view ${name} shows`, 400, () => button.click());
  }
}

/** @param {Page} page */
async function testPointer(page) {
  const canvas = page.locator(".ss-stage canvas").first();
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  if (!box) throw new Error("the canvas is not visible");
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const drag = async (/** @type {number} */ dx, /** @type {number} */ dy) => {
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + dx, y + dy, { steps: 4 });
    await page.mouse.up();
  };
  await checkShows(page, "a drag turns", 200, () => drag(120, 30));
  await checkShows(page, "a drag with the shift key shifts", 200, async () => {
    await page.keyboard.down("Shift");
    await drag(90, 0);
    await page.keyboard.up("Shift");
  });
  await checkShows(page, "the wheel zooms", 200, () => page.mouse.wheel(0, -240));
  await checkShows(page, "an arrow key turns", 200, () => page.keyboard.press("ArrowLeft"));
  await checkShows(page, "the key Home goes back", 200, () => page.keyboard.press("Home"));
  await still(page);
  const tip = page.locator(".ss-tip").first();
  let text = "";
  for (let k = 0; k < 400 && !text; k++) {
    const [across, down] = [0.15 + 0.7 * ((k % 20) / 20), 0.25 + 0.6 * (Math.floor(k / 20) / 20)];
    await page.mouse.move(box.x + across * box.width, box.y + down * box.height);
    if (await tip.isVisible()) text = await tip.innerText();
  }
  check(/node \(\d+, \d+\)/.test(text), `the tip describes a node: ${text.split("\n")[0]}`);
}

/** @param {Page} page */
async function testMovement(page) {
  const play = page.locator('.ss-viewer button[name="play"]').first();
  if (!(await play.isVisible())) return;
  const slider = page.locator('.ss-viewer input[name="time"]').first();
  await slider.fill("0");
  const home = await still(page);
  await play.click();
  // The test waits until the stop at home is over.
  const time = async () => Number(await slider.inputValue());
  await checkSoon(async () => (await time()) > 1.5, "the time runs");
  await play.click();
  check(changed(home, await still(page)) > 50, "the robot moves");
  const stops = await page.locator(".ss-ticks button").allInnerTexts();
  check(stops[0] === "home" && stops.length > 2, `the movement has stops: ${stops.join(", ")}`);
}

/**
 * Tests the functions that a page needs to drag equipment, on a separate viewer.
 * @param {Page} page
 */
async function testDragging(page) {
  await page.evaluate(() => {
    const host = document.createElement("div");
    // The checks read the first viewer of the page.
    document.body.prepend(host);
    const written = JSON.parse(document.getElementById("drawings")?.textContent ?? "");
    Object.assign(globalThis, { written, viewer: sweetspotViewer(host, written, { controls: false }) });
    scrollTo(0, 0);
  });
  await still(page);
  const told = await page.evaluate(() => {
    const { written, viewer } = /** @type {any} */ (globalThis);
    const { equipment } = written.drawings[viewer.state().drawing];
    const index = equipment.findIndex((/** @type {any} */ one) => !one.obstacle && one.at);
    const [x, y, z] = equipment[index].at.slice(9);
    const point = viewer.project(x, y, z);
    const back = viewer.pickFloor(point.x, point.y, z);
    const events = [];
    viewer.on("state", (/** @type {unknown} */ state) => events.push(state));
    const before = viewer.camera();
    viewer.setCamera({ azimuth: before.azimuth + 0.3 });
    const turned = viewer.camera().azimuth - before.azimuth;
    viewer.setCamera(before);
    viewer.show({ arrows: "none" }).show({ arrows: "resultant" });
    const hit = viewer.pickEquipment(point.x, point.y, true);
    return { index, x, y, z, error: Math.hypot(back.x - x, back.y - y), hit, turned, events: events.length };
  });
  check(told.error < 0.5, `a point of the picture is found on the floor (${told.error.toExponential(1)} mm)`);
  check(told.hit !== null && told.hit.equipment !== null, "equipment is found under the pointer");
  check(Math.abs(told.turned - 0.3) < 1e-9 && told.events === 2, "camera and state are told");
  const before = await still(page);
  const move = () =>
    page.evaluate(({ index, x, y, z }) => {
      const placement = { x_mm: x + 150, y_mm: y + 150, z_mm: z, yaw_deg: 20 };
      /** @type {any} */ (globalThis).viewer.movePart(index, placement);
    }, told);
  await checkShows(page, "equipment moves while it is dragged", 100, move);
  await page.evaluate(() => {
    const { viewer, written } = /** @type {any} */ (globalThis);
    viewer.replace(written);
  });
  await checkSoon(
    async () => changed(before, await still(page)) < 30,
    "a new document puts equipment where it stands",
  );
}

/** @param {Page} page */
async function testContextLoss(page) {
  const before = await still(page);
  const isLost = await page.evaluate(async () => {
    const canvas = /** @type {HTMLCanvasElement | null} */ (document.querySelector(".ss-stage canvas"));
    const extension = canvas?.getContext("webgl2")?.getExtension("WEBGL_lose_context");
    if (!canvas || !extension) return false;
    const event = (/** @type {string} */ name) =>
      new Promise((done) => canvas.addEventListener(name, done, { once: true }));
    const lost = event("webglcontextlost");
    extension.loseContext();
    await lost;
    // A context can be restored only after its loss was handled.
    await new Promise((done) => setTimeout(done, 100));
    const restored = event("webglcontextrestored");
    extension.restoreContext();
    await restored;
    return true;
  });
  check(isLost, "the WebGL context can be lost and restored");
  await checkSoon(
    async () => changed(before, await still(page)) < 200,
    "the picture is as before after a loss of the WebGL context",
  );
}

/**
 * Takes pictures of the page in two widths and two colour schemes.
 * @param {import("playwright-core").Browser} browser
 * @param {string} url
 * @param {string} folder
 */
async function takeShots(browser, url, folder) {
  mkdirSync(folder, { recursive: true });
  const name = basename(url).replace(/\.html?$/, "");
  for (const width of [400, 1600]) {
    for (const colorScheme of /** @type {const} */ (["light", "dark"])) {
      const { page } = await open(browser, url, {
        context: { viewport: { width, height: 1000 }, colorScheme },
      });
      await still(page);
      await page.screenshot({ path: join(folder, `${name}-${width}-${colorScheme}.png`), fullPage: true });
      await page.close();
    }
  }
}

/**
 * Checks that no line of a page is wider than a small screen.
 * @param {import("playwright-core").Browser} browser
 * @param {string} url
 */
async function testNarrow(browser, url) {
  const { page } = await open(browser, url, { context: { viewport: { width: 400, height: 800 } } });
  const excess = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  check(excess <= 0, "the page does not scroll sideways at 400 px");
  await page.close();
}

/** @param {string} url */
async function testWithoutWebgl(url) {
  const { page, faults } = await open(await launch({ webgl: false }), url);
  check((await page.locator(".ss-viewer").count()) === 0, "without WebGL there is no viewer");
  check(await page.locator("#viewer figure").first().isVisible(), "without WebGL the picture stays");
  checkFaults(faults, "without WebGL");
}

const given = process.argv.slice(2);
const option = given.indexOf("--shots");
const shots = option < 0 ? null : given.splice(option, 2)[1];
if (given.length !== 1) usage("node tests/browser/viewer.mjs REPORT.html [--shots DIR]");
const url = pathToFileURL(resolve(given[0])).href;
const browser = await launch();
const { page, faults } = await open(browser, url);
await run("viewer", {
  picture: () => testPicture(page),
  switches: () => testSwitches(page),
  views: () => testViews(page),
  pointer: () => testPointer(page),
  movement: () => testMovement(page),
  "loss of the context": () => testContextLoss(page),
  dragging: () => testDragging(page),
  faults: async () => checkFaults(faults, "report"),
  narrow: () => testNarrow(browser, url),
  "without WebGL": () => testWithoutWebgl(url),
  ...(shots ? { shots: () => takeShots(browser, url, shots) } : {}),
});
