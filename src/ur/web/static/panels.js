// @ts-check
/**
 * Panels and the buttons that open them: one over the map where the page is small, several beside it elsewhere.
 *
 * A panel is a module of its own, named in `panel_list.js`: nothing else of the page has to know it.
 */

import { Dock } from "./dock.js";
import { element, make, makeButton } from "./elements.js";
import { TEXTS } from "./texts.js";

/**
 * `icon`: path of a drawing of 24 by 24 units. `wide`: for tables; it gets more of the page.
 * `make` fills the empty box; `show` is called with true when the panel opens, and with false when it closes.
 * `leave` ends what the panel spreads over the page, and returns whether there was something.
 * @typedef {{show?: (open: boolean) => void, leave?: () => boolean}} PanelPart
 * @typedef {{name: string, label: string, icon: string, wide?: boolean,
 *   make: (box: HTMLElement, page: import("./main.js").Page) => PanelPart | void}} Panel
 * @typedef {{box: HTMLElement, button: HTMLButtonElement, part: PanelPart}} Made
 */

const SVG = "http://www.w3.org/2000/svg";

export class Panels {
  /** @param {HTMLElement} bar the buttons' box @param {readonly Panel[]} list @param {import("./main.js").Page} page */
  constructor(bar, list, page) {
    this.bar = bar;
    bar.setAttribute("aria-label", TEXTS.panels);
    /** @type {Map<string, Made>} */
    this.panels = new Map();
    /** Names of the open panels, the newest last. @type {string[]} */
    this.shown = [];
    /** Has the back button of a phone close the newest panel, where the browser can. @type {any} */
    this.back = null;
    this.menu = element("menu");
    this.menu.ariaLabel = TEXTS.panels;
    this.menu.addEventListener("click", () => this.openMenu(this.menu.ariaExpanded !== "true"));
    this.dock = new Dock(element("dock"), page.dockWidth, () => this.trim());
    for (const panel of list) {
      const button = makePanelButton(panel, () => this.choose(panel.name));
      bar.append(button);
      const box = make("aside", "", panel.wide ? "panel wide" : "panel");
      box.id = `${panel.name}-panel`;
      box.setAttribute("aria-label", panel.label);
      box.tabIndex = -1; // it has the focus when the control that had it was removed
      box.hidden = true;
      this.dock.box.append(box);
      box.append(this.makeHead(panel));
      const part = panel.make(box, page) ?? {};
      this.panels.set(panel.name, { box, button, part });
    }
    addEventListener("keydown", (event) => event.key === "Escape" && this.escape(event));
    addEventListener("pointerdown", ({ target }) => {
      if (target instanceof Node && !bar.contains(target) && !this.menu.contains(target)) this.openMenu(false);
    });
  }

  /** The title of a panel, and a button that closes it. @param {Panel} panel */
  makeHead(panel) {
    const head = make("div", "", "row head");
    const close = makeButton("\u00d7", () => this.close(panel.name), TEXTS.closePanel(panel.label));
    close.className = "close";
    head.append(make("h2", panel.label), close);
    return head;
  }

  /** The name of the panel that was opened last, or "". */
  get open() {
    return this.shown.at(-1) ?? "";
  }

  /** @param {string} name */
  isOpen(name) {
    return this.shown.includes(name);
  }

  /** Open a panel, or close it. @param {string} name */
  toggle(name) {
    this.show(this.isOpen(name) ? this.shown.filter((each) => each !== name) : [...this.shown, name]);
  }

  /** Open panels, the last ones where not all have room, and close the others. @param {string[]} names */
  show(names) {
    const known = names.filter((name, index) => this.panels.has(name) && names.lastIndexOf(name) === index);
    this.shown = known.slice(-this.dock.most);
    for (const [name, { box, button, part }] of this.panels) {
      const open = this.isOpen(name);
      const changes = box.hidden === open;
      box.hidden = !open;
      box.style.order = String(this.shown.indexOf(name)); // the newest is the lowest
      button.setAttribute("aria-expanded", String(open));
      if (changes) part.show?.(open);
    }
    document.body.dataset.panel = this.open;
    this.dock.fill(this.shown.length);
    this.watchBack();
  }

  /** Close the oldest panels that have no room any more. */
  trim() {
    if (this.shown.length > this.dock.most) this.show(this.shown);
  }

  /** Close the panel of a name, or the newest one, and have its button focused again. @param {string} [name] */
  close(name = this.open) {
    const found = this.panels.get(name);
    if (!found || !this.isOpen(name)) return;
    this.toggle(name);
    (found.button.checkVisibility() ? found.button : this.menu).focus();
  }

  /** Let the map be seen where a panel covers it. */
  showMap() {
    if (this.dock.covers) this.close();
  }

  /** A button of the bar or of the menu was pressed. @param {string} name */
  choose(name) {
    const fromMenu = this.menu.ariaExpanded === "true";
    this.openMenu(false);
    this.toggle(name);
    if (fromMenu) this.panels.get(this.open)?.box.focus();
  }

  /** @param {boolean} open */
  openMenu(open) {
    if ((this.menu.ariaExpanded === "true") === open) return;
    this.menu.ariaExpanded = String(open);
    document.body.toggleAttribute("data-menu", open);
    if (open) /** @type {HTMLElement | null} */ (this.bar.firstElementChild)?.focus();
  }

  /** @param {KeyboardEvent} event */
  escape(event) {
    event.preventDefault(); // or the browser asks `back` to close another one
    if (this.menu.ariaExpanded === "true") {
      this.openMenu(false);
      this.menu.focus();
      return;
    }
    const focused = this.shown.find((name) => this.panels.get(name)?.box.contains(document.activeElement));
    this.leave(focused);
  }

  /** End what a panel spreads over the page; without that, close the panel of a name, or the newest one. @param {string} [name] */
  leave(name) {
    if (this.shown.some((each) => this.panels.get(each)?.part.leave?.())) this.watchBack();
    else this.close(name);
  }

  watchBack() {
    this.back?.destroy();
    this.back = null;
    const { CloseWatcher } = /** @type {any} */ (globalThis);
    if (!this.shown.length || !CloseWatcher) return;
    const back = new CloseWatcher();
    back.onclose = () => this.back === back && this.leave();
    this.back = back;
  }
}

/** @param {Panel} panel @param {() => void} act */
function makePanelButton(panel, act) {
  const button = makeButton("", act);
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
  button.append(svg, make("span", panel.label));
  return button;
}
