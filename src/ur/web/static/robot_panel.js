// @ts-check
/** The robots that the computer of this page knows, and the change to the page of another one. */

import { make, makeButton, makeNote, replaceRows } from "./elements.js";
import { TEXTS } from "./texts.js";

/** @typedef {{name: string, label: string, answers: boolean, open: boolean, shown: boolean}} Robot */

const EVERY = 5000; // ms between two looks at the list

/** @type {import("./panels.js").Panel} */
export const ROBOT_PANEL = {
  name: "robots",
  label: TEXTS.robots.title,
  icon: "M5 9h14v10H5zM12 5v4M9 13v2M15 13v2M2 12v4M22 12v4",
  make: (box) => {
    const panel = new RobotPanel(box);
    let timer = 0;
    return {
      show: (open) => {
        clearInterval(timer);
        if (!open) return;
        panel.load();
        timer = setInterval(() => panel.load(), EVERY);
      },
    };
  },
};

class RobotPanel {
  /** @param {HTMLElement} box */
  constructor(box) {
    this.note = makeNote();
    this.list = make("ul");
    this.help = make("p");
    /** What the list shows. */
    this.shown = "";
    /** A robot is being opened. */
    this.busy = false;
    /** The note says why there is no list. */
    this.failed = false;
    box.append(this.note, this.list, this.help);
    this.say("");
  }

  async load() {
    const answer = await fetch("/api/robots").catch(() => null);
    if (this.busy) return;
    if (!answer?.ok || this.failed) this.say(!answer ? TEXTS.noAnswer : answer.ok ? "" : await answer.text());
    this.failed = !answer?.ok;
    if (!answer?.ok) return;
    /** @type {Robot[]} */
    const robots = await answer.json();
    const shown = JSON.stringify(robots);
    if (shown === this.shown) return;
    this.shown = shown;
    this.help.textContent = robots.length > 1 ? TEXTS.robots.help : TEXTS.robots.none;
    replaceRows(this.list, robots.map((robot) => this.makeRow(robot)));
  }

  /** @param {Robot} robot */
  makeRow(robot) {
    const row = make("li");
    const text = make("span", "", "grow");
    const facts = [robot.shown ? TEXTS.robots.shown : "", robot.answers ? TEXTS.robots.answers : TEXTS.robots.away];
    text.append(make("b", robot.label), make("br"), make("small", facts.filter(Boolean).join(" \u00b7 ")));
    row.append(text);
    if (robot.shown) row.ariaCurrent = "true";
    else row.append(makeButton(TEXTS.robots.open, () => this.open(robot), TEXTS.robots.openOf(robot.label)));
    return row;
  }

  /** @param {Robot} robot */
  async open({ name, label }) {
    if (this.busy) return;
    this.busy = true;
    this.say(TEXTS.robots.opening(label));
    const answer = await fetch("/api/robots", { method: "POST", body: JSON.stringify({ name }) }).catch(() => null);
    this.busy = false;
    if (!answer?.ok) return this.say(answer ? await answer.text() : TEXTS.noAnswer);
    location.assign((await answer.json()).link);
  }

  /** @param {string} text */
  say(text) {
    this.note.textContent = text;
    this.note.hidden = !text;
  }
}
