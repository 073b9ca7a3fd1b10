// Where the eye is: a camera looks at a target from a distance, an azimuth and an elevation (rad).

const FOV = 0.46;
const PRESETS = {
  iso: { azimuth: -0.72, elevation: 0.5, parallel: false },
  top: { azimuth: -Math.PI / 2, elevation: Math.PI / 2, parallel: true },
  front: { azimuth: -Math.PI / 2, elevation: 0, parallel: true },
  side: { azimuth: 0, elevation: 0, parallel: true },
};

function axesOf({ azimuth, elevation }) {
  const [c, s, ce, se] = [Math.cos(azimuth), Math.sin(azimuth), Math.cos(elevation), Math.sin(elevation)];
  const back = [ce * c, ce * s, se];
  const right = [-s, c, 0];
  return { right, up: cross(back, right), back };
}

/** From the side on which most of the work is, turned a little: robot behind its work. */
function bestSide({ drawings }) {
  let sum = [0, 0];
  for (const d of drawings) {
    for (const f of d.fields) {
      const p = minus(f.spot_mm || nodeAt(f, Math.floor(f.count / 2)), [d.base[12], d.base[13], 0]);
      const far = Math.hypot(p[0], p[1]) || 1;
      sum = [sum[0] + p[0] / far, sum[1] + p[1] / far];
    }
  }
  return Math.hypot(...sum) > 0.2 ? Math.atan2(sum[1], sum[0]) - 0.4 : PRESETS.iso.azimuth;
}

/** A camera that sees all of the points, in the middle of the picture. */
function fitted(view, preset) {
  const { model, width, height } = view;
  const camera = { target: times(add(model.low, model.high), 0.5), distance: size(minus(model.high, model.low)) * 2, ...PRESETS[preset] };
  if (preset === "iso") camera.azimuth = bestSide(model);
  const { right, up, back } = axesOf(camera);
  const h = Math.tan(FOV / 2) * (height > 420 ? 0.9 : 0.86);
  const w = Math.tan(FOV / 2) * (width / height) * 0.88;
  for (let round = 0; round < 8; round++) {
    const [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
    for (const point of model.points) {
      const p = minus(point, camera.target);
      const deep = Math.max(camera.distance - (camera.parallel ? 0 : dot(p, back)), camera.distance * 0.05);
      [dot(p, right) / deep, dot(p, up) / deep].forEach((v, k) => {
        low[k] = Math.min(low[k], v);
        high[k] = Math.max(high[k], v);
      });
    }
    const middle = [0, 1].map((k) => ((low[k] + high[k]) / 2) * camera.distance);
    camera.target = add(camera.target, add(times(right, middle[0]), times(up, middle[1])));
    camera.distance *= Math.max((high[0] - low[0]) / 2 / w, (high[1] - low[1]) / 2 / h);
  }
  return camera;
}

function opticsOf({ camera, model, width, height }) {
  const { right, up, back } = axesOf(camera);
  const eye = add(camera.target, times(back, camera.distance));
  const radius = size(minus(model.high, model.low)) * 1.3 + 2000;
  const tall = 2 * camera.distance * Math.tan(FOV / 2);
  const reach = size(minus(camera.target, times(add(model.low, model.high), 0.5))) + radius;
  const near = camera.parallel ? camera.distance - 2 * reach : Math.max(camera.distance - reach, camera.distance * 0.02, 10);
  const far = camera.distance + 2 * reach;
  const flat = camera.parallel ? parallel((tall * width) / height, tall, near, far) : perspective(FOV, width / height, near, far);
  const perMm = camera.parallel ? height / tall : height / 2 / Math.tan(FOV / 2);
  return { eye, right, up, back, camera: product(flat, lookFrom(eye, right, up, back)), perMm,
    pxPerMm: height / tall, towards: camera.parallel ? back : eye };
}

/** Where a point of the world is in the picture, px from its upper left. */
function seenAt(view, p) {
  const q = projected(view.optics.camera, p);
  return { x: (q[0] / q[3] + 1) * 0.5 * view.width, y: (1 - q[1] / q[3]) * 0.5 * view.height, visible: q[3] > 0 };
}

/** Start and direction of the line of sight through a place in the picture. */
function sight(view, px, py) {
  const { right, up, back, eye, pxPerMm } = view.optics;
  const across = add(times(right, (px - view.width / 2) / pxPerMm), times(up, (view.height / 2 - py) / pxPerMm));
  if (view.camera.parallel) return { from: add(eye, across), along: times(back, -1) };
  return { from: eye, along: unit(minus(across, times(back, view.camera.distance))) };
}

function floorUnder(view, px, py, z) {
  const { from, along } = sight(view, px, py);
  const far = (z - from[2]) / along[2];
  return far > 0 && isFinite(far) ? { x: from[0] + far * along[0], y: from[1] + far * along[1], z } : null;
}

/** The equipment (an obstacle only if asked) under a place in the picture, by the boxes round its parts. */
function equipmentUnder(view, px, py, obstacles) {
  const { from, along } = sight(view, px, py);
  let best = null;
  for (const part of view.drawing.parts) {
    if (part.equipment === null || (part.kind !== "equipment" && !obstacles)) continue;
    const back = inverse(view.poseOf(part));
    const far = boxHit(part.mesh, moved(back, from), turned(back, along));
    if (far !== null && (!best || far < best.far)) best = { equipment: part.equipment, far };
  }
  return best && { equipment: best.equipment, at: add(from, times(along, best.far)) };
}

/** How far along a line a box is met; null: not. */
function boxHit({ low, high }, from, along) {
  let [enter, leave] = [-Infinity, Infinity];
  for (let k = 0; k < 3; k++) {
    const [a, b] = [(low[k] - from[k]) / along[k], (high[k] - from[k]) / along[k]];
    if (isNaN(a) || isNaN(b)) continue;
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter <= leave && leave > 0 ? Math.max(enter, 0) : null;
}
