// The time line of the robot's movement: a button, a slider and the stops.

/**
 * Makes the time line.
 * @param {View} view
 * @param {(on: boolean) => void} play
 * @param {(wanted: Partial<ViewerState>) => void} show
 */
function makeTimeline(view, play, show) {
  const button = makeButton("Play", () => play(!view.playing), { class: "ss-play", name: "play" });
  const ariaLabel = "Time of the movement";
  const slider = element("input", { type: "range", min: "0", step: "0.01", name: "time", ariaLabel });
  slider.addEventListener("input", () => {
    play(false);
    show({ time: Number(slider.value) });
  });
  const stops = element("div", { class: "ss-ticks" });
  const clock = element("output", { class: "ss-clock" });
  const track = element("div", { class: "ss-track" }, slider, stops);
  const box = element("div", { class: "ss-timeline" }, button, track, clock);
  const goTo = (/** @type {StopRecord} */ stop) => {
    play(false);
    show({ time: stop.time_s + (stop.operation === null ? 0 : REST) });
  };
  return { box, button, slider, stops, clock, goTo, movement: /** @type {Movement | null} */ (null) };
}

/**
 * Returns the last time of a movement, s.
 * @param {Movement} movement
 */
const durationOf = (movement) => movement.times_s.at(-1) ?? 0;

/**
 * Shows the time of a view on the time line.
 * @param {ReturnType<typeof makeTimeline>} timeline
 * @param {View} view
 */
function showTimeline(timeline, view) {
  const { movement } = view.drawing;
  const { box, button, slider, clock } = timeline;
  const duration = durationOf(movement);
  box.hidden = movement.stops.length < 2;
  if (timeline.movement !== movement) {
    timeline.movement = movement;
    slider.max = String(duration);
    showStops(timeline, movement);
  }
  slider.value = String(view.state.time);
  button.textContent = view.playing ? "Pause" : "Play";
  const time = `${view.state.time.toFixed(1)} s of ${duration.toFixed(1)} s`;
  clock.textContent = movement.checked ? time : `${time}, paths not checked`;
  clock.title = movement.checked
    ? ""
    : "The paths between the spots were not checked for collision: add [transfer] to the cell to check them.";
}

/**
 * Puts a button below the slider for every stop.
 * @param {ReturnType<typeof makeTimeline>} timeline
 * @param {Movement} movement
 */
function showStops({ stops, goTo }, movement) {
  const shares = movement.stops.map((stop) => clamp(stop.time_s / (durationOf(movement) || 1), 0, 1));
  const buttons = movement.stops.map((stop, k) => {
    const share = shares[k];
    const room = Math.min(...shares.filter((_, n) => n !== k).map((other) => Math.abs(other - share)));
    const button = makeButton(shortName(stop.name), () => goTo(stop), { title: stop.name });
    button.style.maxWidth = `${(100 * room).toFixed(1)}%`;
    button.style.left = `${(100 * share).toFixed(2)}%`;
    button.style.transform = `translateX(${(-100 * share).toFixed(1)}%)`;
    return button;
  });
  stops.replaceChildren(...buttons);
}
