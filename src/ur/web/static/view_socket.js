// @ts-check
/** The web socket that shows the robot. It connects again by itself, at once and then ever more slowly. */

import { readFrame } from "./wire.js";

const FIRST_PAUSE = 250; // ms
const LONGEST_PAUSE = 3000;
const SILENT = 3000; // ms without a frame after which a connection is taken for dead; the server sends two a second
const GATHER = 100; // ms in which changes are gathered

/** What the page shows: names of layers, and of plots where they are open. @typedef {{layers: string, plots?: string}} Shown */

export class ViewSocket {
  /**
   * @param {() => Shown} shown what the page shows now
   * @param {(frame: import("./wire.js").Frame) => void} onFrame @param {() => void} onRefused
   */
  constructor(shown, onFrame, onRefused) {
    this.shown = shown;
    this.onFrame = onFrame;
    this.onRefused = onRefused;
    this.heardAt = -Infinity;
    this.pause = FIRST_PAUSE;
    /** What the server was asked for, as JSON. */
    this.asked = "";
    this.due = false;
    /** @type {WebSocket | null} */
    this.socket = null;
    this.open();
    setInterval(() => this.check(), 500);
    addEventListener("online", () => this.check());
    document.addEventListener("visibilitychange", () => this.check());
  }

  /** Seconds since the last frame. */
  get age() {
    return (performance.now() - this.heardAt) / 1000;
  }

  open() {
    const shown = this.shown();
    const query = Object.entries(shown).map(([name, value]) => `${name}=${value}`).join("&");
    const socket = new WebSocket(`ws://${location.host}/ws/view?${query}`);
    this.asked = JSON.stringify(shown);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.openedAt = performance.now();
    socket.onopen = () => this.send(); // what has changed meanwhile
    socket.onmessage = (event) => {
      if (this.socket !== socket) return;
      this.heardAt = performance.now();
      this.pause = FIRST_PAUSE;
      this.onFrame(readFrame(event.data));
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.socket = null;
      this.again();
    };
  }

  /** The page shows something else: ask for it soon, once for several changes. */
  change() {
    if (this.due) return;
    this.due = true;
    setTimeout(() => {
      this.due = false;
      this.send();
    }, GATHER);
  }

  /** Ask for what the page shows now, unless that is known; a connection that is made later asks for it by itself. */
  send() {
    const text = JSON.stringify(this.shown());
    if (this.socket?.readyState !== WebSocket.OPEN || text === this.asked) return;
    this.asked = text;
    this.socket.send(text);
  }

  async again() {
    const pause = this.pause;
    this.pause = Math.min(2 * pause, LONGEST_PAUSE);
    await new Promise((done) => setTimeout(done, pause));
    const answer = await fetch("/api/me").catch(() => null);
    if (answer && answer.status === 403) this.onRefused();
    else this.open();
  }

  check() {
    const since = Math.max(this.heardAt, this.openedAt ?? 0);
    if (this.socket && performance.now() - since > SILENT) {
      const dead = this.socket;
      this.socket = null;
      dead.close();
      this.open();
    }
  }
}
