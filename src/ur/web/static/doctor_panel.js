// @ts-check
/** Findings of the doctor, each with the commands that fix it, to be typed in a terminal. */

import { make, makeButton } from "./elements.js";
import { announce } from "./heard.js";
import { TEXTS } from "./texts.js";

/** @typedef {{on: string, command: string, fix: boolean}} Command */
/** @typedef {{rule: string, message: string, help: string, commands: Command[]}} Finding */
/** @typedef {{title: string, seen: string, good: boolean | null}} Step */

/** @type {import("./panels.js").Panel} */
export const DOCTOR_PANEL = {
  name: "doctor",
  label: TEXTS.doctor,
  icon: "M3 12h4l3-7 4 14 3-7h4",
  wide: true,
  make: (box) => {
    const note = make("p");
    note.role = "status";
    const list = make("div", "", "findings");
    const again = makeButton(TEXTS.again, () => load());
    box.append(note, again, list);
    async function load() {
      again.disabled = true;
      note.textContent = TEXTS.diagnosing;
      const answer = await fetch("/api/doctor").catch(() => null);
      again.disabled = false;
      list.replaceChildren();
      if (!answer?.ok) {
        note.textContent = answer ? await answer.text() : TEXTS.noAnswer;
        return;
      }
      /** @type {{findings: Finding[], steps: Step[]}} */
      const { findings, steps } = await answer.json();
      note.textContent = TEXTS.findings(findings.length);
      const failed = steps.filter((step) => step.good === false);
      list.append(...failed.map(({ title, seen }) => make("p", seen ? `${title}: ${seen}` : title, "problem")));
      list.append(...findings.map(makeFinding));
    }
    return { show: (open) => void (open && load()) };
  },
};

/** @param {Finding} finding */
function makeFinding({ rule, message, help, commands }) {
  const box = make("section");
  const title = make("h3", message);
  title.append(make("small", ` ${rule}`));
  box.append(title);
  if (help) box.append(make("p", help));
  for (const { on, command, fix } of commands) {
    box.append(make("p", fix ? TEXTS.commandFix(on) : TEXTS.commandOn(on)), makeCommand(command));
  }
  return box;
}

/** A command with a button that copies it. @param {string} command */
function makeCommand(command) {
  const box = make("div", "", "command");
  const text = make("pre", command);
  const button = makeButton(TEXTS.copy, async () => {
    getSelection()?.selectAllChildren(text); // where it cannot be copied, Ctrl-C does it
    // Browsers give the clipboard to pages of https and of this computer only.
    const done = navigator.clipboard
      ? await navigator.clipboard.writeText(command).then(() => true, () => false)
      : document.execCommand("copy");
    button.textContent = done ? TEXTS.copied : TEXTS.notCopied;
    announce(button.textContent);
  }, TEXTS.copyCommand(command));
  box.append(text, button);
  return box;
}
