// @ts-check
/** The stored maps of the computer that serves the page: drive on one, and save the one that is being made. */

import { make, makeButton, makeNote, replaceRows } from "./elements.js";
import { offerToEndRun, startProgram } from "./program_panel.js";
import { RUNS } from "./run_socket.js";
import { TEXTS } from "./texts.js";
import { KIND } from "./wire.js";

/**
 * `width`, `height` in m; `changed` in seconds since 1970, 0: unknown; `picture`: lines of " " (unknown), "." (free), "#" (wall).
 * @typedef {{name: string, width: number | null, height: number | null, changed: number, places: number, latest: boolean,
 *   problem: string, picture: string[]}} StoredMap
 * @typedef {{name: string, saves: boolean}} MapState the stored map in use, and whether one is being made that can be saved
 */

const NO_MAP = /** @type {MapState} */ ({ name: "", saves: false });
const PROGRAM = "keyboard_navigate";
const MAPPER = "/slam_gmapping";
const COLOURS = /** @type {Record<string, string>} */ ({ ".": "--map-free", "#": "--map-wall" });

/** @type {import("./panels.js").Panel} */
export const MAP_LIST_PANEL = {
  name: "maps",
  label: TEXTS.mapList.title,
  icon: "M9 4l6 3 6-3v13l-6 3-6-3-6 3V7zM9 4v13M15 7v13",
  make: (box, page) => {
    const panel = new MapList(box, page);
    page.mapList = panel;
    page.frames.onJson(KIND.STATE, ({ map }) => panel.take(map ?? NO_MAP), {});
    return { show: (open) => panel.show(open) };
  },
};

export class MapList {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page */
  constructor(box, page) {
    this.page = page;
    this.open = false;
    this.state = NO_MAP;
    /** @type {StoredMap[]} */
    this.maps = [];
    /** What the list shows. */
    this.shown = "";
    this.note = makeNote();
    this.saving = make("div", "", "row");
    this.save = makeButton(TEXTS.mapList.save, () => this.askToSave());
    this.save.id = "map-save";
    this.saving.append(make("span", TEXTS.mapList.makes, "grow"), this.save);
    this.saving.hidden = true;
    this.answer = makeNote();
    this.answer.hidden = true;
    this.list = make("ul");
    box.append(this.saving, this.answer, this.note, this.list);
  }

  /** @param {boolean} open */
  show(open) {
    if (open === this.open) return;
    this.open = open;
    RUNS.use(open);
    this.save.disabled = false; // an answer may have been lost with the connection
    if (open) this.load();
  }

  /** @param {MapState} state */
  take({ name, saves }) {
    if (name === this.state.name && saves === this.state.saves) return;
    this.state = { name, saves };
    this.saving.hidden = !saves || !this.page.mayDrive;
    if (this.open) this.load();
  }

  async load() {
    if (!this.shown) this.note.textContent = TEXTS.loading;
    const answer = await fetch("/api/maps").catch(() => null);
    if (!answer?.ok) return this.say(this.note, answer ? await answer.text() : TEXTS.noAnswer);
    this.maps = await answer.json();
    this.say(this.note, this.maps.length ? "" : TEXTS.mapList.none);
    this.draw();
  }

  draw() {
    const shown = JSON.stringify([this.maps, this.state.name]);
    if (shown === this.shown) return; // a button that asks whether it is sure keeps asking
    this.shown = shown;
    replaceRows(this.list, this.maps.map((map) => this.makeRow(map)));
  }

  /** @param {StoredMap} map */
  makeRow(map) {
    const used = map.name === this.state.name;
    const row = make("li", "", "stored");
    const text = make("div", "", "grow");
    const title = make("b", map.name);
    text.append(title, make("p", [used ? TEXTS.mapList.inUse : "", TEXTS.mapList.facts(map)].filter(Boolean).join(" \u00b7 ")));
    if (used) row.setAttribute("aria-current", "true");
    if (map.picture.length) row.append(drawPicture(map));
    row.append(text);
    if (!this.page.mayDrive || used) return row; // the program that uses a map has it open
    const problem = make("p", "", "problem");
    problem.role = "status";
    problem.hidden = true;
    const drive = makeButton(
      TEXTS.mapList.drive,
      () => this.driveOn(map.name, drive, problem),
      TEXTS.mapList.driveOn(map.name),
    );
    drive.disabled = Boolean(map.problem);
    row.append(drive, problem);
    return row;
  }

  /** Start to navigate; a map that is being made has its program ended first. @param {string} name @param {HTMLButtonElement} button @param {HTMLElement} problem */
  driveOn(name, button, problem) {
    const start = () => startProgram(this.page, PROGRAM, () => ({ map: name }), button, problem);
    if (!this.state.saves) return void start();
    // The program would join the robot of that run, which would then have two maps.
    const run = RUNS.state?.runs.find((each) => each.nodes.some((node) => node.name.endsWith(MAPPER)));
    if (run) offerToEndRun(run, TEXTS.mapList.makesStill, problem, start);
    else this.say(problem, TEXTS.mapList.endFirst);
  }

  askToSave() {
    const sent = this.page.drive?.send({ t: "save_map" }) ?? false;
    if (!sent) return this.page.sayNotSent();
    this.save.disabled = true;
    this.say(this.answer, TEXTS.mapList.saving);
  }

  /** Take the answer to a request to save. @param {{t: string, name?: string, why?: string}} answer */
  answered({ name, why = "" }) {
    this.save.disabled = false;
    const text = name ? TEXTS.mapList.saved(name) : TEXTS.mapList.notSaved(TEXTS.mapList.why[why] ?? why.replace(/\.$/, ""));
    this.say(this.answer, text);
    if (!this.open) this.page.say(text);
    else if (name) this.load();
  }

  /** @param {HTMLElement} note @param {string} text */
  say(note, text) {
    if (note.textContent !== text) note.textContent = text;
    note.hidden = !text;
  }
}

/** @param {StoredMap} map */
function drawPicture({ name, picture }) {
  const canvas = make("canvas");
  canvas.width = Math.max(...picture.map((line) => line.length), 1);
  canvas.height = 2 * picture.length; // a character is twice as high as it is wide
  canvas.role = "img";
  canvas.ariaLabel = TEXTS.mapList.picture(name);
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const style = getComputedStyle(document.documentElement);
  for (const [mark, variable] of Object.entries(COLOURS)) {
    context.fillStyle = style.getPropertyValue(variable);
    for (const [row, line] of picture.entries()) {
      for (let column = 0; column < line.length; column++) if (line[column] === mark) context.fillRect(column, 2 * row, 1, 2);
    }
  }
  return canvas;
}
