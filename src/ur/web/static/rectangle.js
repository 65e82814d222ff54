// @ts-check
/** A rectangle or a line of the map that is typed, for those who cannot tap or draw it. */

import { make, makeNote } from "./elements.js";
import { TEXTS } from "./texts.js";

const FARTHEST = 1e5; // m, as the robot takes it

/** @typedef {[number, number][]} Corners */

export class Rectangle {
  /**
   * @param {() => import("./wire.js").Pose | null} where the robot is: without a picture, the one known place of the map
   * @param {(corners: Corners) => void} onChange called when all four numbers make a rectangle
   * @param {{title: string, sides: string[]}} texts
   * @param {(numbers: (number | null)[]) => Corners | null} makePoints of the numbers
   */
  constructor(where, onChange, texts = TEXTS.zones.rectangle, makePoints = makeCorners) {
    this.where = where;
    this.makePoints = makePoints;
    this.onChange = onChange;
    this.box = make("details", "", "rectangle");
    this.note = makeNote();
    this.fields = texts.sides.map((label) => this.makeField(label));
    const grid = make("div", "", "sides");
    grid.append(...this.fields.map((field) => /** @type {HTMLElement} */ (field.parentElement)));
    this.box.append(make("summary", texts.title), this.note, grid);
    this.box.addEventListener("toggle", () => this.tell());
  }

  /** @param {string} label */
  makeField(label) {
    const field = make("input");
    field.inputMode = "text"; // the numbers of a phone's keyboard have no minus sign
    field.autocomplete = "off";
    field.maxLength = 10;
    field.addEventListener("input", () => this.read());
    const line = make("label", label, "stacked");
    line.append(field);
    return field;
  }

  /** Say where the robot is. */
  tell() {
    const pose = this.where();
    this.note.textContent = pose && this.box.open ? TEXTS.zones.robotAt(toCentimetres(pose.x), toCentimetres(pose.y)) : "";
  }

  clear() {
    this.box.open = false;
    for (const field of this.fields) field.value = "";
  }

  read() {
    for (const field of this.fields) field.ariaInvalid = String(field.value !== "" && readMetres(field.value) === null);
    const corners = this.points();
    if (corners) this.onChange(corners);
  }

  /** The points that are typed; null while numbers are missing. */
  points() {
    return this.makePoints(this.fields.map((field) => readMetres(field.value)));
  }
}

/** A number of metres, to centimetres; null for what is none. @param {string} text */
export function readMetres(text) {
  const found = text.trim().replace(",", ".");
  const number = /^[-+]?(\d+\.?\d*|\.\d+)$/.test(found) ? Number(found) : NaN;
  return Math.abs(number) <= FARTHEST ? toCentimetres(number) : null;
}

/** @param {number} metres no -0 */
const toCentimetres = (metres) => Math.round(100 * metres) / 100 + 0;

/** The corners between two x and two y, whichever is the larger; null where they make no area. @param {(number | null)[]} sides @returns {Corners | null} */
export function makeCorners([left, right, low, high]) {
  if (left === null || right === null || low === null || high === null || left === right || low === high) return null;
  return [[left, low], [right, low], [right, high], [left, high]];
}

/** The line from (x0, y0) to (x1, y1). @param {(number | null)[]} numbers @returns {Corners | null} */
export function makeLine([x0, y0, x1, y1]) {
  return x0 === null || y0 === null || x1 === null || y1 === null ? null : [[x0, y0], [x1, y1]];
}
