// @ts-check
/** Elements of the page, found and made. */

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

/** A text of the robot as a sentence of its own: nodes begin their messages with a small letter. @param {string} text */
export const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** Whether keys belong to a control: what is typed there drives nothing. @param {EventTarget | null} target */
export function takesKeys(target) {
  return target instanceof HTMLInputElement || target instanceof HTMLSelectElement;
}
