// @ts-check
/** The programs, each with its arguments as a form, and with what its launch file starts and why. */

import { fillForm, readForm } from "./argument_form.js";
import { make, makeButton } from "./elements.js";
import { LaunchView } from "./launch_view.js";
import { RUNS } from "./run_socket.js";
import { TEXTS } from "./texts.js";

/** @typedef {import("./argument_form.js").Argument} Argument */
/** @typedef {{name: string, summary: string, lack: string, problem: string, file: boolean, arguments: Argument[]}} Program */

/** @type {import("./panels.js").Panel} */
export const PROGRAM_PANEL = {
  name: "programs",
  label: TEXTS.programs,
  icon: "M4 4h6v6H4zM14 4h6v6h-6zM4 14h6v6H4zM15 14l5 3-5 3z",
  wide: true,
  make: (box, page) => {
    const panel = new ProgramPanel(box, page);
    return {
      show: (open) => {
        RUNS.use(open);
        if (open) panel.load();
      },
    };
  },
};

class ProgramPanel {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page */
  constructor(box, page) {
    this.page = page;
    this.note = make("p");
    this.note.role = "status";
    this.list = make("div", "", "programs");
    this.shown = "";
    box.append(this.note, this.list);
  }

  async load() {
    if (!this.shown) this.note.textContent = TEXTS.loading;
    const answer = await fetch("/api/programs").catch(() => null);
    if (!answer?.ok) {
      this.note.textContent = answer ? await answer.text() : TEXTS.noAnswer;
      return;
    }
    const text = await answer.text();
    this.note.textContent = "";
    if (text === this.shown) return; // what is typed stays
    this.shown = text;
    /** @type {Program[]} */
    const programs = JSON.parse(text);
    this.list.replaceChildren(...programs.map((program) => this.makeProgram(program)));
  }

  /** @param {Program} program */
  makeProgram(program) {
    const box = make("details");
    box.name = "program"; // one is open at a time
    box.id = `program-${program.name.replace("/", "-")}`;
    const title = make("summary");
    title.append(make("b", program.name), ` ${program.summary}`);
    if (program.lack) title.append(make("span", ` ${program.lack}`, "lack"));
    box.append(title);
    box.addEventListener("toggle", () => {
      if (box.open && box.childElementCount === 1) this.fill(box, program);
    });
    return box;
  }

  /** @param {HTMLDetailsElement} box @param {Program} program */
  fill(box, program) {
    if (program.problem) box.append(make("p", program.problem, "problem"));
    const form = make("form", "", "arguments");
    const row = make("div", "", "row");
    const start = make("button", TEXTS.start, "start");
    const answer = make("p", "", "problem");
    answer.role = "status";
    answer.hidden = true;
    row.append(start);
    start.hidden = !this.page.mayDrive;
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.start(program, form, start, answer);
    });
    box.append(form);
    if (program.file) {
      const view = new LaunchView(program.name, () => readForm(form));
      row.append(makeButton(TEXTS.whatItStarts, () => view.load()));
      box.append(view.box);
    }
    form.append(row, answer);
    fillForm(form, program.arguments, box.id);
  }

  /** @param {Program} program @param {HTMLFormElement} form @param {HTMLButtonElement} button @param {HTMLElement} note */
  async start(program, form, button, note) {
    button.disabled = true;
    note.hidden = false;
    note.textContent = TEXTS.startingProgram;
    const answer = await RUNS.request({ t: "start", program: program.name, arguments: readForm(form) });
    button.disabled = false;
    note.textContent = answer ? answer.text : TEXTS.noAnswer;
    if (!answer?.ok) return;
    note.hidden = true;
    this.page.say(TEXTS.started(program.name));
    if (this.page.panels.open === "programs") this.page.panels.toggle("runs");
  }
}
