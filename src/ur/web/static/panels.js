// @ts-check
/** Panels beside the map, of which one is open at most. */

const NAMES = ["places", "layers"];

/** Open a panel, or close it. @param {string} name its button's id */
export function togglePanel(name) {
  for (const each of NAMES) {
    const panel = /** @type {HTMLElement} */ (document.getElementById(`${each}-panel`));
    panel.hidden = each !== name || !panel.hidden;
    document.getElementById(each)?.setAttribute("aria-expanded", String(!panel.hidden));
  }
}
