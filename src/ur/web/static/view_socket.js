// @ts-check
/** The web socket that shows the robot. It connects again by itself, at once and then ever more slowly. */

import { readFrame } from "./wire.js";

const FIRST_PAUSE = 250; // ms
const LONGEST_PAUSE = 3000;
const SILENT = 3000; // ms without a frame after which a connection is taken for dead; the server sends two a second

export class ViewSocket {
  /**
   * @param {() => string} query what the page shows: layers and plots
   * @param {(frame: import("./wire.js").Frame) => void} onFrame @param {() => void} onRefused
   */
  constructor(query, onFrame, onRefused) {
    this.query = query;
    this.onFrame = onFrame;
    this.onRefused = onRefused;
    this.heardAt = -Infinity;
    this.pause = FIRST_PAUSE;
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
    const socket = new WebSocket(`ws://${location.host}/ws/view?${this.query()}`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.openedAt = performance.now();
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

  /** Ask for other layers: a new connection in place of this one. */
  reopen() {
    const before = this.socket;
    if (!before) return; // the next connection asks for them
    this.open();
    if (before.readyState === WebSocket.CONNECTING) before.onopen = () => before.close(); // closing it now is an error
    else before.close();
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
