// @ts-check
/** The stick for a thumb, and the keys that do the same. It springs back: what is not held does not drive. */

import { takesKeys, withoutFling } from "./elements.js";

const DEAD = 0.12; // share of the radius that counts as the middle
const KEYS = /** @type {Record<string, [number, number]>} */ ({
  ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1],
  KeyW: [1, 0], KeyS: [-1, 0], KeyA: [0, 1], KeyD: [0, -1],
});

export class Stick {
  /**
   * @param {HTMLElement} pad @param {HTMLElement} knob
   * @param {(forward: number, turn: number) => void} onMove shares from -1 to 1
   * @param {() => void} onLetGo
   */
  constructor(pad, knob, onMove, onLetGo) {
    this.pad = pad;
    this.knob = knob;
    this.onMove = onMove;
    this.onLetGo = onLetGo;
    /** @type {number | null} */
    this.pointer = null;
    /** @type {Set<string>} */
    this.keys = new Set();
    this.enabled = false;
    this.shifted = false; // the Shift key is held
    pad.addEventListener("pointerdown", (event) => this.down(event));
    pad.addEventListener("pointermove", (event) => this.moved(event));
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
      pad.addEventListener(name, (event) => this.up(/** @type {PointerEvent} */ (event)));
    }
    withoutFling(pad);
    pad.addEventListener("contextmenu", (event) => event.preventDefault());
    addEventListener("keydown", (event) => this.key(event, true));
    addEventListener("keyup", (event) => this.key(event, false));
    addEventListener("blur", () => this.drop());
    addEventListener("pagehide", () => this.drop());
    document.addEventListener("visibilitychange", () => document.hidden && this.drop());
  }

  /** @param {boolean} enabled */
  enable(enabled) {
    this.enabled = enabled;
    if (!enabled) this.drop();
  }

  /** Let go of the stick, however it is held. */
  drop() {
    const held = this.pointer !== null || this.keys.size > 0;
    this.pointer = null;
    this.keys.clear();
    this.place(0, 0);
    if (held) this.onLetGo();
  }

  /** @param {PointerEvent} event */
  down(event) {
    if (!this.enabled || this.pointer !== null || event.button !== 0) return;
    event.preventDefault();
    this.pointer = event.pointerId;
    this.pad.setPointerCapture(event.pointerId);
    this.moved(event);
  }

  /** @param {PointerEvent} event */
  moved(event) {
    if (event.pointerId !== this.pointer) return;
    const box = this.pad.getBoundingClientRect();
    const radius = box.width / 2;
    let x = (event.clientX - box.left) / radius - 1;
    let y = 1 - (event.clientY - box.top) / radius;
    const length = Math.hypot(x, y);
    if (length > 1) [x, y] = [x / length, y / length];
    this.place(x, y);
    this.onMove(shape(y), -shape(x));
  }

  /** @param {PointerEvent} event */
  up(event) {
    if (event.pointerId === this.pointer) this.drop();
  }

  /** @param {KeyboardEvent} event @param {boolean} pressed */
  key(event, pressed) {
    this.shifted = event.shiftKey;
    const known = event.code in KEYS && !takesKeys(event.target);
    if (event.key === "Shift" && this.keys.size) this.moveByKeys();
    if (!known || !this.enabled || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    if (event.repeat) return;
    if (pressed) this.keys.add(event.code);
    else if (!this.keys.delete(event.code)) return;
    if (this.keys.size) {
      this.moveByKeys();
      return;
    }
    this.place(0, 0);
    this.onLetGo();
  }

  moveByKeys() {
    let [forward, turn] = [0, 0];
    for (const code of this.keys) {
      forward += KEYS[code][0];
      turn += KEYS[code][1];
    }
    forward = Math.sign(forward);
    turn = Math.sign(turn);
    this.place(-turn, forward);
    this.onMove(forward, turn);
  }

  /** @param {number} x @param {number} y */
  place(x, y) {
    const reach = this.pad.clientWidth / 2 - 34;
    this.knob.style.transform = `translate(${x * reach}px, ${-y * reach}px)`;
  }
}

/** Nothing near the middle, and finer there than outside. @param {number} share */
export function shape(share) {
  const size = Math.max(0, Math.abs(share) - DEAD) / (1 - DEAD);
  return Math.sign(share) * size * (0.4 + 0.6 * size);
}
