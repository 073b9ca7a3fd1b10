// Control of the camera: drags, zoom, and flights from view to view.

/** Duration of a flight of the camera, ms. */
const FLIGHT = 320;

/** Angle of the camera per pixel of a drag, rad. */
const TURN = 0.008;

class CameraControl {
  /**
   * @param {View} view
   * @param {(camera: Camera) => void} tell called after every change
   * @param {() => void} request requests a picture
   */
  constructor(view, tell, request) {
    this.view = view;
    this.tell = tell;
    this.request = request;
    /**
     * Flight that is under way.
     * @type {{ from: Camera, goal: Camera, start: number } | null}
     */
    this.flight = null;
  }

  /** Returns a copy of the camera. */
  current() {
    const { camera } = this.view;
    return { ...camera, target: [...camera.target] };
  }

  /**
   * Changes the camera.
   * @param {Partial<Camera>} wanted
   */
  set(wanted) {
    this.take(wanted);
    this.tell(this.current());
  }

  /**
   * Changes the camera without an event, as a linked viewer does.
   * @param {Partial<Camera>} wanted
   */
  take(wanted) {
    this.flight = null;
    const camera = { ...this.view.camera, ...wanted };
    this.view.camera = { ...camera, elevation: clamp(camera.elevation, -0.25, Math.PI / 2) };
    this.request();
  }

  /**
   * Rotates the camera by a drag.
   * @param {number} dx px
   * @param {number} dy px
   */
  turn(dx, dy) {
    const { azimuth, elevation } = this.view.camera;
    this.set({ azimuth: azimuth - dx * TURN, elevation: elevation + dy * TURN });
  }

  /**
   * Shifts the picture by a drag.
   * @param {number} dx px
   * @param {number} dy px
   */
  shift(dx, dy) {
    const { right, up, pixelsPerMm } = this.view.optics;
    const offset = add(scaled(right, -dx / pixelsPerMm), scaled(up, dy / pixelsPerMm));
    this.set({ target: add(this.view.camera.target, offset) });
  }

  /**
   * Changes the distance of the camera. The point that the picture shows at the position `at` does not move.
   * @param {number} factor
   * @param {number[]} [at] px
   */
  zoom(factor, at) {
    const { camera, model, optics, width, height } = this.view;
    const span = norm(subtract(model.high, model.low));
    const distance = clamp(camera.distance * factor, span * 0.08, span * 12);
    const [dx, dy] = at ? [at[0] - width / 2, height / 2 - at[1]] : [0, 0];
    const mm = 1 / optics.pixelsPerMm;
    const across = add(scaled(optics.right, dx * mm), scaled(optics.up, dy * mm));
    const towards = scaled(across, 1 - distance / camera.distance);
    this.set({ distance, target: add(camera.target, towards) });
  }

  /**
   * Flies to a view.
   * @param {ViewName | "reset"} name
   */
  look(name) {
    const { camera } = this.view;
    const goal = fittedCamera(this.view, name === "reset" ? "iso" : name);
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (isStill || goal.parallel !== camera.parallel) {
      this.set(goal);
      return;
    }
    // The camera rotates the shorter way round.
    const round = 2 * Math.PI;
    const difference = camera.azimuth - goal.azimuth;
    const azimuth = goal.azimuth + difference - round * Math.round(difference / round);
    this.flight = { from: { ...camera, azimuth }, goal, start: performance.now() };
    this.request();
  }

  /**
   * Continues a flight.
   * @param {number} now ms
   */
  advance(now) {
    const { flight } = this;
    if (!flight) return;
    const { from, goal, start } = flight;
    const linear = clamp((now - start) / FLIGHT, 0, 1);
    const share = linear * linear * (3 - 2 * linear);
    this.set({
      parallel: goal.parallel,
      target: add(scaled(from.target, 1 - share), scaled(goal.target, share)),
      distance: mix(from.distance, goal.distance, share),
      azimuth: mix(from.azimuth, goal.azimuth, share),
      elevation: mix(from.elevation, goal.elevation, share),
    });
    this.flight = linear < 1 ? flight : null;
  }
}
