// @ts-check
/** The nodes of what runs: their state, buttons to start, stop and restart them, and their log. */

import { make, makeButton, makeSureButton, showName } from "./elements.js";
import { RunLog } from "./run_log.js";
import { RUNS } from "./run_socket.js";
import { TEXTS } from "./texts.js";

/** @typedef {import("./run_socket.js").Run} Run @typedef {import("./run_socket.js").RunNode} RunNode */

/** @type {import("./panels.js").Panel} */
export const RUN_PANEL = {
  name: "runs",
  label: TEXTS.nodes,
  icon: "M4 5h16v5H4zM4 14h16v5H4zM7 7.5h.01M7 16.5h.01M11 7.5h6M11 16.5h6",
  wide: true,
  make: (box, page) => {
    const panel = new RunPanel(box, page.mayDrive, (text) => page.say(text));
    return { show: (open) => (RUNS.use(open), panel.show(RUNS.state)) };
  },
};

class RunPanel {
  /** @param {HTMLElement} box @param {boolean} mayDrive @param {(text: string) => void} say */
  constructor(box, mayDrive, say) {
    this.mayDrive = mayDrive;
    this.say = say;
    this.drawn = "";
    this.chosen = make("select");
    this.chosen.id = "run";
    this.chosen.ariaLabel = TEXTS.run;
    this.chosen.addEventListener("change", () => this.show(RUNS.state));
    this.head = make("div", "", "row");
    this.note = make("p");
    this.table = make("table");
    this.table.createCaption().textContent = TEXTS.nodes;
    const titles = this.table.createTHead().insertRow();
    for (const title of TEXTS.nodeColumns) titles.append(make("th", title));
    this.body = this.table.createTBody();
    this.ended = make("section");
    box.append(this.head, this.note, this.table);
    const log = make("section", "", "log-box");
    this.log = new RunLog(log);
    box.append(log, this.ended);
    this.endButton = makeSureButton(TEXTS.endRun, () => this.send({ t: "end", run: this.chosen.value }));
    this.endButton.id = "run-end";
    this.head.append(this.chosen, this.endButton);
    RUNS.onState.push((state) => this.show(state));
    RUNS.onLog.push((part) => this.log.take(part));
  }

  /** @param {import("./run_socket.js").RunState | null} state */
  show(state) {
    const runs = state?.runs ?? [];
    this.offer(runs);
    const run = runs.find((each) => each.run === this.chosen.value);
    this.head.hidden = this.table.hidden = !run;
    this.log.list.parentElement?.toggleAttribute("hidden", !run);
    this.endButton.hidden = !this.mayDrive;
    this.note.textContent = !state ? TEXTS.connecting : run ? describeRun(run) : TEXTS.noRuns;
    this.note.hidden = !this.note.textContent;
    this.showEnded(state?.ended ?? []);
    if (!run) return;
    this.log.choose(run.run);
    this.log.showNodes(run.nodes.map((node) => node.name));
    for (const node of run.nodes) this.showNode(run, node);
    for (const row of [...this.body.rows]) {
      if (!run.nodes.some((node) => row.id === rowId(run, node))) row.remove();
    }
  }

  /** Offer runs; the latest is chosen until the user chooses another. @param {Run[]} runs */
  offer(runs) {
    const key = runs.map((each) => each.run).join();
    if (key === this.drawn) return;
    const known = this.drawn.split(",");
    this.drawn = key;
    const before = this.chosen.value;
    this.chosen.replaceChildren(...runs.map((each) => new Option(TEXTS.runName(each.title, each.started), each.run)));
    const latest = runs.at(-1)?.run ?? "";
    this.chosen.value = runs.some((each) => each.run === before) && known.includes(latest) ? before : latest;
  }

