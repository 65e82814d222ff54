// @ts-check
/** The web socket of data of the robot: what panels show, and questions. */

import { PanelSocket } from "../panel_socket.js";

const UNUSED = 3000; // ms
const GATHER = 150; // ms in which changes of what is shown are gathered
const ANSWER_LIMIT = 20000; // ms

/** @typedef {{ok: boolean, text: string, value?: any}} DataAnswer */

/** @extends {PanelSocket<DataAnswer>} */
export class DataSocket extends PanelSocket {
  constructor() {
    super("/ws/data", UNUSED, ANSWER_LIMIT);
    /** What is shown, by the names of `ur.web.wire.data_requests.Show`. @type {Record<string, unknown>} */
    this.shown = {};
    /** @type {Map<string, ((message: any) => void)[]>} */
    this.handlers = new Map();
    /** "up" while the robot's end answers. */
    this.end = "";
    this.due = false;
  }

  /** Have a function called with each message of a kind; "state" when `end` has changed, "binary" with an ArrayBuffer. @param {string} kind @param {(message: any) => void} handler */
  on(kind, handler) {
    this.handlers.set(kind, [...(this.handlers.get(kind) ?? []), handler]);
  }

  /** Show something, besides what is shown; undefined: no longer. @param {Record<string, unknown>} changes */
  show(changes) {
    const before = JSON.stringify(this.shown);
    this.shown = { ...this.shown, ...changes };
    if (this.due || before === JSON.stringify(this.shown)) return;
    this.due = true;
    setTimeout(() => {
      this.due = false;
      this.opened();
    }, GATHER);
  }

  /** @override */
  opened() {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ t: "show", ...this.shown }));
  }

  /** @override */
  dropped() {
    this.enter("");
  }

  /** @param {string} end */
  enter(end) {
    if (this.end === end) return;
    this.end = end;
    this.tell("state", end);
  }

  /** @override @param {any} message */
  take(message) {
    if (!super.take(message)) this.tell(message.t, message);
    else if (message.t === "beat") this.enter(message.end);
    return true;
  }

  /** @override @param {ArrayBuffer} bytes */
  takeBytes(bytes) {
    this.tell("binary", bytes);
  }

  /** @param {string} kind @param {any} message */
  tell(kind, message) {
    for (const handler of this.handlers.get(kind) ?? []) handler(message);
  }
}

/** The one connection of the page. */
export const DATA = new DataSocket();
