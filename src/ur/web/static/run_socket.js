// @ts-check
/** The web socket of programs and runs: their state and log, and requests. */

import { PanelSocket } from "./panel_socket.js";

const UNUSED = 5000; // ms

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

/** @extends {PanelSocket<Answer>} */
export class RunSocket extends PanelSocket {
  constructor() {
    super("/ws/runs", UNUSED);
    /** @type {RunState | null} */
    this.state = null;
    /** @type {((state: RunState | null) => void)[]} */
    this.onState = [];
    /** @type {((part: LogPart | null) => void)[]} null: the log begins anew */
    this.onLog = [];
  }

  /** @override */
  dropped() {
    this.state = null;
    for (const show of this.onState) show(null);
    for (const show of this.onLog) show(null);
  }

  /** @override @param {any} message */
  take(message) {
    if (super.take(message)) return true;
    if (message.t === "log") for (const show of this.onLog) show(message);
    else if (message.t === "runs") {
      this.state = message;
      for (const show of this.onState) show(message);
    }
    return true;
  }
}

/** The one connection of the page. */
export const RUNS = new RunSocket();
