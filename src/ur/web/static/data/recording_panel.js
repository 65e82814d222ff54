// @ts-check
/** What happened, as the black box saves it; recordings of topics, and the replay that runs. */

import { make, makeButton, makeNote, makeSureButton, replaceRows } from "../elements.js";
import { ReplayView } from "./replay_view.js";
import { DATA_TEXTS } from "./texts.js";

/**
 * @typedef {{name: string, size: number, started: number, part: number, cut: boolean}} Recorded
 * @typedef {{running: {size: number, seconds: number, topics: number} | null, end: string, files?: Recorded[]}} State
 */

const EVERY = 2000; // ms between two looks at the state
const MOST = 40; // topics, see ur.web.server.recordings.recording_pages

/** @type {import("./data_panels.js").Maker} */
export function makeRecordingPanel(box, page) {
  const panel = new RecordingPanel(box, page);
  page.recordings = panel;
  let timer = 0;
  return {
    show: (open) => {
      clearInterval(timer);
      if (!open) return;
      panel.load();
      timer = setInterval(() => panel.load(), EVERY);
    },
  };
}

export class RecordingPanel {
  /** @param {HTMLElement} box @param {import("../main.js").Page} page */
  constructor(box, page) {
    this.page = page;
    this.happened = makeButton(DATA_TEXTS.saveHappened, () => this.saveHappened());
    this.happenedAnswer = makeNote();
    this.happenedAnswer.hidden = true;
    const replay = make("section");
    this.replay = new ReplayView(replay, page.mayDrive);
    const happened = make("section");
    happened.append(make("h3", DATA_TEXTS.happened), make("p", DATA_TEXTS.happenedHelp), this.happened, this.happenedAnswer);
    box.append(replay);
    if (page.mayDrive) box.append(happened, make("h3", DATA_TEXTS.record));
    this.note = makeNote(DATA_TEXTS.connecting);
    this.problem = makeNote();
    this.problem.className = "problem";
    this.problem.hidden = true;
    this.end = make("p");
    this.start = makeButton(DATA_TEXTS.startRecording, () => this.begin());
    this.stop = makeButton(DATA_TEXTS.stopRecording, () => this.change("stop", {}));
    /** Topics that are ticked. @type {Set<string>} */
    this.chosen = new Set();
    this.topics = make("ul");
    this.choice = make("details");
    this.choice.append(make("summary", DATA_TEXTS.chooseTopics), this.topics);
    this.choice.addEventListener("toggle", () => this.choice.open && this.listTopics());
    this.list = make("ul");
    this.none = make("p", DATA_TEXTS.noRecordings);
    /** What the list shows. */
    this.shown = "";
    const row = make("div", "", "row");
    row.append(this.start, this.stop);
    box.append(this.note, this.end, this.problem);
    if (page.mayDrive) box.append(row, make("p", DATA_TEXTS.recordingHelp), this.choice, make("h3", DATA_TEXTS.finished), this.none, this.list);
  }

  async load() {
    this.replay.load();
    const answer = await fetch("/api/recordings").catch(() => null);
    if (!answer?.ok) return this.say(this.note, answer ? await answer.text() : DATA_TEXTS.noAnswer);
    /** @type {State} */
    const { running, end, files } = await answer.json();
    this.say(this.note, running ? DATA_TEXTS.recording(running.size, running.seconds, running.topics) : DATA_TEXTS.nothingRecorded);
    this.say(this.end, end && DATA_TEXTS.lastRecording(end));
    this.start.disabled = Boolean(running);
    this.stop.disabled = !running;
    const shown = JSON.stringify(files ?? []);
    if (shown === this.shown) return; // a button that asks whether it is sure keeps asking
    this.shown = shown;
    this.none.hidden = Boolean(files?.length);
    replaceRows(this.list, (files ?? []).map((file) => this.makeRow(file)));
  }

  saveHappened() {
    if (!this.page.drive?.send({ t: "save_recording" })) return this.page.sayNotSent();
    this.happened.disabled = true;
    this.say(this.happenedAnswer, DATA_TEXTS.savingHappened);
  }

  /** Take the answer of the black box. @param {{place?: string, why?: string}} answer */
  answered({ place, why = "" }) {
    this.happened.disabled = false;
    this.say(this.happenedAnswer, place ? DATA_TEXTS.happenedSaved(place) : DATA_TEXTS.happenedNotSaved(why));
  }

  /** @param {Recorded} file */
  makeRow(file) {
    const text = DATA_TEXTS.recorded(file);
    const link = make("a", DATA_TEXTS.download);
    link.href = `/api/recordings/file?id=${encodeURIComponent(file.name)}`;
    link.download = file.name;
    link.ariaLabel = DATA_TEXTS.of(DATA_TEXTS.download, text);
    const row = make("li");
    row.append(make("span", text, "grow"), link, makeSureButton(DATA_TEXTS.delete, () => this.change("delete", { id: file.name }), DATA_TEXTS.of(DATA_TEXTS.delete, text)));
    return row;
  }

  async listTopics() {
    const answer = await fetch("/api/recordings/topics").catch(() => null);
    if (!answer?.ok) return this.say(this.problem, answer ? await answer.text() : DATA_TEXTS.noAnswer);
    this.say(this.problem, "");
    /** @type {{name: string, kind: string}[]} */
    const topics = await answer.json();
    const names = new Set(topics.map(({ name }) => name));
    this.chosen = new Set([...this.chosen].filter((name) => names.has(name)));
    this.topics.replaceChildren(...topics.map((topic) => this.makeTopic(topic)));
  }

  /** @param {{name: string, kind: string}} topic */
  makeTopic({ name, kind }) {
    const box = make("input");
    box.type = "checkbox";
    box.checked = this.chosen.has(name);
    box.addEventListener("change", () => {
      const many = box.checked && this.chosen.size >= MOST;
      if (many) box.checked = false;
      else if (box.checked) this.chosen.add(name);
      else this.chosen.delete(name);
      this.say(this.problem, many ? DATA_TEXTS.tooMany(MOST) : "");
    });
    const label = make("label");
    label.append(box, make("span", name, "grow"), make("small", kind));
    const row = make("li");
    row.append(label);
    return row;
  }

  begin() {
    const topics = this.choice.open && this.chosen.size ? [...this.chosen] : null;
    return this.change("start", { topics });
  }

  /** @param {"start" | "stop" | "delete"} what @param {Record<string, unknown>} value */
  async change(what, value) {
    const answer = await fetch(`/api/recordings/${what}`, { method: "POST", body: JSON.stringify(value) }).catch(() => null);
    this.say(this.problem, !answer ? DATA_TEXTS.noAnswer : answer.ok ? "" : await answer.text());
    await this.load();
  }

  /** @param {HTMLElement} note @param {string} text */
  say(note, text) {
    if (note.textContent !== text) note.textContent = text;
    note.hidden = !text;
  }
}
