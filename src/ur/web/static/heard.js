// @ts-check
/** Lines for screen readers: what changes on the page without having the focus. */

import { element, make } from "./elements.js";

const TIME = 10_000; // ms that a line stays: long enough to be read out

/** Have a line read out; an urgent one interrupts what is being read. @param {string} text @param {boolean} urgent */
export function announce(text, urgent = false) {
  if (!text) return;
  const line = make("span", text);
  element(urgent ? "heard-now" : "heard").append(line);
  setTimeout(() => line.remove(), TIME);
}
