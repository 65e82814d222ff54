// @ts-check
/** One topic: its newest message, and a form to publish one. */

import { make, makeButton, makeNote } from "../elements.js";
import { DATA } from "./data_socket.js";
import { DATA_TEXTS } from "./texts.js";
import { FieldError, ValueForm } from "./value_form.js";

/** @typedef {{name: string, kind: string, publishers: number, subscribers: number}} Topic */

export class TopicView {
  /** @param {boolean} mayDrive @param {() => void} onBack */
  constructor(mayDrive, onBack) {
    this.mayDrive = mayDrive;
    this.topic = "";
    this.paused = false;
    this.box = make("section", "", "one");
    this.box.hidden = true;
    this.title = make("h3");
    this.facts = make("p");
    this.state = make("p");
    this.text = make("pre", "", "message");
    this.text.tabIndex = 0; // so that keys scroll it
    this.text.id = "topic-message";
    this.text.ariaLabel = DATA_TEXTS.message(0, 0);
    this.pause = makeButton(DATA_TEXTS.pause, () => this.setPaused(!this.paused));
    const row = make("div", "", "row");
    row.append(makeButton(DATA_TEXTS.back, onBack), this.title, this.pause);
    this.publisher = new Publisher();
    this.box.append(row, this.facts, this.state, this.text, mayDrive ? this.publisher.box : make("p", DATA_TEXTS.mayNot));
    DATA.on("echo", (message) => this.take(message));
  }

  /** @param {Topic | null} topic */
  open(topic) {
    this.topic = topic?.name ?? "";
    this.box.hidden = !topic;
    this.text.textContent = "";
    this.setPaused(false);
    if (!topic) return;
    this.title.textContent = topic.name;
    this.text.ariaLabel = topic.name;
    this.facts.textContent = `${topic.kind || "?"}, ${DATA_TEXTS.ends(topic.publishers, topic.subscribers)}`;
    this.state.textContent = DATA_TEXTS.waiting;
    this.publisher.open(topic.name, topic.kind);
  }

  /** @param {boolean} _open */
  show(_open) {}

  /** @param {boolean} paused */
  setPaused(paused) {
    this.paused = paused;
    this.pause.textContent = paused ? DATA_TEXTS.resume : DATA_TEXTS.pause;
    this.pause.setAttribute("aria-pressed", String(paused));
  }

  /** @param {{topic: string, size: number, count: number, lines?: string[], problem?: string}} message */
  take({ topic, size, count, lines, problem }) {
    if (topic !== this.topic || this.paused) return;
    this.state.textContent = `${DATA_TEXTS.message(size, count)} ${problem ?? ""}`.trim();
    this.text.textContent = lines?.join("\n") ?? "";
  }

  /** A form for a topic that is not in the list. */
  makeNew() {
    const box = make("details");
    box.hidden = !this.mayDrive;
    box.append(make("summary", DATA_TEXTS.newTopic));
    const [name, kind] = [make("input"), make("input")];
    name.placeholder = name.ariaLabel = DATA_TEXTS.topicName;
    kind.placeholder = kind.ariaLabel = DATA_TEXTS.typeHelp;
    const form = make("form", "", "row");
    form.append(name, kind, make("button", DATA_TEXTS.describe));
    const publisher = new Publisher();
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      publisher.open(name.value.trim(), kind.value.trim());
      publisher.load();
    });
    box.append(form, publisher.box);
    return box;
  }
}

let forms = 0;

/** The form of a message. */
class Publisher {
  constructor() {
    this.box = make("details", "", "publish");
    this.name = this.kind = "";
    this.note = makeNote();
    this.form = make("form", "", "stacked");
    /** @type {ValueForm | null} */
    this.fields = null;
    this.box.append(make("summary", DATA_TEXTS.publish), make("p", DATA_TEXTS.publishHelp), this.form, this.note);
    this.box.addEventListener("toggle", () => this.box.open && !this.fields && this.load());
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.publish();
    });
  }

  /** @param {string} name @param {string} kind */
  open(name, kind) {
    [this.name, this.kind, this.fields] = [name, kind, null];
    this.form.replaceChildren();
    this.note.textContent = "";
    this.box.open = false;
  }

  async load() {
    const { kind } = this;
    this.note.textContent = DATA_TEXTS.loading;
    const answer = await DATA.request({ t: "describe", kind });
    if (kind !== this.kind) return;
    this.note.textContent = answer?.text ?? DATA_TEXTS.noAnswer;
    if (!answer?.ok) return;
    forms += 1;
    this.fields = new ValueForm(answer.value, `message-${forms}`);
    this.form.replaceChildren(this.fields.box, make("button", DATA_TEXTS.publish, "start"));
    this.box.open = true;
  }

  async publish() {
    if (!this.fields) return;
    try {
      const value = this.fields.read();
      const answer = await DATA.request({ t: "publish", topic: this.name, kind: this.kind, value });
      this.note.textContent = answer?.text ?? DATA_TEXTS.noAnswer;
    } catch (problem) {
      if (!(problem instanceof FieldError)) throw problem;
      this.note.textContent = `${problem.message}: ${DATA_TEXTS.value}`;
    }
  }
}
