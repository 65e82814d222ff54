// @ts-check
/** Topics with their rates, messages of one of them, services and parameters. */

import { make, makeButton, makeNote, showName } from "../elements.js";
import { DATA } from "./data_socket.js";
import { ParameterView } from "./parameter_view.js";
import { ServiceView } from "./service_view.js";
import { DATA_TEXTS } from "./texts.js";
import { TopicView } from "./topic_view.js";

/** A view of the panel: topics, services or parameters. @typedef {{box: HTMLElement, show: (open: boolean) => void}} View */

const MOST_MEASURED = 24; // see ur.web.wire.data_requests

/** @type {import("./data_panels.js").Maker} */
export function makeTopicPanel(box, page) {
  const panel = new TopicPanel(box, page.mayDrive);
  Object.assign(page, { topicPanel: panel });
  return { show: (open) => panel.show(open) };
}

class TopicPanel {
  /** @param {HTMLElement} box @param {boolean} mayDrive */
  constructor(box, mayDrive) {
    this.note = makeNote();
    this.opened = false;
    /** @type {Record<string, View>} */
    this.views = {
      topics: new TopicList(mayDrive),
      services: new ServiceView(mayDrive),
      parameters: new ParameterView(mayDrive),
    };
    this.chosen = "topics";
    const bar = make("div", "", "row tabs");
    bar.role = "group";
    bar.ariaLabel = DATA_TEXTS.kinds;
    /** @type {Record<string, HTMLButtonElement>} */
    this.tabs = {};
    for (const name of Object.keys(this.views)) {
      this.tabs[name] = makeButton(DATA_TEXTS[/** @type {"topics"} */ (name)], () => this.choose(name));
      this.tabs[name].id = `data-${name}`;
      bar.append(this.tabs[name]);
    }
    box.append(bar, this.note, ...Object.values(this.views).map((view) => view.box));
    DATA.on("state", () => this.refresh());
    this.refresh();
  }

  /** @param {boolean} open */
  show(open) {
    this.opened = open;
    DATA.use(open);
    this.views[this.chosen].show(open);
    this.refresh();
  }

  /** @param {string} name */
  choose(name) {
    if (name !== this.chosen) this.views[this.chosen].show(false);
    const before = this.chosen;
    this.chosen = name;
    if (name !== before) this.views[name].show(this.opened);
    this.refresh();
  }

  refresh() {
    this.note.textContent = DATA.end === "up" ? "" : DATA.end === "starting" ? DATA_TEXTS.notConnected : DATA_TEXTS.connecting;
    this.note.hidden = !this.note.textContent;
    for (const [name, view] of Object.entries(this.views)) {
      view.box.hidden = name !== this.chosen;
      this.tabs[name].setAttribute("aria-pressed", String(name === this.chosen));
    }
  }
}

/** All topics; those in sight are measured. @implements {View} */
class TopicList {
  /** @param {boolean} mayDrive */
  constructor(mayDrive) {
    this.opened = false;
    this.box = make("div");
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
    this.view = new TopicView(mayDrive, () => this.openTopic(""));
    this.list.append(this.view.makeNew());
    this.box.append(this.list, this.view.box);
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
  }

  /** @param {boolean} open */
  show(open) {
    this.opened = open;
    this.ask();
    this.view.show(open);
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
