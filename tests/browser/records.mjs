// Checks the records that Rust hands to the scripts against their types (records.d.ts): tsc compares real
// documents with the types. A field that is renamed on only one side is thus detected.

import { spawn, spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { check, PATIENCE, run, usage } from "./harness.mjs";

const ROOT = join(dirname(fileURLToPath(import.meta.url)), "../..");
const [program, report] = process.argv.slice(2).map((path) => resolve(path));
if (!report) usage("node tests/browser/records.mjs PROGRAM REPORT.html");

const folder = mkdtempSync(join(tmpdir(), "sweetspot-records-"));

/**
 * Records by the name of their type.
 * @type {[type: string, record: unknown][]}
 */
const records = [];

async function readReport() {
  const page = readFileSync(report, "utf8");
  const drawings = /id="drawings">(.*?)<\/script>/s.exec(page);
  records.push(["DrawingDocument", JSON.parse(drawings?.[1] ?? "null")]);
  const signs = /^const NODE_SIGN_TABLE = (.*);$/m.exec(page);
  records.push(["typeof NODE_SIGN_TABLE", JSON.parse(signs?.[1] ?? "null")]);
}

/** Sends the server of `sweetspot view` all requests that its page sends. */
async function readAnswers() {
  const server = spawn(program, ["view", join(ROOT, "cells/hitachi_cell.toml")], { cwd: folder });
  try {
    const url = await new Promise((done, fail) => {
      server.once("exit", (code) => fail(new Error(`sweetspot view ended with ${code}`)));
      server.stdout.once("data", (data) => done(String(data).trim()));
    });
    const ask = async (/** @type {string} */ name, /** @type {object | undefined} */ body = undefined) => {
      const headers = { "Content-Type": "application/json", Origin: new URL(url).origin };
      const options = body && { method: "POST", body: JSON.stringify(body), headers };
      const response = await fetch(url + name, options);
      check(response.ok, `the server answers to ${name}`);
      records.push([`Answers["${name}"]`, await response.json()]);
    };
    for (const name of ["state", "now", "reach", "room", "drawing", "pulse"]) await ask(name);
    for (const refined of [false, true]) await ask("standing", { equipment: 0, refined });
    const numbers = { equipment: { worktable: { x_mm: 290 } } };
    await ask("layout", numbers);
    for (const name of ["try", "try-drawing"]) await ask(name, numbers);
    await ask("question", { sense: "z", reading: "worst-case", model: "linear" });
    await ask("search", { budget: 50, seed: 1 });
    for (const name of ["stop", "undo", "redo", "reset"]) await ask(name, {});
    await ask("pulse");
  } finally {
    server.kill("SIGINT");
  }
}

async function compareTypes() {
  const files = records.map(([type, record], k) => {
    const name = `record_${k}.ts`;
    const text = `const record: ${type} = ${JSON.stringify(record, shortened)};\nexport default record;\n`;
    writeFileSync(join(folder, name), text);
    return name;
  });
  const types = ["viewer", "live"].map((page) => join(ROOT, "src/report/page", page, "records.d.ts"));
  const compilerOptions = { strict: true, noEmit: true, lib: ["es2023", "dom"], types: [] };
  mkdirSync(join(folder, "project"));
  const project = { compilerOptions, files: [...types, ...files.map((name) => `../${name}`)] };
  writeFileSync(join(folder, "project/tsconfig.json"), JSON.stringify(project));
  const compiler = join(ROOT, "tests/browser/node_modules/.bin/tsc");
  const args = ["--project", join(folder, "project"), "--pretty", "false"];
  const { stdout, stderr } = spawnSync(compiler, args, { encoding: "utf8", timeout: PATIENCE });
  records.forEach(([type], k) => {
    const faults = `${stdout}${stderr}`.split("\n").filter((line) => line.includes(`record_${k}.ts`));
    const list = faults.map((line) => line.slice(0, 300)).join("; ");
    check(faults.length === 0, `a record is a ${type}${list && `: ${list}`}`);
  });
}

/**
 * Shortens long lists and encoded arrays, because their first items show their type.
 * @param {string} _key
 * @param {unknown} value
 */
function shortened(_key, value) {
  if (typeof value === "string") return value.slice(0, 40);
  return Array.isArray(value) && value.length > 60 ? value.slice(0, 60) : value;
}

const parts = { report: readReport, "live page": readAnswers, types: compareTypes };
await run("records", parts, () => rmSync(folder, { recursive: true, force: true }));
