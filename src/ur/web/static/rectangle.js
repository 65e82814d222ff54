// @ts-check
/** A rectangle of the map that is typed, for those who cannot tap its corners. */

import { make, makeNote } from "./elements.js";
import { TEXTS } from "./texts.js";

const FARTHEST = 1e5; // m, as the robot takes it

/** @typedef {[number, number][]} Corners */

export class Rectangle {
  /**
   * @param {() => import("./wire.js").Pose | null} where the robot is: without a picture, the one known place of the map
   * @param {(corners: Corners) => void} onChange called when all four numbers make a rectangle
   */
  constructor(where, onChange) {
    this.where = where;
    this.onChange = onChange;
    this.box = make("details", "", "rectangle");
    this.note = makeNote();
    this.fields = TEXTS.zones.sides.map((label) => this.makeField(label));
    const grid = make("div", "", "sides");
    grid.append(...this.fields.map((field) => /** @type {HTMLElement} */ (field.parentElement)));
    this.box.append(make("summary", TEXTS.zones.rectangle), this.note, grid);
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
    const numbers = this.fields.map((field) => readMetres(field.value));
    this.fields.forEach((field, index) => (field.ariaInvalid = String(field.value !== "" && numbers[index] === null)));
    const corners = makeCorners(numbers);
    if (corners) this.onChange(corners);
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
