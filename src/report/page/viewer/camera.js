// The camera: it looks at a target from a distance, an azimuth and an elevation (rad).

/** Vertical field of view, rad. */
const FIELD_OF_VIEW = 0.46;

/** @type {Record<ViewName, { azimuth: number, elevation: number, parallel: boolean }>} */
const PRESETS = {
  iso: { azimuth: -0.72, elevation: 0.5, parallel: false },
  top: { azimuth: -Math.PI / 2, elevation: Math.PI / 2, parallel: true },
  front: { azimuth: -Math.PI / 2, elevation: 0, parallel: true },
  side: { azimuth: 0, elevation: 0, parallel: true },
};

/**
 * Returns the axes of a camera in the world.
 * @param {Pick<Camera, "azimuth" | "elevation">} camera
 */
function axesOf({ azimuth, elevation }) {
  const [cosine, sine] = [Math.cos(azimuth), Math.sin(azimuth)];
  const back = [Math.cos(elevation) * cosine, Math.cos(elevation) * sine, Math.sin(elevation)];
  const right = [-sine, cosine, 0];
  return { right, up: cross(back, right), back };
}

/**
 * Returns the azimuth of a view in which the robot is behind its work, rotated a little.
 * @param {Model} model
 */
function bestAzimuth({ drawings }) {
  let sum = [0, 0];
  for (const { base, fields } of drawings) {
    for (const field of fields) {
      const work = field.spot_mm || nodeAt(field, Math.floor(field.count / 2));
      const [x, y] = [work[0] - base[12], work[1] - base[13]];
      const distance = Math.hypot(x, y) || 1;
      sum = [sum[0] + x / distance, sum[1] + y / distance];
    }
  }
  return Math.hypot(...sum) > 0.2 ? Math.atan2(sum[1], sum[0]) - 0.4 : PRESETS.iso.azimuth;
}

/**
 * Returns a camera that sees the whole cell in the middle of the picture.
 * @param {{ model: Model, width: number, height: number }} view
 * @param {ViewName} preset
 * @returns {Camera}
 */
function fittedCamera({ model, width, height }, preset) {
  const middle = scaled(add(model.low, model.high), 0.5);
  const camera = { target: middle, distance: norm(subtract(model.high, model.low)) * 2, ...PRESETS[preset] };
  if (preset === "iso") camera.azimuth = bestAzimuth(model);
  const { right, up } = axesOf(camera);
  const halfHeight = Math.tan(FIELD_OF_VIEW / 2) * (height > 420 ? 0.9 : 0.86);
  const halfWidth = Math.tan(FIELD_OF_VIEW / 2) * (width / height) * 0.88;
  for (let round = 0; round < 8; round++) {
    const { low, high } = slopesOf(model.points, camera);
    const [across, upwards] = [0, 1].map((k) => ((low[k] + high[k]) / 2) * camera.distance);
    camera.target = add(camera.target, add(scaled(right, across), scaled(up, upwards)));
    camera.distance *= Math.max((high[0] - low[0]) / 2 / halfWidth, (high[1] - low[1]) / 2 / halfHeight);
  }
  return camera;
}

/**
 * Returns the range of the slopes under which a camera sees points, to the right and upwards.
 * @param {Vector[]} points
 * @param {Camera} camera
 */
function slopesOf(points, camera) {
  const { right, up, back } = axesOf(camera);
  const [low, high] = [
    [Infinity, Infinity],
    [-Infinity, -Infinity],
  ];
  for (const point of points) {
    const offset = subtract(point, camera.target);
    const towards = camera.parallel ? 0 : dot(offset, back);
    const depth = Math.max(camera.distance - towards, camera.distance * 0.05);
    [dot(offset, right) / depth, dot(offset, up) / depth].forEach((slope, k) => {
      low[k] = Math.min(low[k], slope);
      high[k] = Math.max(high[k], slope);
    });
  }
  return { low, high };
}

/**
 * Derives projection and scale from a camera.
 * @param {{ camera: Camera, model: Model, width: number, height: number }} view
 * @returns {Optics}
 */
function opticsOf({ camera, model, width, height }) {
  const { right, up, back } = axesOf(camera);
  const { target, distance, parallel } = camera;
  const eye = add(target, scaled(back, distance));
  const radius = norm(subtract(model.high, model.low)) * 1.3 + 2000;
  const reach = norm(subtract(target, scaled(add(model.low, model.high), 0.5))) + radius;
  const far = distance + 2 * reach;
  // Height of the picture at the distance of the target, mm.
  const tall = 2 * distance * Math.tan(FIELD_OF_VIEW / 2);
  const projection = parallel
    ? orthographic((tall * width) / height, tall, distance - 2 * reach, far)
    : perspective(FIELD_OF_VIEW, width / height, Math.max(distance - reach, distance * 0.02, 10), far);
  return {
    eye,
    right,
    up,
    back,
    camera: product(projection, viewMatrix(eye, right, up, back)),
    pixelsPerMm: height / tall,
    scalePerMm: parallel ? height / tall : height / 2 / Math.tan(FIELD_OF_VIEW / 2),
    viewpoint: parallel ? back : eye,
  };
}

/**
 * Returns the position of a point of the world in the picture, px from the upper left corner.
 * @param {View} view
 * @param {Vector} point
 * @returns {ScreenPoint}
 */
function seenAt(view, point) {
  const [x, y, , w] = projected(view.optics.camera, point);
  return { x: (x / w + 1) * 0.5 * view.width, y: (1 - y / w) * 0.5 * view.height, visible: w > 0 };
}
