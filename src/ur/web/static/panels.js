// @ts-check
/**
 * Panels and the buttons that open them, in groups: one over the map where the page is small, several beside it elsewhere.
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
 * @typedef {{label: string, icon: string, panels: readonly Panel[]}} Group
 * @typedef {{box: HTMLElement, button: HTMLButtonElement, group: HTMLDetailsElement, part: PanelPart}} Made
 */

const SVG = "http://www.w3.org/2000/svg";
const USED = "panels"; // where the browser keeps the names of the panels that were used

export class Panels {
  /** @param {HTMLElement} bar the buttons' box @param {readonly Group[]} groups @param {import("./main.js").Page} page */
  constructor(bar, groups, page) {
    this.bar = bar;
    bar.setAttribute("aria-label", TEXTS.panels);
    /** @type {Map<string, Made>} */
    this.panels = new Map();
    /** Names of the open panels, the newest last. @type {string[]} */
    this.shown = [];
    /** Names of panels that were opened ever, the last one last. */
    this.used = (localStorage.getItem(USED) ?? "").split(",");
    /** Has the back button of a phone close the newest panel, where the browser can. @type {any} */
    this.back = null;
    this.menu = element("menu");
    this.menu.ariaLabel = TEXTS.panels;
    this.menu.addEventListener("click", () => this.openMenu(this.menu.ariaExpanded !== "true"));
    this.dock = new Dock(element("dock"), page.dockWidth, () => this.trim());
    for (const group of groups) this.addGroup(group, page);
    this.arrange();
    this.reveal(this.used.at(-1) || groups[0].panels[0].name);
    addEventListener("keydown", (event) => event.key === "Escape" && this.escape(event));
    addEventListener("pointerdown", ({ target }) => {
      if (target instanceof Node && !bar.contains(target) && !this.menu.contains(target)) this.openMenu(false);
    });
  }

  /** @param {Group} group @param {import("./main.js").Page} page */
  addGroup({ label, icon, panels }, page) {
    const group = make("details");
    group.name = "group"; // the browser keeps one of them open
    const title = make("summary");
    title.append(drawIcon(icon), make("span", label));
    group.append(title);
    group.addEventListener("toggle", () => this.arrange());
    this.bar.append(group);
    for (const panel of panels) {
      const button = makePanelButton(panel, () => this.choose(panel.name));
      group.append(button);
      const box = make("aside", "", panel.wide ? "panel wide" : "panel");
      box.id = `${panel.name}-panel`;
      box.setAttribute("aria-label", panel.label);
      box.tabIndex = -1; // it has the focus when the control that had it was removed
      box.hidden = true;
      this.dock.box.append(box);
      box.append(this.makeHead(panel));
      const part = panel.make(box, page) ?? {};
      this.panels.set(panel.name, { box, button, group, part });
    }
  }

  /** In each group that is not seen now, put the buttons of the panels that were used last first. */
  arrange() {
    for (const name of this.used) {
      const { button, group } = this.panels.get(name) ?? {};
      if (button && !button.checkVisibility()) group?.firstElementChild?.after(button);
    }
  }

  /** Open the group of a panel in the list. @param {string} name */
  reveal(name) {
    const group = this.panels.get(name)?.group;
    if (group) group.open = true;
  }

  /** The title of a panel, and a button that closes it. @param {Panel} panel */
  makeHead(panel) {
    const head = make("div", "", "row head");
    const close = makeButton("\u00d7", () => this.close(panel.name), TEXTS.closePanel(panel.label));
    close.className = "close";
    const title = make("h2");
    title.append(makeButton(panel.label, () => this.show([...this.shown, panel.name])));
    head.append(title, close);
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
    const opened = this.shown.filter((name) => this.panels.get(name)?.box.hidden);
    if (opened.length) {
      this.used = [...this.used.filter((name) => !opened.includes(name)), ...opened];
      localStorage.setItem(USED, this.used.join());
      this.reveal(this.open);
    }
    for (const [name, { box, button, part }] of this.panels) {
      const open = this.isOpen(name);
      const changes = box.hidden === open;
      box.hidden = !open;
      box.style.order = String(this.shown.indexOf(name)); // the newest is the lowest
      box.style.flexShrink = String(100_000 ** (this.shown.length - 1 - this.shown.indexOf(name))); // the oldest gives room first
      button.setAttribute("aria-expanded", String(open));
      box.querySelector("h2 button")?.setAttribute("aria-expanded", String(name === this.open)); // older ones shrink to it
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
    this.reveal(name);
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
    const box = this.panels.get(name)?.box;
    if (box && name !== this.open && box.clientHeight < box.scrollHeight) this.show([...this.shown, name]); // it is cut: make it the newest
    else this.toggle(name);
    if (fromMenu) this.panels.get(this.open)?.box.focus();
  }

  /** @param {boolean} open */
  openMenu(open) {
    if ((this.menu.ariaExpanded === "true") === open) return;
    this.menu.ariaExpanded = String(open);
    document.body.toggleAttribute("data-menu", open);
    this.arrange();
    if (open) this.bar.querySelector("summary")?.focus();
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
  button.append(drawIcon(panel.icon), make("span", panel.label));
  return button;
}

/** @param {string} outline */
function drawIcon(outline) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true"); // the text beside it has the name
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", outline);
  svg.append(path);
  return svg;
}
