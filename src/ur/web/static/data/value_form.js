// @ts-check
/** A form for the fields of a message, from an empty one: a control for each number, text and truth, JSON for lists. */

import { make } from "../elements.js";

const DEEPEST = 4; // levels with controls of their own; what is deeper is JSON

/** A field whose text is not JSON. */
export class FieldError extends Error {}

export class ValueForm {
  /** @param {any} value an empty message @param {string} prefix of ids */
  constructor(value, prefix) {
    this.prefix = prefix;
    this.count = 0;
    this.box = make("div", "", "values");
    this.reader = this.add(this.box, value, "", 0);
  }

  /** The fields as JSON. Throws FieldError. */
  read() {
    return JSON.stringify(this.reader());
  }

  /** @param {HTMLElement} box @param {any} value @param {string} name @param {number} depth @returns {() => any} */
  add(box, value, name, depth) {
    if (value !== null && typeof value === "object" && !Array.isArray(value) && depth < DEEPEST) {
      const inner = depth === 0 ? box : make("fieldset");
      if (inner !== box) {
        inner.append(make("legend", name));
        box.append(inner);
      }
      const readers = Object.entries(value).map(([key, each]) => /** @type {const} */ ([key, this.add(inner, each, key, depth + 1)]));
      return () => Object.fromEntries(readers.map(([key, read]) => [key, read()]));
    }
    this.count += 1;
    const input = make("input");
    input.id = `${this.prefix}-${this.count}`;
    const label = make("label", name);
    label.htmlFor = input.id;
    const row = make("div", "", "value");
    row.append(label, input);
    box.append(row);
    if (typeof value === "boolean") {
      input.type = "checkbox";
      input.checked = value;
      return () => input.checked;
    }
    if (typeof value === "string") return () => input.value;
    input.value = typeof value === "number" ? String(value) : JSON.stringify(value);
    return () => readJson(input, name);
  }
}

/** @param {HTMLInputElement} input @param {string} name */
function readJson(input, name) {
  try {
    const value = JSON.parse(input.value.trim() || "0");
    input.ariaInvalid = "false";
    return value;
  } catch {
    input.ariaInvalid = "true";
    throw new FieldError(name);
  }
}
