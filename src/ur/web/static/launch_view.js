// @ts-check
/** What a launch file includes and starts, as a picture, and why it starts each node. */

import { make, makeButton } from "./elements.js";
import { TEXTS } from "./texts.js";

export class LaunchView {
  /** @param {string} program @param {() => Record<string, string>} values of its arguments */
  constructor(program, values) {
    this.program = program;
    this.values = values;
    this.box = make("section", "", "launch");
    this.box.hidden = true;
    this.note = make("p");
    this.note.role = "status";
    this.picture = make("div", "", "picture");
    this.picture.tabIndex = 0; // scrolled by keys
    this.nodes = make("ul");
    this.box.append(this.note, this.picture, this.nodes);
  }

  async load() {
    this.box.hidden = false;
    this.note.textContent = TEXTS.loading;
    this.picture.replaceChildren();
    this.nodes.replaceChildren();
    const values = this.values();
    const [picture, nodes] = await Promise.all([this.ask("graph", values), this.ask("nodes", values)]);
    const failed = [picture, nodes].find((each) => !each.ok);
    this.note.textContent = failed ? failed.text : TEXTS.startsNodes;
    if (picture.ok) this.show(picture.text);
    if (!nodes.ok) return;
    /** @type {string[]} */
    const names = JSON.parse(nodes.text);
    this.nodes.replaceChildren(...names.map((name) => this.makeRow(name, values)));
    this.box.scrollIntoView(); // it is below the form, which may fill the panel
  }

  /** Show a picture as an image: no script in it could run. @param {string} svg */
  show(svg) {
    const image = make("img");
    image.alt = TEXTS.graphOf(this.program);
    const address = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
    image.addEventListener("load", () => URL.revokeObjectURL(address));
    image.src = address;
    this.picture.replaceChildren(image);
  }

  /** @param {string} name @param {Record<string, string>} values */
  makeRow(name, values) {
    const row = make("li");
    const why = make("pre");
    why.hidden = true;
    const button = makeButton(TEXTS.why, () => this.explain(name, values, button, why), TEXTS.whyNode(name));
    button.ariaExpanded = "false";
    row.append(make("span", name), button, why);
    return row;
  }

  /** @param {string} name @param {Record<string, string>} values @param {HTMLButtonElement} button @param {HTMLElement} why */
  async explain(name, values, button, why) {
    why.hidden = !why.hidden;
    button.ariaExpanded = String(!why.hidden);
    if (why.hidden || why.textContent) return;
    why.textContent = TEXTS.loading;
    why.textContent = (await this.ask("explain", values, name)).text;
  }

  /** @param {string} what @param {Record<string, string>} values @param {string} [node] */
  async ask(what, values, node) {
    const query = new URLSearchParams({ program: this.program, arguments: JSON.stringify(values) });
    if (node) query.set("node", node);
    const answer = await fetch(`/api/${what}?${query}`).catch(() => null);
    return { ok: answer?.ok ?? false, text: answer ? await answer.text() : TEXTS.noAnswer };
  }
}
