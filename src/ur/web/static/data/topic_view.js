// @ts-check
/** One topic: its newest message. */

import { make, makeButton } from "../elements.js";
import { DATA } from "./data_socket.js";
import { DATA_TEXTS } from "./texts.js";

/** @typedef {{name: string, kind: string, publishers: number, subscribers: number}} Topic */

export class TopicView {
  /** @param {() => void} onBack */
  constructor(onBack) {
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
    this.box.append(row, this.facts, this.state, this.text);
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
  }

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
}
