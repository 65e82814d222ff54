// @ts-check
/**
 * The web socket that drives, and nothing else. Messages that set the robot in motion answer the newest challenge of the
 * robot, so it is never executed late. After a gap the stick has to be let go before it counts again.
 */

const GAP = 300; // ms without a challenge after which a press is over
const YOUNG = 60; // ms: a challenge that a new press may answer at once
const ALIVE_EVERY = 200; // ms
const FIRST_PAUSE = 250;
const LONGEST_PAUSE = 3000;
const OPENED_AGAIN = "opened again"; // see ur.web.server.drivers

/** @typedef {"idle" | "held" | "dead"} Press */

export class DriveSocket {
  /** @param {string} tab @param {(answer: any) => void} onAnswer @param {() => void} onChange */
  constructor(tab, onAnswer, onChange) {
    this.tab = tab;
    this.onAnswer = onAnswer;
    this.onChange = onChange;
    this.client = "";
    /** @type {Press} */
    this.press = "idle";
    /** Why the press is over. */
    this.why = "";
    /** @type {number[] | null} */
    this.newest = null;
    this.newestAt = -Infinity;
    this.aliveAt = -Infinity;
    this.hold = 0;
    this.forward = 0;
    this.turn = 0;
    this.left = 0;
    this.pause = FIRST_PAUSE;
    /** @type {WebSocket | null} */
    this.socket = null;
    this.open();
    setInterval(() => this.check(), 50);
  }

  open() {
    const socket = new WebSocket(`ws://${location.host}/ws/drive?tab=${this.tab}`);
    this.socket = socket;
    socket.onmessage = (event) => this.take(JSON.parse(event.data));
    socket.onclose = (event) => {
      if (this.socket !== socket) return;
      if (event.reason === OPENED_AGAIN) this.tab = newTabId(); // a copy of this tab: both would close each other's connection
      this.socket = null;
      this.newest = null;
      this.end();
      setTimeout(() => this.open(), this.pause);
      this.pause = Math.min(2 * this.pause, LONGEST_PAUSE);
    };
  }

  /** @param {any} message */
  take(message) {
    this.pause = FIRST_PAUSE;
    if (message.n) {
      const now = performance.now();
      if (now - this.newestAt > GAP) this.end();
      this.newest = message.n;
      this.newestAt = now;
      if (this.press === "held") this.sendStick();
      if (now - this.aliveAt > ALIVE_EVERY) {
        this.aliveAt = now;
        this.send({ t: "alive", n: this.newest });
      }
      return;
    }
    if (message.t === "hello") this.client = message.client;
    if (message.t === "over" && message.hold === this.hold) this.end(message.why);
    this.onAnswer(message);
  }

  /**
   * Move the stick: m/s ahead, rad/s, m/s to the left. The first call after `letGo` begins a press.
   * @param {number} forward @param {number} turn @param {number} left
   */
  move(forward, turn, left = 0) {
    this.forward = forward;
    this.turn = turn;
    this.left = left;
    if (this.press !== "idle") return;
    this.hold += 1;
    this.press = "held";
    if (performance.now() - this.newestAt < YOUNG) this.sendStick();
    this.onChange();
  }

  /** The user has let go, or cannot see the page any more. */
  letGo() {
    if (this.press === "idle") return;
    this.press = "idle";
    this.forward = this.turn = this.left = 0;
    this.send({ t: "let_go", hold: this.hold });
    this.onChange();
  }

  /** A press is over although the stick is still held. @param {string} why */
  end(why = "late") {
    if (this.press !== "held") return;
    this.why = why;
    this.press = "dead";
    this.send({ t: "let_go", hold: this.hold });
    this.onChange();
  }

  /** Send a request that has to be young; false where there is no connection. @param {Record<string, unknown>} request */
  request(request) {
    if (!this.newest) return false;
    return this.send({ ...request, n: this.newest });
  }

  /** @param {Record<string, unknown>} message */
  send(message) {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  sendStick() {
    this.send({ t: "stick", n: this.newest, hold: this.hold, forward: this.forward, turn: this.turn, left: this.left });
  }

  check() {
    if (this.press === "held" && performance.now() - this.newestAt > GAP) this.end();
  }
}

/** The id of this tab: a page that is loaded again is the same client of the robot. */
export function tabId() {
  return sessionStorage.getItem("tab") ?? newTabId();
}

function newTabId() {
  const bytes = crypto.getRandomValues(new Uint8Array(12));
  const fresh = [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  sessionStorage.setItem("tab", fresh);
  return fresh;
}
