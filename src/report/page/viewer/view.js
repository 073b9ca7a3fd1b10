// The view: the state from which all functions of the viewer draw.

/**
 * Returns the view of a document before its first picture.
 * @param {DrawingDocument} written
 * @param {Graphics} graphics
 * @returns {View}
 */
function initialView(written, graphics) {
  const model = readModel(written, new Map());
  const size = { width: 1, height: 1 };
  const camera = fittedCamera({ model, ...size }, "iso");
  return {
    model,
    drawing: model.drawings[0],
    state: {
      drawing: 0,
      operation: null,
      lens: 0,
      sense: null,
      arrows: "resultant",
      envelope: false,
      solids: "solid",
      robot: "solid",
      time: 0,
      compareTo: null,
    },
    lens: 0,
    scale: { ranges: {}, comparison: null },
    magnification: 1,
    spacing: 100,
    floorBounds: [0, 0, 1, 1],
    theme: "light",
    shifts: new Map(),
    frames: [],
    camera,
    optics: opticsOf({ camera, model, ...size }),
    ...size,
    ratio: 1,
    playing: false,
    picked: null,
    graphics,
    shadowKey: "",
    shadowCamera: IDENTITY,
  };
}
