// @ts-check
/** Assistants: what they ask for, and the grants to drive that they have. */

import { make, makeButton, makeNote } from "./elements.js";
import { Rectangle, readMetres } from "./rectangle.js";
import { TEXTS } from "./texts.js";
import { outline } from "./zones.js";

/**
 * `seconds` that are left, `speed` in m/s.
 * @typedef {{left: number, bottom: number, right: number, top: number, name: string}} Area m
 * @typedef {{seconds: number, speed: number, text: string, within: Area[], avoid: Area[], programs: boolean}} AssistantGrant
 * @typedef {{id: string, name: string, asks: {minutes: number, speed: number, reason: string} | null,
 *   grant: AssistantGrant | null}} Assistant
 */

const EVERY = 500; // ms, as often as the server reports them
const MOST_AREAS = 10;
const TEXT = TEXTS.assistants;

/** @type {import("./panels.js").Panel} */
export const ASSISTANT_PANEL = {
  name: "assistants",
  label: TEXT.title,
  icon: "M5 9h14v9H5zM12 9V5M9 4h6M9 13h.01M15 13h.01M2 12v3M22 12v3",
  make: (box, page) => {
    const panel = new AssistantPanel(box, page);
    let timer = 0;
    return {
      show: (open) => {
        clearInterval(timer);
        if (open) {
          panel.show();
          timer = setInterval(() => panel.show(), EVERY);
        } else panel.hide();
      },
    };
  },
};

/** Lines above the map about assistants that ask, or may drive. @param {import("./main.js").Page} page @returns {import("./banners.js").Banner[]} */
export function describeAssistants(page) {
  const banners = [];
  for (const { id, name, asks, grant } of listAssistants(page)) {
    const end = { label: TEXT.takeBack, act: () => void endGrant(page, id) };
    if (grant) banners.push({ text: TEXT.mayDrive(name, grant), buttons: [end] });
    else if (asks) {
      const answer = { label: TEXT.answer, act: () => page.panels.isOpen("assistants") || page.panels.toggle("assistants") };
      banners.push({ text: TEXT.asks(name, asks), buttons: page.mayDrive ? [answer] : [] });
    }
  }
  return banners;
}

/** @param {import("./main.js").Page} page @returns {Assistant[]} */
const listAssistants = (page) => page.server?.assistants ?? [];

/** @param {import("./main.js").Page} page @param {string} id */
async function endGrant(page, id) {
  const answer = await send("end", { id });
  if (!answer.ok) page.say(answer.text, true);
}

class AssistantPanel {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page */
  constructor(box, page) {
    this.page = page;
    this.note = makeNote();
    this.list = make("ul");
    this.drawn = "";
    /** The assistant that the form is about. */
    this.chosen = "";
    /** Areas that the form has: `only` inside, or kept out of. @type {{area: Area, only: boolean}[]} */
    this.areas = [];
    this.form = make("form", "", "stacked");
    this.form.id = "assistant-grant";
    this.title = make("h3");
    this.minutes = makeNumber(TEXT.minutes, "assistant-minutes");
    this.speed = makeNumber(TEXT.speed, "assistant-speed");
    this.places = make("ul");
    this.name = make("input");
    this.name.placeholder = this.name.ariaLabel = TEXT.areaName;
    this.name.maxLength = 40;
    this.name.autocomplete = "off";
    /** @type {[number, number][] | null} */
    this.corners = null;
    this.rectangle = new Rectangle(() => (page.poseAge < 2 ? (page.pose ?? null) : null), (corners) => this.mark(corners));
    this.only = makeButton(TEXT.onlyHere, () => this.addArea(true));
    this.never = makeButton(TEXT.notHere, () => this.addArea(false));
    const area = make("fieldset", "", "stacked");
    const row = make("div", "", "row");
    row.append(this.only, this.never);
    area.append(make("legend", TEXT.area), this.places, makeButton(TEXT.pick, () => this.pick()), this.rectangle.box, this.name, row);
    this.programs = make("input");
    this.programs.type = "checkbox";
    const programs = make("label");
    programs.append(this.programs, ` ${TEXT.programs}`);
    const buttons = make("div", "", "row");
    buttons.append(make("button", TEXT.give), makeButton(TEXT.refuse, () => this.refuse()));
    const limits = make("div", "", "sides");
    limits.append(label(TEXT.minutes, this.minutes), label(TEXT.speed, this.speed));
    this.form.append(this.title, limits, area, programs, buttons);
    this.form.addEventListener("submit", (event) => (event.preventDefault(), void this.give()));
    box.append(this.note, this.list, this.form);
    page.map.painters.push((context, view, colours) => this.paint(context, view, colours));
    this.choose(null);
    this.refresh();
  }

  /** Show the assistants that there are. */
  show() {
    const found = listAssistants(this.page);
    const key = JSON.stringify(found.map(({ id, name, asks, grant }) => [id, name, asks, grant?.text]));
    for (const { id, grant } of found) {
      const left = document.getElementById(`assistant-left-${id}`);
      if (left && grant) left.textContent = TEXT.left(grant.seconds);
    }
    if (key === this.drawn) return;
    this.drawn = key;
    this.note.textContent = found.length ? "" : TEXT.none;
    this.note.hidden = found.length > 0;
    this.list.replaceChildren(...found.map((each) => this.makeRow(each)));
    const asking = found.find(({ asks, grant }) => asks && !grant);
    if (!found.some(({ id }) => id === this.chosen)) this.choose(null);
    if (asking && !this.chosen) this.choose(asking);
    this.page.map.request();
  }

