// @ts-check
/** Parameters, their values, and a form to set one. */

import { make, makeNote } from "../elements.js";
import { DATA } from "./data_socket.js";
import { NameList } from "./name_list.js";
import { DATA_TEXTS } from "./texts.js";

export class ParameterView {
  /** @param {boolean} mayDrive */
  constructor(mayDrive) {
    this.list = new NameList("parameters", "parameter", (name, box) => this.open(name, box, mayDrive));
    this.box = this.list.box;
  }

  /** @param {boolean} open */
  show(open) {
    this.list.show(open);
  }

  /** @param {string} name @param {HTMLElement} box @param {boolean} mayDrive */
  async open(name, box, mayDrive) {
    const note = makeNote(DATA_TEXTS.loading);
    box.append(note);
    const answer = await DATA.request({ t: "parameter", name });
    note.textContent = answer?.text ?? DATA_TEXTS.noAnswer;
    if (!answer?.ok) return;
    const form = make("form", "", "stacked");
    const text = make("textarea");
    text.id = "parameter-value";
    text.ariaLabel = `${name}: ${DATA_TEXTS.value}`;
    text.value = answer.value;
    text.rows = Math.min(20, 1 + answer.value.split("\n").length);
    text.readOnly = !mayDrive || !answer.whole;
    form.append(text);
    if (!answer.whole) note.textContent = DATA_TEXTS.whole;
    else if (!mayDrive) note.textContent = DATA_TEXTS.mayNot;
    else form.append(make("button", DATA_TEXTS.set, "start"));
    box.prepend(form);
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      const reported = await DATA.request({ t: "set", name, value: text.value });
      note.textContent = reported?.text ?? DATA_TEXTS.noAnswer;
    });
  }
}
