// Looks: colours of the picture, and visibility of parts.

/** Colours of the picture, and strengths of shadow, edges and grid. */
const LOOKS = {
  light: {
    robot: "#ea7317",
    foot: "#4a525c",
    tool: "#353b43",
    held: "#3f8fd2",
    equipment: "#c3cbd4",
    obstacle: "#8d959f",
    fence: "#d9a400",
    "keep-out": "#cf222e",
    edge: "#1b232d",
    ground: "#f4f6f8",
    grid: "#7d8894",
    paper: "#ffffff",
    envelope: "#0969a8",
    net: "#33404d",
    ghost: "#7c3aed",
    shadow: 0.34,
    edgeAlpha: 0.75,
    gridAlpha: 0.42,
  },
  dark: {
    robot: "#f08a35",
    foot: "#6a737e",
    tool: "#3d444d",
    held: "#58a6ff",
    equipment: "#87919d",
    obstacle: "#5d6671",
    fence: "#e3b341",
    "keep-out": "#ff6b61",
    edge: "#05080c",
    ground: "#1b222b",
    grid: "#8b97a5",
    paper: "#12171d",
    envelope: "#58b0f0",
    net: "#c2ccd6",
    ghost: "#b794f6",
    shadow: 0.45,
    edgeAlpha: 0.85,
    gridAlpha: 0.3,
  },
};

/**
 * Returns the colours of the theme.
 * @param {View} view
 */
const looksOf = (view) => LOOKS[view.theme];

const ROBOT_KINDS = ["robot", "tool", "held"];
const SPACE_KINDS = ["fence", "keep-out"];

/**
 * Returns how a part is drawn.
 * @param {View} view
 * @param {Part} part
 * @returns {Visibility | "space"}
 */
function visibilityOf({ state }, part) {
  if (SPACE_KINDS.includes(part.kind)) return "space";
  return ROBOT_KINDS.includes(part.kind) ? state.robot : state.solids;
}

/**
 * Returns the colour of a part.
 * @param {View} view
 * @param {Part} part
 */
function partColour(view, part) {
  const looks = looksOf(view);
  const isFoot = part.kind === "robot" && part.link === 0;
  return colourOf(isFoot ? looks.foot : looks[part.kind] || looks.equipment);
}
