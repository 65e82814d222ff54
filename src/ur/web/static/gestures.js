// @ts-check
/** Fingers, mouse and keys on the map: pan, zoom, and press-drag-release to point at a place with a heading. */

import { withoutFling } from "./elements.js";

const DRAG = 16; // pixels from which on a drag gives a heading
const ZOOM_STEP = 1.4;
const TAP = 8; // pixels that a finger may move while it taps

/** Takes what one finger draws, m; "drop": it was no stroke. @typedef {(phase: "down" | "move" | "up" | "drop", x: number, y: number) => void} Pen */

export class Gestures {
  /**
   * @param {import("./map_view.js").MapView} map
   * @param {() => boolean} points whether one finger points at a place, instead of moving the map
   * @param {(place: import("./map_view.js").Place) => void} onPoint
   * @param {() => void} onPan the user has moved the map
   */
  constructor(map, points, onPoint, onPan) {
    this.map = map;
    this.points = points;
    this.onPoint = onPoint;
    this.onPan = onPan;
    /** Called with the point of the map that is tapped, where a panel wants taps. @type {((x: number, y: number) => void) | null} */
    this.onTap = null;
    /** Takes strokes in place of taps, where a panel wants them. @type {Pen | null} */
    this.pen = null;
    /** A stroke is being drawn. */
    this.drawing = false;
    /** Called when another part of the page takes the taps, or a press on the map gets another meaning. */
    this.onTapsLost = () => {};
    /** Called once with the place that is pointed at next, in place of what the mode does. @type {((place: import("./map_view.js").Place) => void) | null} */
    this.picker = null;
    /** @type {[number, number] | null} */
    this.tapped = null;
    /** @type {Map<number, [number, number]>} */
    this.fingers = new Map();
    /** @type {{x: number, y: number, left: number, top: number} | null} */
    this.pressed = null;
    const { canvas } = map;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.moved(event));
    canvas.addEventListener("pointerup", (event) => this.up(event, true));
    canvas.addEventListener("pointercancel", (event) => this.up(event, false));
    withoutFling(canvas);
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("keydown", (event) => this.key(event));
    addEventListener("blur", () => this.drop());
  }

  /** Give taps to a part of the page. @param {(x: number, y: number) => void} tap @param {() => void} onLost another part takes them @param {Pen | null} pen */
  takeTaps(tap, onLost, pen = null) {
    const lost = this.onTap === tap ? () => {} : this.onTapsLost;
    [this.onTap, this.onTapsLost, this.pen] = [tap, onLost, pen];
    lost();
  }

  /** Give taps to no part, if this one has them. @param {(x: number, y: number) => void} tap */
  dropTaps(tap) {
    if (this.onTap === tap) [this.onTap, this.onTapsLost, this.pen, this.drawing] = [null, () => {}, null, false];
  }

  /** Take the taps from the part that has them. */
  loseTaps() {
    const lost = this.onTapsLost;
    [this.onTap, this.onTapsLost, this.pen, this.drawing] = [null, () => {}, null, false];
    lost();
  }

  /** Forget what was begun. */
  drop() {
    this.write("drop", 0, 0);
    this.fingers.clear();
    this.pressed = this.tapped = null;
    if (this.map.pointed) {
      this.map.pointed = null;
      this.map.request();
    }
  }

  /** Go on with a stroke, if one is drawn. @param {"move" | "up" | "drop"} phase @param {number} left @param {number} top pixels */
  write(phase, left, top) {
    const { pen, drawing } = this;
    this.drawing = drawing && phase === "move";
    if (drawing) pen?.(phase, ...this.map.view.toPlane(left, top));
  }

  /** @param {PointerEvent} event */
  down(event) {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    this.map.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    this.pressed = null;
    this.map.pointed = null;
    const alone = this.fingers.size === 1;
    this.write("drop", 0, 0); // two fingers move the map
    this.drawing = this.pen !== null && alone;
    if (this.drawing) this.pen?.("down", ...this.map.view.toPlane(event.offsetX, event.offsetY));
    this.tapped = this.onTap && !this.pen && alone ? [event.offsetX, event.offsetY] : null;
    if (this.fingers.size === 1 && !this.onTap && (this.picker || this.points())) {
      const [x, y] = this.map.view.toPlane(event.offsetX, event.offsetY);
      this.pressed = { x, y, left: event.offsetX, top: event.offsetY };
      this.map.pointed = { x, y, yaw: this.headingThere(x, y) };
    }
    this.map.request();
  }

  /** @param {PointerEvent} event */
  moved(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const { view } = this.map;
    if (this.tapped) {
      if (Math.hypot(event.offsetX - this.tapped[0], event.offsetY - this.tapped[1]) < TAP) return;
      this.tapped = null;
    }
    if (this.pressed) {
      this.map.pointed = this.placeAt(event);
    } else if (this.drawing) {
      this.write("move", event.offsetX, event.offsetY);
    } else if (this.fingers.size === 1) {
      view.pan(event.offsetX - before[0], event.offsetY - before[1]);
      this.onPan();
    } else if (this.fingers.size === 2) {
      const other = [...this.fingers].find(([id]) => id !== event.pointerId);
      if (other) {
        const [, [ox, oy]] = other;
        const [was, is] = [
          Math.hypot(before[0] - ox, before[1] - oy),
          Math.hypot(event.offsetX - ox, event.offsetY - oy),
        ];
        view.pan((event.offsetX - before[0]) / 2, (event.offsetY - before[1]) / 2);
        if (was > 5) view.zoom(is / was, (event.offsetX + ox) / 2, (event.offsetY + oy) / 2);
        this.onPan();
      }
    }
    this.fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    this.map.request();
  }

  /** @param {PointerEvent} event @param {boolean} meant */
  up(event, meant) {
    if (!this.fingers.delete(event.pointerId)) return;
    this.write(meant ? "up" : "drop", event.offsetX, event.offsetY);
    const place = this.pressed && meant ? this.placeAt(event) : null;
    const tapped = meant ? this.tapped : null;
    this.tapped = null;
    this.pressed = null;
    this.map.pointed = null;
    this.map.request();
    const { picker } = this;
    if (place) this.picker = null;
    if (place) (picker ?? this.onPoint)(place);
    if (tapped) this.onTap?.(...this.map.view.toPlane(...tapped));
  }

  /** @param {PointerEvent} event */
  placeAt(event) {
    const { x, y, left, top } = /** @type {NonNullable<typeof this.pressed>} */ (this.pressed);
    const [dx, dy] = [event.offsetX - left, top - event.offsetY];
    const dragged = Math.hypot(dx, dy) >= DRAG;
    return { x, y, yaw: dragged ? this.map.view.toYaw(Math.atan2(dy, dx)) : this.headingThere(x, y), dragged };
  }

  /** The direction from the robot to a place. @param {number} x @param {number} y */
  headingThere(x, y) {
    const pose = this.map.pose;
    return pose ? Math.atan2(y - pose.y, x - pose.x) : 0;
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    event.preventDefault();
    const step = event.deltaMode === 1 ? 30 * event.deltaY : event.deltaY;
    this.map.whole = false;
    this.map.view.zoom(Math.exp(-Math.max(-300, Math.min(300, step)) / 500), event.offsetX, event.offsetY);
    this.map.request();
  }

  /** Zoom round the middle of the canvas. @param {boolean} nearer */
  step(nearer) {
    const { view } = this.map;
    this.map.whole = false;
    view.zoom(nearer ? ZOOM_STEP : 1 / ZOOM_STEP, view.width / 2, view.height / 2);
    this.map.request();
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.key === "+" || event.key === "=") this.step(true);
    else if (event.key === "-") this.step(false);
    else if (event.key === "Escape") this.drop();
  }
}
