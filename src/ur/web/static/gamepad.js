// @ts-check
/** A gamepad on a desk: its left stick drives as the stick of the page does, its button B stops everything. */

import { shape } from "./stick.js";

const STOP_BUTTON = 1; // B in the standard layout of the Gamepad API
const [TURN_AXIS, FORWARD_AXIS] = [0, 1];

export class Gamepads {
  /**
   * @param {() => boolean} enabled whether a stick may drive now
   * @param {(forward: number, turn: number) => void} onMove shares from -1 to 1
   * @param {() => void} onLetGo @param {() => void} onStop
   * @param {() => boolean} driven whether the press that was begun goes on
   */
  constructor(enabled, onMove, onLetGo, onStop, driven) {
    this.enabled = enabled;
    this.onMove = onMove;
    this.onLetGo = onLetGo;
    this.onStop = onStop;
    this.driven = driven;
    /** "blocked": the stick has to be in the middle before it counts. @type {"idle" | "held" | "blocked"} */
    this.state = "blocked";
    this.stopHeld = true;
    this.running = false;
    addEventListener("gamepadconnected", () => this.start());
    addEventListener("gamepaddisconnected", () => this.drop());
    addEventListener("blur", () => this.drop());
    addEventListener("pagehide", () => this.drop());
    document.addEventListener("visibilitychange", () => document.hidden && this.drop());
  }

  /** The names of the gamepads that browsers have shown to the page. */
  get names() {
    return list().map((pad) => pad.id);
  }

  start() {
    if (this.running) return;
    this.running = true;
    const step = () => {
      this.step();
      this.running = list().length > 0;
      if (this.running) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  /** Let go; what is held has to be let go before it counts again. */
  drop() {
    const held = this.state === "held";
    this.state = "blocked";
    if (held) this.onLetGo();
  }

  step() {
    const pads = list();
    if (!pads.length || !document.hasFocus()) {
      this.drop();
      return;
    }
    const stop = pads.some((pad) => pad.buttons[STOP_BUTTON]?.pressed);
    if (stop && !this.stopHeld) this.onStop();
    this.stopHeld = stop;
    const [forward, turn] = strongest(pads);
    const middle = forward === 0 && turn === 0;
    if (!this.enabled()) this.drop();
    else if (middle) {
      if (this.state === "held") this.onLetGo();
      this.state = "idle";
    } else if (this.state === "held" && !this.driven()) this.state = "blocked"; // another client let go
    else if (this.state !== "blocked") {
      this.state = "held";
      this.onMove(forward, turn);
    }
  }
}

/** @returns {Gamepad[]} */
function list() {
  const pads = [...(navigator.getGamepads?.() ?? [])];
  return /** @type {Gamepad[]} */ (pads.filter((pad) => pad !== null && pad.connected));
}

/** Forward and turn of the gamepad that is pushed most. @param {Gamepad[]} pads @returns {[number, number]} */
function strongest(pads) {
  /** @type {[number, number]} */
  let best = [0, 0];
  for (const pad of pads) {
    const [forward, turn] = [-shape(pad.axes[FORWARD_AXIS] ?? 0), -shape(pad.axes[TURN_AXIS] ?? 0)];
    if (Math.hypot(forward, turn) > Math.hypot(...best)) best = [forward + 0, turn + 0];
  }
  return best;
}
