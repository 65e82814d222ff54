// @ts-check
/** Services, and a form to call one. */

import { make, makeNote } from "../elements.js";
import { DATA } from "./data_socket.js";
import { NameList } from "./name_list.js";
import { DATA_TEXTS } from "./texts.js";
import { FieldError, ValueForm } from "./value_form.js";

export class ServiceView {
  /** @param {boolean} mayDrive */
  constructor(mayDrive) {
    this.list = new NameList("services", "service", (name, box) => this.open(name, box, mayDrive));
    this.box = this.list.box;
  }

  /** @param {boolean} open */
  show(open) {
    this.list.show(open);
  }

  /** @param {string} service @param {HTMLElement} box @param {boolean} mayDrive */
  async open(service, box, mayDrive) {
    const note = makeNote(DATA_TEXTS.loading);
    const facts = make("p");
    const form = make("form", "", "stacked");
    const text = make("pre");
    text.hidden = true;
    box.append(facts, form, note, text);
    const answer = await DATA.request({ t: "describe_service", service });
    note.textContent = answer?.text ?? DATA_TEXTS.noAnswer;
    if (!answer?.ok) return;
    facts.textContent = answer.kind ?? "";
    if (!mayDrive) {
      note.textContent = DATA_TEXTS.mayNot;
      return;
    }
    const fields = new ValueForm(answer.value, "call");
    const button = make("button", DATA_TEXTS.call, "start");
    form.append(fields.box, button);
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      try {
        const value = fields.read();
        note.textContent = DATA_TEXTS.calling;
        button.disabled = true;
        const reported = await DATA.request({ t: "call", service, value });
        button.disabled = false;
        note.textContent = reported?.ok ? "" : (reported?.text ?? DATA_TEXTS.noAnswer);
        text.textContent = reported?.ok ? reported.text : "";
        text.hidden = !reported?.ok;
      } catch (problem) {
        if (!(problem instanceof FieldError)) throw problem;
        note.textContent = `${problem.message}: ${DATA_TEXTS.value}`;
      }
    });
  }
}
