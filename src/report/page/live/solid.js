// The 3-D view beside the plan, once the viewer is there.
async function beginSolid() {
  if (typeof sweetspotViewer !== "function") return;
}
