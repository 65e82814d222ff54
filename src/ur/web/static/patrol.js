// @ts-check
/** The patrol of the robot, shown and asked for: the robot drives it, whether a page is open or not. */

import { make, makeNote, sentence } from "./elements.js";
import { TEXTS } from "./texts.js";

/**
 * @typedef {"start" | "pause" | "resume" | "end"} PatrolAction
 * @typedef {{state: string, line: string, stops: [string, number, number][], index: number, loop: boolean}} PatrolState
 * @typedef {(request: Record<string, unknown>) => void} Send
 */

const ACTIVE = ["starting", "driving", "waiting"];

/** Whether the patrol drives, or will by itself. @param {PatrolState | null | undefined} patrol */
export const isActive = (patrol) => ACTIVE.includes(patrol?.state ?? "");

/** Whether the patrol is to be seen on every screen. @param {PatrolState | null | undefined} patrol */
export const isOn = (patrol) => isActive(patrol) || patrol?.state === "paused";

/** Requests that fit the state, with their labels. @param {PatrolState} patrol @returns {[PatrolAction, string][]} */
export function listActions(patrol) {
  const first = /** @type {[PatrolAction, string]} */ (isActive(patrol) ? ["pause", TEXTS.patrol.pause] : ["resume", TEXTS.resume]);
  return [first, ["end", TEXTS.patrol.end]];
}

/** The line above the map about a patrol. @param {PatrolState} patrol @param {Send | null} send null: this page may look only */
export function describePatrol(patrol, send) {
  const buttons = send ? listActions(patrol).map(([action, label]) => ({ label, act: () => send({ t: "patrol", do: action }) })) : [];
  return { text: sentence(patrol.line), subject: "patrol", buttons };
}

/** The part of a panel that chooses places and starts a patrol. */
export class PatrolBox {
  /** @param {boolean} mayDrive @param {Send} send */
  constructor(mayDrive, send) {
    this.mayDrive = mayDrive;
    /** The places in their order. @type {string[]} */
    this.chosen = [];
    /** @type {PatrolState | null} */
    this.patrol = null;
    this.box = make("div", "", "patrol");
    this.note = makeNote();
    this.repeat = make("input");
    this.repeat.type = "checkbox";
    this.repeat.id = "patrol-repeat";
    const label = make("label");
    label.append(this.repeat, TEXTS.patrol.repeat);
    this.button = make("button");
    this.button.type = "button";
    this.button.id = "patrol";
    this.button.addEventListener("click", () =>
      send(isOn(this.patrol) ? { t: "patrol", do: "end" } : { t: "patrol", do: "start", places: this.chosen, loop: this.repeat.checked }),
    );
    this.box.append(this.note, label, this.button);
  }

  /** @param {string[]} names of all places */
  offer(names) {
    this.chosen = this.chosen.filter((name) => names.includes(name));
    this.box.hidden = !this.mayDrive || names.length < 2;
    this.refresh();
  }

  /** @param {string} name @param {boolean} wanted */
  choose(name, wanted) {
    this.chosen = this.chosen.filter((each) => each !== name);
    if (wanted) this.chosen.push(name);
    this.refresh();
  }

  /** Show the state of the robot's patrol. @param {PatrolState | null} patrol null: no node drives patrols */
  show(patrol) {
    this.patrol = patrol;
    this.refresh();
  }

  refresh() {
    const on = isOn(this.patrol);
    this.button.textContent = on ? TEXTS.patrol.end : TEXTS.patrol.start;
    this.button.disabled = !on && (this.chosen.length < 2 || !this.patrol);
    this.repeat.disabled = on;
    const over = this.patrol?.line && !this.chosen.length ? sentence(this.patrol.line) : TEXTS.patrol.chosen(this.chosen);
    this.note.textContent = !this.patrol ? TEXTS.refused["no patrol"] : on ? sentence(this.patrol.line) : over;
  }
}
