// @ts-check
/** A web socket that is open while panels use it: requests with their answers, and a new connection when one is lost. */

const FIRST_PAUSE = 250; // ms
const LONGEST_PAUSE = 3000;
const SILENT = 4000; // ms after which a connection is taken for dead; the server sends a beat each second

/** @template Answer */
export class PanelSocket {
  /**
   * @param {string} path @param {number} unused ms after which a connection that no panel uses is closed
   * @param {number} [limit] ms after which a request has no answer
   */
  constructor(path, unused, limit = Infinity) {
    this.path = path;
    this.unused = unused;
    this.limit = limit;
    this.users = 0;
    this.beat = 0;
    this.number = 0;
    this.heardAt = -Infinity;
    this.pause = FIRST_PAUSE;
    /** @type {WebSocket | null} */
    this.socket = null;
    /** @type {Map<number, (answer: Answer | null) => void>} */
    this.waiting = new Map();
    setInterval(() => this.check(), 500);
  }

  /** A panel is shown, or hidden. @param {boolean} shown */
  use(shown) {
    this.users += shown ? 1 : -1;
    if (this.users > 0 && !this.socket) this.open();
    else if (this.users === 0) setTimeout(() => this.users === 0 && this.drop(), this.unused);
  }

  /** Send a request, and wait for its answer. @param {Record<string, unknown>} message @returns {Promise<Answer | null>} null: not sent, or no answer */
  request(message) {
    const socket = this.socket;
    if (!socket || socket.readyState !== WebSocket.OPEN || !this.beat) return Promise.resolve(null);
    this.number += 1;
    const id = this.number;
    socket.send(JSON.stringify({ ...message, n: this.beat, id }));
    if (this.limit < Infinity) setTimeout(() => this.answer(id, null), this.limit);
    return new Promise((done) => this.waiting.set(id, done));
  }

  /** @param {number} id @param {Answer | null} answer */
  answer(id, answer) {
    this.waiting.get(id)?.(answer);
    this.waiting.delete(id);
  }

  open() {
    const socket = new WebSocket(`ws://${location.host}${this.path}`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.heardAt = performance.now();
    socket.onopen = () => this.socket === socket && this.opened();
    socket.onmessage = (event) => {
      if (this.socket !== socket) return;
      this.heardAt = performance.now();
      this.pause = FIRST_PAUSE;
      if (typeof event.data === "string") this.take(JSON.parse(event.data));
      else this.takeBytes(event.data);
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.drop();
      setTimeout(() => this.users > 0 && !this.socket && this.open(), this.pause);
      this.pause = Math.min(2 * this.pause, LONGEST_PAUSE);
    };
  }

  /** Close the connection, and drop all that is known by it. */
  drop() {
    const before = this.socket;
    this.socket = null;
    this.beat = 0;
    for (const done of this.waiting.values()) done(null);
    this.waiting.clear();
    this.dropped();
    if (before?.readyState === WebSocket.CONNECTING) before.onopen = () => before.close(); // closing it now is an error
    else before?.close();
  }

  check() {
    if (this.socket && performance.now() - this.heardAt > SILENT) {
      this.drop();
      if (this.users > 0) this.open();
    }
  }

  /** Take a message; false if it is neither a beat nor an answer. @param {any} message @returns {boolean} */
  take(message) {
    if (message.t === "beat") this.beat = message.n;
    else if (message.t === "answer") this.answer(message.id, message);
    else return false;
    return true;
  }

  opened() {}

  dropped() {}

  /** @param {ArrayBuffer} _bytes */
  takeBytes(_bytes) {}
}
