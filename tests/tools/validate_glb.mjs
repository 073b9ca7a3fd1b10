// Validates GLB files with Khronos' gltf-validator; fails on any error or warning.
// Usage, after `npm ci` in tests/browser: node tests/tools/validate_glb.mjs FILE...

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const validator = createRequire(new URL("../browser/", import.meta.url))("gltf-validator");

let isValid = true;
for (const file of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 20 });
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  const { animationCount, materialCount, drawCallCount, totalVertexCount, totalTriangleCount } = report.info;
  console.log(
    `${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ${numHints} hints;`,
    `${animationCount} animations, ${materialCount} materials, ${drawCallCount} draw calls,`,
    `${totalVertexCount} vertices, ${totalTriangleCount} triangles`,
  );
  for (const { code, pointer, message } of messages) console.log(`  ${code} ${pointer}: ${message}`);
  if (numErrors > 0 || numWarnings > 0) isValid = false;
}
process.exit(isValid ? 0 : 1);
