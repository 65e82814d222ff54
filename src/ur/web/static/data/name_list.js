// @ts-check
/** A list of names with a filter; one of them is opened at a time. */

import { make, makeButton, makeNote, replaceRows } from "../elements.js";
import { DATA } from "./data_socket.js";
import { DATA_TEXTS } from "./texts.js";

const MOST = 300; // rows

export class NameList {
  /**
   * @param {string} request that lists the names @param {string} prefix of ids
   * @param {(name: string, box: HTMLElement) => void} fill fills the box of a name that is opened
   */
  constructor(request, prefix, fill) {
    this.request = request;
    this.fill = fill;
    this.opened = false;
    /** @type {string[]} */
    this.names = [];
    this.box = make("div");
    this.box.hidden = true;
    this.filter = make("input");
    this.filter.id = `${prefix}-filter`;
    this.filter.ariaLabel = this.filter.placeholder = DATA_TEXTS.filter;
    this.filter.addEventListener("input", () => this.draw());
    this.note = makeNote();
    this.list = make("ul");
    this.one = make("section", "", "one");
    const row = make("div", "", "row");
    row.append(this.filter, this.note);
    this.main = make("div");
    this.main.append(row, this.list);
    this.box.append(this.main, this.one);
    DATA.on("state", (end) => this.opened && end === "up" && this.load());
  }

  /** @param {boolean} open */
  show(open) {
    this.opened = open;
    if (open) this.load();
  }

  async load() {
    const answer = await DATA.request({ t: this.request });
    if (!answer) return;
    this.names = answer.ok ? answer.value : [];
    this.draw();
    if (!answer.ok) this.note.textContent = answer.text;
  }

  draw() {
    const wanted = this.filter.value.trim().toLowerCase();
    const shown = this.names.filter((name) => name.toLowerCase().includes(wanted));
    this.note.textContent = this.names.length ? DATA_TEXTS.count(shown.length, this.names.length) : DATA_TEXTS.noneYet;
    replaceRows(this.list, shown.slice(0, MOST).map((name) => this.makeRow(name)));
  }

  /** @param {string} name */
  makeRow(name) {
    const row = make("li");
    const button = makeButton(name, () => this.open(name));
    button.className = "go";
    row.append(button);
    return row;
  }

  /** @param {string} name "" for the list */
  open(name) {
    this.main.hidden = Boolean(name);
    this.one.replaceChildren();
    if (!name) return;
    const row = make("div", "", "row");
    row.append(makeButton(DATA_TEXTS.back, () => this.open("")), make("h3", name));
    const inner = make("div");
    this.one.append(row, inner);
    this.fill(name, inner);
  }
}
