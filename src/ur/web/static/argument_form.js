// @ts-check
/** Arguments of a launch file as a form: an empty field keeps the default. */

import { make, sentence } from "./elements.js";
import { TEXTS } from "./texts.js";

/** @typedef {{name: string, doc: string, default: string | null, values: {text: string, help: string}[]}} Argument */

/** Those with known values, and those that have to be given, come first. @param {HTMLFormElement} form @param {Argument[]} list @param {string} id */
export function fillForm(form, list, id) {
  const first = list.filter((each) => each.default === null || each.values.length > 1);
  const others = list.filter((each) => !first.includes(each));
  form.append(...first.map((each) => makeField(each, id)));
  if (!others.length) return;
  const box = make("details");
  box.append(make("summary", TEXTS.moreArguments(others.length)), ...others.map((each) => makeField(each, id)));
  form.append(box);
}

/** The values that differ from the defaults. @param {HTMLFormElement} form @returns {Record<string, string>} */
export function readForm(form) {
  const found = /** @type {Record<string, string>} */ ({});
  for (const field of form.querySelectorAll("[data-argument]")) {
    const { value, dataset } = /** @type {HTMLInputElement} */ (field);
    if (value !== "" && dataset.argument) found[dataset.argument] = value;
  }
  return found;
}

/** @param {Argument} argument @param {string} id */
function makeField(argument, id) {
  const box = make("div", "", "field");
  const label = make("label", TEXTS.argumentNames[argument.name] ?? sentence(argument.name.replaceAll("_", " ")));
  const truth = argument.values.length === 2 && argument.values.every(({ text }) => text === "true" || text === "false");
  const field = truth ? makeChoice(argument) : makeInput(argument, `${id}-${argument.name}-values`, box);
  field.id = `${id}-${argument.name}`;
  field.dataset.argument = argument.name;
  field.required = argument.default === null;
  label.htmlFor = field.id;
  box.append(label, field);
  if (argument.doc) {
    const doc = make("small", argument.doc.replaceAll("`", ""));
    doc.id = `${field.id}-doc`;
    field.setAttribute("aria-describedby", doc.id);
    box.append(doc);
  }
  return box;
}

/** @param {Argument} argument */
function makeChoice(argument) {
  const field = make("select");
  field.append(new Option(TEXTS.byDefault(argument.default ?? ""), ""), new Option("true"), new Option("false"));
  return field;
}

/** @param {Argument} argument @param {string} id @param {HTMLElement} box */
function makeInput(argument, id, box) {
  const field = make("input");
  field.placeholder = argument.default ?? TEXTS.required;
  field.maxLength = 256;
  field.autocomplete = "off";
  field.autocapitalize = "off";
  field.spellcheck = false;
  if (argument.values.length) {
    const list = make("datalist");
    list.id = id;
    for (const { text, help } of argument.values) list.append(new Option(help, text));
    field.setAttribute("list", id);
    box.append(list);
  }
  return field;
}
