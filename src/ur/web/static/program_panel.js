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

const IN_THE_WAY = "[node-runs-already]"; // the rule, which an error of ur ends with
const ENDS_WITHIN = 30000; // ms

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
    const first = Object.keys(TEXTS.programNames).flatMap((name) => programs.filter((each) => each.name === name));
    const others = make("details", "", "others");
    others.append(make("summary", TEXTS.otherPrograms));
    others.append(...programs.filter((each) => !first.includes(each)).map((program) => this.makeProgram(program)));
    others.open = first.length === 0;
    this.list.replaceChildren(...first.map((program) => this.makeProgram(program)), others);
  }

  /** @param {Program} program */
  makeProgram(program) {
    const box = make("details");
    box.name = "program"; // one is open at a time
    box.id = `program-${program.name.replace("/", "-")}`;
    const title = make("summary");
    const word = TEXTS.programNames[program.name];
    title.append(make("b", word ?? program.name), word ? ` (${program.name}) ${program.summary}` : ` ${program.summary}`);
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
      startProgram(this.page, program.name, () => readForm(form), start, answer);
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
}

/**
 * Start a program; what comes of it is shown in `note`, with a button where a run is in the way.
 * @param {import("./main.js").Page} page @param {string} program @param {() => Record<string, string>} read values of its arguments
 * @param {HTMLButtonElement} button @param {HTMLElement} note
 */
export async function startProgram(page, program, read, button, note) {
  button.disabled = true;
  note.hidden = false;
  note.textContent = TEXTS.startingProgram;
  const answer = await RUNS.request({ t: "start", program, arguments: read() });
  button.disabled = false;
  note.textContent = answer ? answer.text : TEXTS.noAnswer;
  if (answer && !answer.ok) offerToEnd(answer.text, note, () => startProgram(page, program, read, button, note));
  if (!answer?.ok) return;
  note.hidden = true;
  page.say(TEXTS.started(program));
  const { panels } = page;
  if ((panels.isOpen("programs") || panels.isOpen("maps")) && !panels.isOpen("runs")) panels.toggle("runs");
}

/** Offer to end the run that keeps a program from starting. @param {string} problem @param {HTMLElement} note @param {() => void} start */
function offerToEnd(problem, note, start) {
  const run = problem.includes(IN_THE_WAY) ? RUNS.state?.runs.find((each) => problem.includes(each.run)) : undefined;
  if (run) offerToEndRun(run, TEXTS.runInTheWay, note, start);
}

/** Offer to end a run, and to start a program then. @param {import("./run_socket.js").Run} run @param {string} why @param {HTMLElement} note @param {() => void} start */
export function offerToEndRun(run, why, note, start) {
  const name = TEXTS.runName(run.title, run.started);
  const act = async () => {
    note.textContent = TEXTS.endingRun(name);
    const answer = await RUNS.request({ t: "end", run: run.run });
    if (answer?.ok && (await hasEnded(run.run))) start();
    else note.textContent = answer && !answer.ok ? answer.text : answer ? TEXTS.runStays : TEXTS.noAnswer;
  };
  note.hidden = false;
  note.replaceChildren(`${why} `, makeButton(TEXTS.endAndStart(name), act));
}

/** Whether a run has left the list before long. @param {string} run @returns {Promise<boolean>} */
function hasEnded(run) {
  const ended = () => RUNS.state !== null && !RUNS.state.runs.some((each) => each.run === run);
  return new Promise((done) => {
    const end = performance.now() + ENDS_WITHIN;
    const timer = setInterval(() => {
      if (!ended() && performance.now() < end) return;
      clearInterval(timer);
      done(ended());
    }, 200);
  });
}
