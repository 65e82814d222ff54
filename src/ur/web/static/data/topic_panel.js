// @ts-check
/** Topics with their rates, and messages of one of them. */

import { make, makeButton, makeNote, showName } from "../elements.js";
import { DATA } from "./data_socket.js";
import { DATA_TEXTS } from "./texts.js";
import { TopicView } from "./topic_view.js";

const MOST_MEASURED = 24; // see ur.web.wire.data_requests

/** @type {import("./data_panels.js").Maker} */
export function makeTopicPanel(box, page) {
  const panel = new TopicPanel(box);
  Object.assign(page, { topicPanel: panel });
  return { show: (open) => panel.show(open) };
}

/** All topics; those in sight are measured. */
class TopicPanel {
  /** @param {HTMLElement} box */
  constructor(box) {
    this.note = makeNote();
    this.opened = false;
    this.list = make("div");
    this.filter = make("input");
    this.filter.ariaLabel = this.filter.placeholder = DATA_TEXTS.filter;
    this.filter.id = "topic-filter";
    this.filter.addEventListener("input", () => this.draw());
    this.found = makeNote();
    const row = make("div", "", "row");
    row.append(this.filter, this.found);
    const table = make("table", "", "topics");
    table.append(make("caption", DATA_TEXTS.topics));
    const head = make("tr");
    head.append(...DATA_TEXTS.columns.map((text) => Object.assign(make("th", text), { scope: "col" })));
    const thead = make("thead");
    thead.append(head);
    this.body = make("tbody");
    table.append(thead, this.body);
    this.list.append(row, table);
    this.view = new TopicView(() => this.openTopic(""));
    box.append(this.note, this.list, this.view.box);
    /** Rows of the table by topic. @type {Map<string, HTMLTableRowElement>} */
    this.rows = new Map();
    /** @type {any[][]} */
    this.topics = [];
    /** @type {Set<string>} */
    this.seen = new Set();
    this.observer = new IntersectionObserver((entries) => this.see(entries));
    DATA.on("topics", ({ rows }) => {
      this.topics = rows;
      this.draw();
    });
    DATA.on("state", () => this.refresh());
    this.refresh();
  }

  /** @param {boolean} open */
  show(open) {
    this.opened = open;
    DATA.use(open);
    this.ask();
    this.refresh();
  }

  refresh() {
    this.note.textContent = DATA.end === "up" ? "" : DATA.end === "starting" ? DATA_TEXTS.notConnected : DATA_TEXTS.connecting;
    this.note.hidden = !this.note.textContent;
  }

  ask() {
    const names = [...this.seen].slice(0, MOST_MEASURED);
    const echo = this.view.topic;
    DATA.show({ topics: this.opened && !echo ? names : undefined, echo: (this.opened && echo) || undefined });
  }

  /** Show a topic, or the list. @param {string} name */
  openTopic(name) {
    const found = this.topics.find(([each]) => each === name);
    this.view.open(found ? { name, kind: found[1], publishers: found[2], subscribers: found[3] } : null);
    this.list.hidden = Boolean(found);
    this.ask();
  }

  /** @param {IntersectionObserverEntry[]} entries */
  see(entries) {
    for (const entry of entries) {
      const name = /** @type {HTMLElement} */ (entry.target).dataset.topic ?? "";
      if (entry.isIntersecting) this.seen.add(name);
      else this.seen.delete(name);
    }
    this.ask();
  }

  draw() {
    const wanted = this.filter.value.trim().toLowerCase();
    const shown = this.topics.filter(([name, kind]) => `${name} ${kind}`.toLowerCase().includes(wanted));
    const names = new Set(shown.map(([name]) => name));
    for (const [name, row] of this.rows) {
      if (names.has(name)) continue;
      this.observer.unobserve(row);
      row.remove();
      this.seen.delete(name);
      this.rows.delete(name);
    }
    shown.forEach((topic, index) => {
      const row = this.rows.get(topic[0]) ?? this.makeRow(topic[0]);
      if (this.body.children[index] !== row) this.body.insertBefore(row, this.body.children[index] ?? null);
      const [, kind, publishers, subscribers, rate, bandwidth] = topic;
      showName(row.cells[1], kind);
      [DATA_TEXTS.rate(rate), DATA_TEXTS.bandwidth(bandwidth)].forEach((text, column) => {
        const cell = row.cells[column + 2];
        if (cell.textContent !== text) cell.textContent = text;
      });
      row.title = DATA_TEXTS.ends(publishers, subscribers);
    });
    const count = this.topics.length ? DATA_TEXTS.count(shown.length, this.topics.length) : DATA_TEXTS.noneYet;
    if (this.found.textContent !== count) this.found.textContent = count;
  }

  /** @param {string} name */
  makeRow(name) {
    const row = make("tr");
    row.dataset.topic = name;
    const head = make("th");
    head.scope = "row";
    const button = makeButton("", () => this.openTopic(name));
    button.className = "go";
    showName(button, name);
    head.append(button);
    row.append(head, make("td"), make("td", "", "number"), make("td", "", "number"));
    this.rows.set(name, row);
    this.observer.observe(row);
    return row;
  }
}
