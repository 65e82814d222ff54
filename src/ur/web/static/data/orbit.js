// @ts-check
/** The camera of the 3D view: it turns round a point, by mouse, fingers or keys. */

const TURN = 0.008; // rad a pixel
const LEAST_DISTANCE = 0.3; // m
const MOST_DISTANCE = 300;
const STEP = 0.15; // rad of a key

export class Orbit {
  /** @param {HTMLElement} element @param {() => void} onChange */
  constructor(element, onChange) {
    this.onChange = onChange;
    this.target = [0, 0, 0];
    this.distance = 6;
    this.around = -2.4; // rad: behind the robot, to its right
    this.above = 0.75;
    /** @type {Map<number, [number, number]>} */
    this.fingers = new Map();
    element.addEventListener("pointerdown", (event) => {
      element.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const name of /** @type {const} */ (["pointerup", "pointercancel"])) {
      element.addEventListener(name, (event) => this.fingers.delete(event.pointerId));
    }
    element.addEventListener("pointermove", (event) => this.move(event));
    element.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(0.001 * event.deltaY));
    }, { passive: false });
    element.addEventListener("keydown", (event) => this.key(event));
  }

  /** Where the camera is, in metres. */
  get place() {
    const flat = this.distance * Math.cos(this.above);
    const [x, y, z] = this.target;
    return [x + flat * Math.cos(this.around), y + flat * Math.sin(this.around), z + this.distance * Math.sin(this.above)];
  }

  /** @param {number} around @param {number} above rad */
  turn(around, above) {
    this.around += around;
    this.above = Math.max(-0.2, Math.min(1.55, this.above + above));
    this.onChange();
  }

  /** @param {number} right @param {number} up pixels */
  pan(right, up) {
    const unit = this.distance * 0.0015;
    const [c, s] = [Math.cos(this.around), Math.sin(this.around)];
    this.target[0] += unit * (right * s - up * c);
    this.target[1] += unit * (-right * c - up * s);
    this.onChange();
  }

  /** @param {number} factor */
  zoom(factor) {
    this.distance = Math.max(LEAST_DISTANCE, Math.min(MOST_DISTANCE, this.distance * factor));
    this.onChange();
  }

  /** @param {PointerEvent} event */
  move(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
    if (this.fingers.size === 2) {
      const other = [...this.fingers].find(([id]) => id !== event.pointerId)?.[1] ?? before;
      const was = Math.hypot(before[0] - other[0], before[1] - other[1]);
      const is = Math.hypot(event.clientX - other[0], event.clientY - other[1]);
      this.pan(-dx / 2, dy / 2);
      if (is > 1) this.zoom(was / is);
    } else if (event.shiftKey || event.buttons & 6) this.pan(-dx, dy);
    else this.turn(-TURN * dx, TURN * dy);
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const turns = /** @type {Record<string, [number, number]>} */ ({ ArrowLeft: [STEP, 0], ArrowRight: [-STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP] });
    const factor = { "+": 0.8, "-": 1.25 }[event.key];
    if (turns[event.key]) this.turn(...turns[event.key]);
    else if (factor) this.zoom(factor);
    else return;
    event.preventDefault();
    event.stopPropagation(); // arrows drive the robot elsewhere
  }
}
