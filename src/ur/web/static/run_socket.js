// @ts-check
/** The web socket of programs and runs: their state and log, and requests. It is open while a panel shows them. */

const FIRST_PAUSE = 250; // ms
const UNUSED = 5000; // ms after which a connection that no panel uses is closed
const LONGEST_PAUSE = 3000;
const SILENT = 4000; // ms after which a connection is taken for dead; the server sends a beat each second

/**
 * @typedef {{name: string, state: string, pid: number | null, exit_code: number | null, signal: number | null,
 *   restarts: number, restart_in: number | null, reason: string, held: boolean, core: boolean, ready: boolean,
 *   missing: string[], cpu: number | null, memory: number | null}} RunNode
 * @typedef {{run: string, title: string, master: string, started: number, detached: boolean, stopping: string | null,
 *   lost: number | null, known: boolean, nodes: RunNode[]}} Run
 * @typedef {{run: string, title: string, started: number, ended: number, exit_code: number | null, cause: string,
 *   lines: string[]}} EndedRun
 * @typedef {{runs: Run[], ended: EndedRun[]}} RunState
 * @typedef {{run: string, first: number, lines: [string, string, string][]}} LogPart
 * @typedef {{ok: boolean, text: string}} Answer
 */

export class RunSocket {
  constructor() {
    /** @type {RunState | null} */
    this.state = null;
    /** @type {((state: RunState | null) => void)[]} */
    this.onState = [];
    /** @type {((part: LogPart | null) => void)[]} null: the log begins anew */
    this.onLog = [];
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
    else if (this.users === 0) setTimeout(() => this.users === 0 && this.drop(), UNUSED);
  }

  /** Send a request, and wait for its answer. @param {Record<string, unknown>} message @returns {Promise<Answer | null>} null: not sent, or no answer */
  request(message) {
    const socket = this.socket;
    if (!socket || socket.readyState !== WebSocket.OPEN || !this.beat) return Promise.resolve(null);
    this.number += 1;
    const id = this.number;
    socket.send(JSON.stringify({ ...message, n: this.beat, id }));
    return new Promise((done) => this.waiting.set(id, done));
  }

  open() {
    const socket = new WebSocket(`ws://${location.host}/ws/runs`);
    this.socket = socket;
    this.heardAt = performance.now();
    socket.onmessage = (event) => {
      if (this.socket !== socket) return;
      this.heardAt = performance.now();
      this.pause = FIRST_PAUSE;
      this.take(JSON.parse(event.data));
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
    this.state = null;
    for (const done of this.waiting.values()) done(null);
    this.waiting.clear();
    for (const show of this.onState) show(null);
    for (const show of this.onLog) show(null);
    if (before?.readyState === WebSocket.CONNECTING) before.onopen = () => before.close(); // closing it now is an error
    else before?.close();
  }

  /** @param {any} message */
  take(message) {
    if (message.t === "beat") this.beat = message.n;
    else if (message.t === "log") for (const show of this.onLog) show(message);
    else if (message.t === "runs") {
      this.state = message;
      for (const show of this.onState) show(message);
    } else if (message.t === "answer") {
      this.waiting.get(message.id)?.(message);
      this.waiting.delete(message.id);
    }
  }

  check() {
    if (this.socket && performance.now() - this.heardAt > SILENT) {
      this.drop();
      if (this.users > 0) this.open();
    }
  }
}

/** The one connection of the page. */
export const RUNS = new RunSocket();