  /** Show a node; its row and its buttons stay, so that neither focus nor a press is lost. @param {Run} run @param {RunNode} node */
  showNode(run, node) {
    const id = rowId(run, node);
    let row = /** @type {HTMLTableRowElement | null} */ (document.getElementById(id));
    if (!row) {
      row = this.body.insertRow();
      row.id = id;
      const head = make("th");
      showName(head, node.name.replace(/^\//, ""));
      head.scope = "row";
      row.append(head, ...[1, 2, 3].map(() => make("td")));
      if (this.mayDrive && !node.core) {
        const ask = (/** @type {string} */ action) => this.send({ t: "node", run: run.run, node: node.name, do: action });
        const restart = makeButton(TEXTS.restart, () => ask("restart"), TEXTS.restartNode(node.name));
        restart.className = "restart";
        const stop = makeButton(TEXTS.stopNode, () => ask(row?.dataset.state === "ended" ? "start" : "stop"));
        stop.className = "stop";
        row.cells[3].append(restart, stop);
      }
    }
    row.dataset.state = node.state;
    row.dataset.mood = moodOf(node);
    setText(row.cells[1], describeNode(node));
    const used = node.cpu === null || node.memory === null ? "" : TEXTS.usage(node.cpu, node.memory);
    setText(row.cells[2], used);
    const [, stop] = row.cells[3].querySelectorAll("button");
    if (stop) {
      setText(stop, node.state === "ended" ? TEXTS.startNode : TEXTS.stopNode);
      stop.ariaLabel = node.state === "ended" ? TEXTS.startNodeOf(node.name) : TEXTS.stopNodeOf(node.name);
    }
  }

  /** @param {import("./run_socket.js").EndedRun[]} ended */
  showEnded(ended) {
    const key = ended.map((each) => each.run).join();
    if (key === this.ended.dataset.key) return;
    this.ended.dataset.key = key;
    this.ended.replaceChildren();
    if (ended.length) this.ended.append(make("h3", TEXTS.endedRuns));
    for (const each of ended) {
      const box = make("details");
      box.append(make("summary", TEXTS.endedRun(each.title, each.ended, each.exit_code, each.cause)));
      box.append(make("pre", each.lines.join("\n") || TEXTS.noLines));
      this.ended.append(box);
    }
  }

  /** @param {Record<string, unknown>} message */
  async send(message) {
    const answer = await RUNS.request(message);
    if (!answer) this.say(TEXTS.noAnswer);
    else if (!answer.ok) this.say(answer.text);
  }
}

/** @param {Run} run @param {RunNode} node */
const rowId = (run, node) => `node-${run.run}${node.name}`;

/** Leave what is the same alone: it may be selected. @param {Element} element @param {string} text */
function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** @param {Run} run */
function describeRun(run) {
  if (run.stopping !== null) return TEXTS.runEnds(run.stopping);
  return run.lost === null ? "" : TEXTS.robotLost(run.lost);
}

/** @param {RunNode} node */
function moodOf(node) {
  if (node.state === "running") return node.ready || node.core ? "up" : "busy";
  if (node.state === "starting" || node.state === "stopping") return "busy";
  const died = node.signal !== null || (node.exit_code ?? 0) !== 0 || (node.reason !== "" && !node.held);
  return died && !node.held ? "failed" : node.restart_in !== null ? "busy" : "idle";
}

/** @param {RunNode} node */
function describeNode(node) {
  const words = /** @type {string[]} */ ([]);
  if (node.state === "running") words.push(node.ready || node.core ? TEXTS.nodeStates.up : TEXTS.nodeStates.running);
  else if (node.held && node.state === "ended") words.push(TEXTS.nodeStates.held);
  else words.push(TEXTS.nodeStates[/** @type {"ended"} */ (node.state)] ?? node.state);
  if (node.state !== "running" && !node.held) {
    if (node.signal !== null) words.push(TEXTS.bySignal(node.signal));
    else if (node.exit_code) words.push(TEXTS.withCode(node.exit_code));
  }
  if (node.restart_in !== null) words.push(TEXTS.restartIn(node.restart_in));
  if (node.restarts) words.push(TEXTS.restarted(node.restarts));
  if (node.reason && !node.held) words.push(node.reason);
  else if (node.state === "running" && !node.core) words.push(...node.missing);
  return words.join(", ");
}
