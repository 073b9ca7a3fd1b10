// Picking: nodes and equipment under a point of the picture.

/**
 * Returns the line of sight through a place in the picture.
 * @param {View} view
 * @param {number} x px
 * @param {number} y px
 */
function lineOfSight(view, x, y) {
  const { right, up, back, eye, pixelsPerMm } = view.optics;
  const [toRight, upwards] = [(x - view.width / 2) / pixelsPerMm, (view.height / 2 - y) / pixelsPerMm];
  const across = add(scaled(right, toRight), scaled(up, upwards));
  if (view.camera.parallel) return { from: add(eye, across), along: scaled(back, -1) };
  return { from: eye, along: normalized(subtract(across, scaled(back, view.camera.distance))) };
}

/**
 * Returns the point of a horizontal plane under a place in the picture.
 * @param {View} view
 * @param {number} x px
 * @param {number} y px
 * @param {number} height mm
 * @returns {FloorPoint | null}
 */
function floorUnder(view, x, y, height) {
  const { from, along } = lineOfSight(view, x, y);
  const distance = (height - from[2]) / along[2];
  if (!(distance > 0) || !Number.isFinite(distance)) return null;
  return { x: from[0] + distance * along[0], y: from[1] + distance * along[1], z: height };
}

/**
 * Returns the equipment under a place in the picture, by the bounding boxes of its parts.
 * @param {View} view
 * @param {number} x px
 * @param {number} y px
 * @param {boolean} obstacles whether obstacles are found as well
 */
function equipmentUnder(view, x, y, obstacles) {
  const { from, along } = lineOfSight(view, x, y);
  let nearest = Infinity;
  /** @type {number | null} */
  let equipment = null;
  for (const part of view.drawing.parts) {
    if (part.equipment === null || (part.kind !== "equipment" && !obstacles)) continue;
    const back = inverse(poseOf(view, part));
    const distance = boxHit(part.mesh, moved(back, from), rotated(back, along));
    if (distance !== null && distance < nearest) [nearest, equipment] = [distance, part.equipment];
  }
  return equipment === null ? null : { equipment, at: add(from, scaled(along, nearest)) };
}

/**
 * Returns the distance along a line to a box; null if the line misses the box.
 * @param {Extent} box
 * @param {Vector} from
 * @param {Vector} along
 */
function boxHit({ low, high }, from, along) {
  let [enter, leave] = [-Infinity, Infinity];
  for (let k = 0; k < 3; k++) {
    const [a, b] = [(low[k] - from[k]) / along[k], (high[k] - from[k]) / along[k]];
    if (Number.isNaN(a) || Number.isNaN(b)) continue;
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter <= leave && leave > 0 ? Math.max(enter, 0) : null;
}

/**
 * Returns the node nearest to a place in the picture.
 * @param {View} view
 * @param {number[]} place px
 * @param {number} radius px; farther nodes are not found
 * @returns {NodeReference | null}
 */
function nodeNear(view, place, radius) {
  let nearest = radius;
  /** @type {NodeReference | null} */
  let found = null;
  for (const field of shownFields(view)) {
    for (let index = 0; index < field.count; index++) {
      const point = seenAt(view, displaced(view, field, nodeAt(field, index)));
      const distance = Math.hypot(point.x - place[0], point.y - place[1]);
      if (point.visible && distance < nearest) [nearest, found] = [distance, { field, index }];
    }
  }
  return found;
}