  /** Leave no drawing. */
  hide() {
    this.choose(null);
    this.drawn = "";
  }

  /** @param {Assistant} assistant */
  makeRow(assistant) {
    const { id, name, asks, grant } = assistant;
    const row = make("li");
    const text = make("span", "", "grow");
    const left = make("small", grant ? TEXT.left(grant.seconds) : "");
    left.id = `assistant-left-${id}`;
    text.append(make("b", name), make("br"), make("small", grant ? grant.text : asks ? TEXT.wants(asks) : TEXT.looks), make("br"), left);
    row.append(text);
    if (grant) row.append(makeButton(TEXT.takeBack, () => void endGrant(this.page, id), TEXT.takeBackOf(name)));
    else if (this.page.mayDrive) row.append(makeButton(TEXT.letDrive, () => this.choose(assistant), TEXT.letDriveOf(name)));
    return row;
  }

  /** Open the form for an assistant, with what it asks for; null: close it. @param {Assistant | null} assistant */
  choose(assistant) {
    this.chosen = assistant && this.page.mayDrive ? assistant.id : "";
    this.form.hidden = !this.chosen;
    this.areas = [];
    this.mark(null);
    if (!assistant) return;
    this.title.textContent = TEXT.letDriveOf(assistant.name);
    this.minutes.value = String(assistant.asks?.minutes ?? 30);
    this.speed.value = String(assistant.asks?.speed ?? 0.2);
    this.programs.checked = false;
    this.refresh();
  }

  /** Have the user point at two opposite corners. */
  pick() {
    this.page.pick(TEXT.firstCorner, ({ x, y }) =>
      this.page.pick(TEXT.secondCorner, (other) => {
        this.mark([[x, y], [other.x, y], [other.x, other.y], [x, other.y]]);
        if (!this.page.panels.isOpen("assistants")) this.page.panels.toggle("assistants");
      }));
  }

  /** @param {[number, number][] | null} corners of the area that is to be added */
  mark(corners) {
    this.corners = corners;
    this.only.disabled = this.never.disabled = !corners || this.areas.length >= MOST_AREAS;
    this.page.map.request();
  }

  /** @param {boolean} only */
  addArea(only) {
    if (!this.corners) return;
    const [xs, ys] = [0, 1].map((axis) => this.corners?.map((corner) => corner[axis]) ?? []);
    const name = this.name.value.trim();
    const area = { left: round(Math.min(...xs)), bottom: round(Math.min(...ys)), right: round(Math.max(...xs)), top: round(Math.max(...ys)), name };
    this.areas.push({ area, only });
    this.name.value = "";
    this.rectangle.clear();
    this.mark(null);
    this.refresh();
  }

  /** Show the areas of the form. */
  refresh() {
    this.places.replaceChildren(...this.areas.map((each) => {
      const row = make("li");
      const text = each.only ? TEXT.only(each.area) : TEXT.not(each.area);
      const remove = makeButton(TEXTS.remove, () => {
        this.areas = this.areas.filter((other) => other !== each);
        this.mark(this.corners);
        this.refresh();
      }, `${TEXTS.remove}: ${text}`);
      row.append(make("span", text, "grow"), remove);
      return row;
    }));
  }

  async give() {
    const [minutes, speed] = [this.minutes, this.speed].map((field) => readMetres(field.value));
    if (!minutes || !speed) return this.page.say(TEXT.noNumbers);
    const pick = (/** @type {boolean} */ only) => this.areas.filter((each) => each.only === only).map(({ area }) => area);
    const answer = await send("grant", {
      id: this.chosen, minutes, speed, within: pick(true), avoid: pick(false), programs: this.programs.checked,
    });
    if (!answer.ok) return this.page.say(answer.text, true);
    this.choose(null);
  }

  async refuse() {
    const id = this.chosen;
    this.choose(null);
    await endGrant(this.page, id);
  }

  /** @param {CanvasRenderingContext2D} context @param {import("./view.js").View} view @param {Record<string, string>} colours */
  paint(context, view, colours) {
    const granted = listAssistants(this.page).flatMap(({ grant }) => [
      ...(grant?.within ?? []).map((area) => ({ area, only: true })),
      ...(grant?.avoid ?? []).map((area) => ({ area, only: false })),
    ]);
    for (const { area, only } of [...granted, ...this.areas]) {
      const corners = /** @type {[number, number][]} */ ([[area.left, area.bottom], [area.right, area.bottom], [area.right, area.top], [area.left, area.top]]);
      outline(context, view, corners, colours[only ? "slow" : "keep-out"], true);
    }
    if (this.corners) outline(context, view, this.corners, colours.slow, true);
  }
}

/** @param {string} what @param {Record<string, unknown>} value @returns {Promise<{ok: boolean, text: string}>} */
async function send(what, value) {
  const answer = await fetch(`/api/assistants/${what}`, { method: "POST", body: JSON.stringify(value) }).catch(() => null);
  return { ok: answer?.ok ?? false, text: answer ? await answer.text() : TEXTS.noAnswer };
}

/** @param {string} title @param {string} id */
function makeNumber(title, id) {
  const field = make("input");
  field.id = id;
  field.inputMode = "decimal";
  field.maxLength = 6;
  field.autocomplete = "off";
  field.ariaLabel = title;
  return field;
}

/** @param {string} text @param {HTMLElement} field */
function label(text, field) {
  const line = make("label", text, "stacked");
  line.append(field);
  return line;
}

/** @param {number} metres to centimetres */
const round = (metres) => Math.round(100 * metres) / 100;
