// @ts-check
/** Buttons of the map, the modes, and the emergency stop: their names, and what they do. */

import { element, makeButton } from "./elements.js";
import { TEXTS } from "./texts.js";

/** @typedef {import("./main.js").Mode} Mode */

const MARGIN = 8; // pixels round the map

/** @param {import("./main.js").Page} page @param {string} robot */
export function labelControls(page, robot) {
  document.title = robot;
  element("name").textContent = robot;
  element("map").setAttribute("aria-label", TEXTS.map);
  element("stick").setAttribute("aria-label", TEXTS.stick);
  element("stop").textContent = TEXTS.stop;
  element("stop").title = TEXTS.stopHelp;
  // At once when touched: a browser makes no click of a finger that stays, or moves.
  element("stop").addEventListener("pointerdown", () => page.stop());
  element("stop").addEventListener("click", (event) => event.detail === 0 && page.stop()); // by key or screen reader
  /** @type {[string, string, () => void][]} */
  const buttons = [
    ["zoom-in", TEXTS.zoomIn, () => page.gestures.step(true)],
    ["zoom-out", TEXTS.zoomOut, () => page.gestures.step(false)],
    ["sideways", TEXTS.sideways, () => element("sideways").setAttribute("aria-pressed", String(element("sideways").ariaPressed !== "true"))],
    ["follow", TEXTS.follow, () => page.setFollow(!page.map.follow)],
    ["fit", TEXTS.fit, () => (page.setFollow(false), page.map.fit())],
  ];
  for (const [id, label, act] of buttons) {
    element(id).setAttribute("aria-label", label);
    element(id).title = label;
    element(id).addEventListener("click", act);
  }
  element("holding-text").textContent = TEXTS.youDrive;
  element("hand-back").textContent = TEXTS.handBack;
  element("hand-back").title = TEXTS.handBackHelp;
  element("hand-back").addEventListener("click", () => (page.setMode("look"), page.leave()));
  element("modes").hidden = !page.mayDrive;
  for (const mode of /** @type {Mode[]} */ (["look", "goal", "drive", "pose"])) {
    const button = makeButton(TEXTS.modes[mode], () => (page.setMode(mode), mode === "look" && page.leave()));
    button.id = `mode-${mode}`;
    element("modes").append(button);
  }
}

/** The pixels that controls need: left, right, above and below the map. A small page has the map below its controls. */
export function measureEdges() {
  const [map, head, bar, view, stop, modes] = ["map", "header", "panels", "view", "stop", "modes"].map((name) =>
    /** @type {HTMLElement} */ (document.querySelector(name === "header" ? name : `#${name}`)).getBoundingClientRect(),
  );
  const above = head.bottom + MARGIN;
  const desk = element("menu").offsetWidth === 0;
  if (desk) return [bar.right + MARGIN, map.right - view.left + MARGIN, above, map.bottom - (modes.top || stop.top) + MARGIN];
  const low = Math.min(modes.top || map.bottom, map.height > map.width ? stop.top : map.bottom);
  return [MARGIN, MARGIN, above, map.bottom - low + MARGIN];
}

/** Show a mode as chosen. @param {Mode} mode @param {boolean} mayDrive */
export function showMode(mode, mayDrive) {
  document.body.dataset.mode = mode;
  for (const each of element("modes").children) {
    each.setAttribute("aria-pressed", String(each.id === `mode-${mode}`));
  }
  element("hint").textContent = !mayDrive ? TEXTS.lookOnly : mode === "look" ? "" : TEXTS.modeHelp[mode];
  element("stick").hidden = mode !== "drive";
}
