// @ts-check
/** Elements of the page, found and made. */

import { TEXTS } from "./texts.js";

const SURE_TIME = 4000; // ms to press again

/** The element with an id, which the page has. @param {string} id @returns {HTMLElement} */
export const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/**
 * Make an element with a text and a class.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag @param {string} [text] @param {string} [className]
 * @returns {HTMLElementTagNameMap[K]}
 */
export function make(tag, text = "", className = "") {
  const made = document.createElement(tag);
  if (text) made.textContent = text;
  if (className) made.className = className;
  return made;
}

/** Make a button. @param {string} text @param {() => void} act @param {string} [label] for screen readers, where the text does not say it */
export function makeButton(text, act, label = "") {
  const button = make("button", text);
  button.type = "button";
  if (label) button.ariaLabel = label;
  button.addEventListener("click", act);
  return button;
}

/** Make a button that acts when it is pressed twice. @param {string} text @param {() => void} act @param {string} [label] as above */
export function makeSureButton(text, act, label = "") {
  let timer = 0; // while it asks
  const show = (/** @type {boolean} */ asks) => {
    clearTimeout(timer);
    timer = asks ? setTimeout(() => show(false), SURE_TIME) : 0;
    button.textContent = asks ? TEXTS.sure : text;
    if (label) button.ariaLabel = asks ? `${TEXTS.sure} ${label}` : label;
  };
  const button = makeButton(text, () => {
    const sure = timer !== 0;
    show(!sure);
    if (sure) act();
  }, label);
  return button;
}

/** Make a line whose changes are read out. @param {string} [text] */
export function makeNote(text = "") {
  const note = make("p", text);
  note.role = "status";
  return note;
}

/** Replace the rows of a list in a panel; the control that has the focus keeps it. @param {HTMLElement} list @param {HTMLElement[]} rows */
export function replaceRows(list, rows) {
  const focused = list.contains(document.activeElement) ? /** @type {HTMLElement} */ (document.activeElement) : null;
  list.replaceChildren(...rows);
  if (!focused) return;
  const same = [...list.querySelectorAll("button, input")].find((each) => each.ariaLabel === focused.ariaLabel);
  /** @type {HTMLElement | null} */ (same ?? list.closest("aside"))?.focus();
}

/** Have a name of ROS broken between its words only, where it does not fit. @param {HTMLElement} box @param {string} name */
export function showName(box, name) {
  if (box.textContent !== name) box.replaceChildren(...(name.match(/[A-Z]*[^A-Z_/]*[_/]?/g) ?? []).flatMap((part) => [part, make("wbr")]));
}

/** A text of the robot as a sentence of its own: nodes begin their messages with a small letter. @param {string} text */
export const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** Why a place or a zone cannot have a name; "" if it can. As `PLACE_NAME` and `ZONE_NAME` of the robot. @param {string} name */
export function checkName(name) {
  if (!name) return TEXTS.noName;
  return /^[\p{L}\p{N}_]([\p{L}\p{N}_ .-]{0,38}[\p{L}\p{N}_.-])?$/u.test(name) ? "" : TEXTS.badName;
}

/** Whether a text is typed there, to which spaces belong. @param {EventTarget | null} target */
export function takesText(target) {
  if (target instanceof HTMLInputElement) return !["checkbox", "radio", "range"].includes(target.type);
  return target instanceof HTMLTextAreaElement;
}

/** Whether keys belong to a control: what is typed there drives nothing. @param {EventTarget | null} target */
export function takesKeys(target) {
  return [HTMLInputElement, HTMLSelectElement, HTMLTextAreaElement].some((each) => target instanceof each);
}

/**
 * Have a browser make no gesture of its own of a finger that moves on an element. Chromium does although `touch-action`
 * is none: after a quick drag it takes the next tap, anywhere, as the end of a fling, and makes no click of it.
 * @param {HTMLElement} element
 */
export function withoutFling(element) {
  element.addEventListener("touchmove", (event) => event.preventDefault(), { passive: false });
}
