// @ts-check
/** The web socket of data of the robot: what panels show, and questions. It is open while a panel uses it. */

const FIRST_PAUSE = 250; // ms
const LONGEST_PAUSE = 3000;
const UNUSED = 3000; // ms after which a connection that no panel uses is closed
const SILENT = 4000; // ms after which a connection is taken for dead; the server sends a beat each second
const GATHER = 150; // ms in which changes of what is shown are gathered
const ANSWER_LIMIT = 20000; // ms

/** @typedef {{ok: boolean, text: string, value?: any, kind?: string, whole?: boolean}} DataAnswer */

export class DataSocket {
  constructor() {
    /** What is shown, by the names of `ur.web.wire.data_requests.Show`. @type {Record<string, unknown>} */
    this.shown = {};
    /** @type {Map<string, ((message: any) => void)[]>} */
    this.handlers = new Map();
    /** "up" while the robot's end answers. */
    this.end = "";
    this.users = 0;
    this.beat = 0;
    this.number = 0;
    this.heardAt = -Infinity;
    this.pause = FIRST_PAUSE;
    this.due = false;
    /** @type {WebSocket | null} */
    this.socket = null;
    /** @type {Map<number, (answer: DataAnswer | null) => void>} */
    this.waiting = new Map();
    setInterval(() => this.check(), 500);
  }

  /** Have a function called with each message of a kind; "state" when `end` has changed, "binary" with an ArrayBuffer. @param {string} kind @param {(message: any) => void} handler */
  on(kind, handler) {
    this.handlers.set(kind, [...(this.handlers.get(kind) ?? []), handler]);
  }

  /** A panel is shown, or hidden. @param {boolean} shown */
  use(shown) {
    this.users += shown ? 1 : -1;
    if (this.users > 0 && !this.socket) this.open();
    else if (this.users === 0) setTimeout(() => this.users === 0 && this.drop(), UNUSED);
  }

  /** Show something, besides what is shown; undefined: no longer. @param {Record<string, unknown>} changes */
  show(changes) {
    const before = JSON.stringify(this.shown);
    this.shown = { ...this.shown, ...changes };
    if (this.due || before === JSON.stringify(this.shown)) return;
    this.due = true;
    setTimeout(() => {
      this.due = false;
      this.ask();
    }, GATHER);
  }

  ask() {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ t: "show", ...this.shown }));
  }

  /** Ask, and wait for the answer. @param {Record<string, unknown>} message @returns {Promise<DataAnswer | null>} null: not sent, or no answer */
  request(message) {
    const socket = this.socket;
    if (!socket || socket.readyState !== WebSocket.OPEN || !this.beat) return Promise.resolve(null);
    this.number += 1;
    const id = this.number;
    socket.send(JSON.stringify({ ...message, n: this.beat, id }));
    setTimeout(() => this.answer(id, null), ANSWER_LIMIT);
    return new Promise((done) => this.waiting.set(id, done));
  }

  /** @param {number} id @param {DataAnswer | null} answer */
  answer(id, answer) {
    this.waiting.get(id)?.(answer);
    this.waiting.delete(id);
  }

  open() {
    const socket = new WebSocket(`ws://${location.host}/ws/data`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.heardAt = performance.now();
    socket.onopen = () => this.socket === socket && this.ask();
    socket.onmessage = (event) => {
      if (this.socket !== socket) return;
      this.heardAt = performance.now();
      this.pause = FIRST_PAUSE;
      if (typeof event.data === "string") this.take(JSON.parse(event.data));
      else this.tell("binary", event.data);
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.drop();
      setTimeout(() => this.users > 0 && !this.socket && this.open(), this.pause);
      this.pause = Math.min(2 * this.pause, LONGEST_PAUSE);
    };
  }

  /** Forget the connection, and what is known by it. */
  drop() {
    const before = this.socket;
    this.socket = null;
    this.beat = 0;
    for (const done of this.waiting.values()) done(null);
    this.waiting.clear();
    this.enter("");
    if (before?.readyState === WebSocket.CONNECTING) before.onopen = () => before.close(); // closing it now is an error
    else before?.close();
  }

  /** @param {string} end */
  enter(end) {
    if (this.end === end) return;
    this.end = end;
    this.tell("state", end);
  }

  /** @param {any} message */
  take(message) {
    if (message.t === "beat") {
      this.beat = message.n;
      this.enter(message.end);
    } else if (message.t === "answer") this.answer(message.id, message);
    else this.tell(message.t, message);
  }

  /** @param {string} kind @param {any} message */
  tell(kind, message) {
    for (const handler of this.handlers.get(kind) ?? []) handler(message);
  }

  check() {
    if (this.socket && performance.now() - this.heardAt > SILENT) {
      this.drop();
      if (this.users > 0) this.open();
    }
  }
}

/** The one connection of the page. */
export const DATA = new DataSocket();
