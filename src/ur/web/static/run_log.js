// @ts-check
/** What nodes print: the last lines, of one node or of all, from a severity on. */

import { make } from "./elements.js";
import { TEXTS } from "./texts.js";

const MOST = 1000; // lines
const DRAWN = 400;
const RANKS = /** @type {Record<string, number>} */ ({ "": 1, debug: 0, info: 1, warning: 2, error: 3, fatal: 3 });
const LEVELS = /** @type {["debug" | "info" | "warning" | "error", number][]} */ ([
  ["debug", 0],
  ["info", 1],
  ["warning", 2],
  ["error", 3],
]);

/** @typedef {{run: string, node: string, severity: string, text: string}} Line */

export class RunLog {
  /** @param {HTMLElement} box */
  constructor(box) {
    /** @type {Line[]} */
    this.lines = [];
    this.run = "";
    const bar = make("div", "", "row");
    this.node = make("select");
    this.node.id = "log-node";
    this.node.ariaLabel = TEXTS.logOf;
    this.level = make("select");
    this.level.id = "log-level";
    this.level.ariaLabel = TEXTS.logFrom;
    for (const [name, rank] of LEVELS) this.level.append(new Option(TEXTS.levels[name], String(rank)));
    this.level.value = "1";
    for (const each of [this.node, this.level]) each.addEventListener("change", () => this.draw());
    bar.append(make("h3", TEXTS.log), this.node, this.level);
    this.list = make("div", "", "log");
    this.list.id = "log";
    this.list.tabIndex = 0;
    this.list.role = "log";
    this.list.ariaLabel = TEXTS.log;
    this.list.ariaLive = "off"; // hundreds of lines a second would be read out
    box.append(bar, this.list);
    this.showNodes([]);
  }

  /** Offer the nodes of a run. @param {string[]} names */
  showNodes(names) {
    const shown = [...this.node.options].slice(1).map((each) => each.value);
    if (this.node.options.length && shown.join() === names.join()) return;
    const chosen = this.node.value;
    this.node.replaceChildren(new Option(TEXTS.allNodes, ""), ...names.map((name) => new Option(name, name)));
    this.node.value = names.includes(chosen) ? chosen : "";
    this.draw();
  }

  /** Show the log of another run. @param {string} run */
  choose(run) {
    if (run === this.run) return;
    this.run = run;
    this.draw();
  }

  /** Take lines; null: all begins anew. @param {import("./run_socket.js").LogPart | null} part */
  take(part) {
    if (!part) {
      this.lines = [];
      this.draw();
      return;
    }
    const found = part.lines.map(([node, severity, text]) => ({ run: part.run, node, severity, text }));
    this.lines = [...this.lines, ...found].slice(-MOST);
    const shown = found.filter((line) => this.shows(line));
    if (!shown.length) return;
    const follows = this.list.scrollTop + this.list.clientHeight > this.list.scrollHeight - 8;
    this.list.querySelector(".none")?.remove();
    this.list.append(...shown.map(makeLine));
    while (this.list.childElementCount > DRAWN) this.list.firstElementChild?.remove();
    if (follows) this.list.scrollTop = this.list.scrollHeight;
  }

  /** @param {Line} line */
  shows(line) {
    if (line.run !== this.run || (this.node.value && line.node !== this.node.value)) return false;
    return (RANKS[line.severity] ?? 1) >= Number(this.level.value);
  }

  draw() {
    const shown = this.lines.filter((line) => this.shows(line)).slice(-DRAWN);
    this.list.replaceChildren(...(shown.length ? shown.map(makeLine) : [make("p", TEXTS.noLinesShown, "none")]));
    this.list.scrollTop = this.list.scrollHeight;
  }
}

/** A line with the time of day in place of seconds since 1970, which rospy and roscpp print. @param {string} text */
function withClock(text) {
  return text.replace(/^(\[ *[A-Z]+\] )\[(\d{10})\.\d+(?:, [\d.]+)?\]:?/, (_, level, time) => `${level}${TEXTS.clockTime(Number(time))}`);
}

/** @param {Line} line */
function makeLine({ node, severity, text }) {
  const row = make("div", "", severity === "fatal" ? "error" : severity);
  if (node) row.append(make("b", `${node.replace(/^\//, "")} `));
  row.append(withClock(text));
  return row;
}
