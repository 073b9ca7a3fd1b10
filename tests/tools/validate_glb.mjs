// Validates GLB files with Khronos' gltf-validator: NODE_PATH=.../node_modules node tests/tools/validate_glb.mjs FILE...
// Prints what it says; fails on any error or warning.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";

const folder = process.env.NODE_PATH ?? "node_modules";
const validator = createRequire(resolve(folder, "here.js"))("gltf-validator");

let clean = true;
for (const file of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 20 });
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  const { animationCount, materialCount, drawCallCount, totalVertexCount, totalTriangleCount } = report.info;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ${numHints} hints;`,
    `${animationCount} animations, ${materialCount} materials, ${drawCallCount} draw calls,`,
    `${totalVertexCount} vertices, ${totalTriangleCount} triangles`);
  messages.forEach((m) => console.log(`  ${m.code} ${m.pointer}: ${m.message}`));
  clean &&= numErrors === 0 && numWarnings === 0;
}
process.exit(clean ? 0 : 1);
