// @ts-check
/**
 * Panels beside the map, of which one is open at most, and the buttons that open them.
 *
 * A panel is a module of its own, named in `panel_list.js`: nothing else of the page has to know it.
 */

import { make, makeButton } from "./elements.js";
import { TEXTS } from "./texts.js";

/**
 * `icon`: path of a drawing of 24 by 24 units. `wide`: for tables; it covers most of the map.
 * `make` fills the empty box; `show` is called with true when the panel opens, and with false when it closes.
 * @typedef {{show?: (open: boolean) => void}} PanelPart
 * @typedef {{name: string, label: string, icon: string, wide?: boolean,
 *   make: (box: HTMLElement, page: import("./main.js").Page) => PanelPart | void}} Panel
 */

const SVG = "http://www.w3.org/2000/svg";

export class Panels {
  /** @param {HTMLElement} bar the buttons' box @param {readonly Panel[]} list @param {import("./main.js").Page} page */
  constructor(bar, list, page) {
    bar.setAttribute("aria-label", TEXTS.panels);
    /** @type {Map<string, {box: HTMLElement, button: HTMLButtonElement, part: PanelPart}>} */
    this.panels = new Map();
    /** Has the back button of a phone close the panel, where the browser can. @type {any} */
    this.back = null;
    for (const panel of list) {
      const button = makePanelButton(panel, () => this.toggle(panel.name));
      bar.append(button);
      const box = make("aside", "", panel.wide ? "panel wide" : "panel");
      box.id = `${panel.name}-panel`;
      box.setAttribute("aria-label", panel.label);
      box.tabIndex = -1; // it has the focus when the control that had it is gone
      box.hidden = true;
      bar.after(box);
      box.append(this.makeHead(panel.label));
      const part = panel.make(box, page) ?? {};
      this.panels.set(panel.name, { box, button, part });
    }
    addEventListener("keydown", (event) => event.key === "Escape" && this.close());
  }

  /** The title of a panel, and a button that closes it: a wide one covers the bar on a phone. @param {string} label */
  makeHead(label) {
    const head = make("div", "", "row head");
    const close = makeButton("\u00d7", () => this.close(), TEXTS.close);
    close.className = "close";
    head.append(make("h2", label), close);
    return head;
  }

  /** The name of the open panel, or "". */
  get open() {
    for (const [name, { box }] of this.panels) if (!box.hidden) return name;
    return "";
  }

  /** Open a panel, or close it. @param {string} name */
  toggle(name) {
    const shown = name === this.open ? "" : name;
    for (const [each, { box, button, part }] of this.panels) {
      const changes = box.hidden === (each === shown);
      box.hidden = each !== shown;
      button.setAttribute("aria-expanded", String(!box.hidden));
      if (changes) part.show?.(!box.hidden);
    }
    document.body.dataset.panel = shown;
    this.back?.destroy();
    this.back = null;
    const { CloseWatcher } = /** @type {any} */ (globalThis);
    if (!shown || !CloseWatcher) return;
    const back = new CloseWatcher();
    back.onclose = () => this.back === back && this.close();
    this.back = back;
  }

  /** Close the panel that is open, and have its button focused again. */
  close() {
    const found = this.panels.get(this.open);
    if (!found) return;
    this.toggle(this.open);
    found.button.focus();
  }
}

/** @param {Panel} panel @param {() => void} act */
function makePanelButton(panel, act) {
  const button = makeButton("", act, panel.label);
  button.id = panel.name;
  button.title = panel.label;
  button.setAttribute("aria-expanded", "false");
  button.setAttribute("aria-controls", `${panel.name}-panel`);
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true"); // the button has the name
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", panel.icon);
  svg.append(path);
  button.append(svg);
  return button;
}
