// @ts-check
/** Zones of the map: areas to keep out of, and areas to drive slowly in. Shown, drawn corner by corner, deleted. */

import { checkName, make, makeButton, makeNote, makeSureButton, replaceRows, sentence } from "./elements.js";
import { drawLabel } from "./overlays.js";
import { Rectangle } from "./rectangle.js";
import { TEXTS } from "./texts.js";
import { KIND } from "./wire.js";

/**
 * `percent` of the highest speed, 0: keep out; corners in m.
 * @typedef {{name: string, percent: number, corners: [number, number][]}} Zone
 * @typedef {{served: boolean, zones: Zone[], problem: string}} ZoneList
 */

const NO_ZONES = /** @type {ZoneList} */ ({ served: false, zones: [], problem: "" });
const MOST_CORNERS = 32;
const NEAR = 24; // pixels from the first corner at which a tap closes the area

/** @type {import("./panels.js").Panel} */
export const ZONE_PANEL = {
  name: "zones",
  label: TEXTS.zones.title,
  icon: "M4 8l8-4 8 5-2 10-11 1zM7 12l9 5M6 16l6 3M9 8l9 5",
  make: (box, page) => {
    const panel = new ZonePanel(box, page);
    page.frames.onJson(KIND.ZONES, (found) => panel.take(found), NO_ZONES);
    return { show: (open) => !open && panel.cancel() };
  },
};

export class ZonePanel {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page */
  constructor(box, page) {
    this.box = box;
    this.page = page;
    this.found = NO_ZONES;
    /** Corners of the zone that is being drawn. @type {[number, number][] | null} */
    this.corners = null;
    this.typed = false;
    /** The name of a zone that Done replaces when it is pressed again. */
    this.sureOf = "";
    this.note = makeNote();
    this.list = make("ul");
    this.form = make("form", "", "stacked");
    this.name = make("input");
    this.name.id = "zone-name";
    this.name.placeholder = this.name.ariaLabel = TEXTS.zones.name;
    this.name.maxLength = 40;
    this.name.autocomplete = "off";
    this.name.autocapitalize = "off";
    this.kind = make("select");
    this.kind.id = "zone-kind";
    this.kind.ariaLabel = TEXTS.zones.kind;
    for (const percent of [0, 20, 40, 60, 80]) {
      const option = make("option", percent ? TEXTS.zones.slow(percent) : TEXTS.zones.keepOut);
      option.value = String(percent);
      this.kind.append(option);
    }
    this.kind.addEventListener("change", () => page.map.request());
    this.draw = makeButton(TEXTS.zones.draw, () => this.begin());
    this.draw.id = "zone-draw";
    this.undo = makeButton(TEXTS.zones.undo, () => this.back());
    this.done = make("button", TEXTS.zones.done);
    this.done.id = "zone-done";
    this.stop = makeButton(TEXTS.zones.cancel, () => this.cancel());
    const row = make("div", "", "row");
    row.append(this.draw, this.undo, this.stop, this.done);
    this.rectangle = new Rectangle(
      () => (page.poseAge < 2 ? (page.pose ?? null) : null),
      (corners) => this.type(corners),
    );
    this.form.append(this.name, this.kind, this.rectangle.box, row);
    this.form.addEventListener("submit", (event) => (event.preventDefault(), this.finish()));
    box.append(this.note, this.list, this.form);
    page.map.painters.push((context, view, colours) => this.paint(context, view, colours));
  }

  /** @param {ZoneList} found */
  take(found) {
    this.found = found;
    replaceRows(this.list, found.zones.map((zone) => this.makeRow(zone)));
    this.refresh();
    this.page.map.request();
  }

  refresh() {
    const { found, corners } = this;
    const drawing = corners !== null;
    const help = drawing
      ? TEXTS.zones.help(corners.length)
      : found.problem || (!found.served ? TEXTS.zones.notServed : found.zones.length ? "" : TEXTS.zones.none);
    this.note.textContent = sentence(help);
    this.note.hidden = !help;
    this.list.hidden = drawing;
    this.rectangle.box.hidden = !drawing;
    this.form.hidden = !this.page.mayDrive || !found.served;
    this.draw.hidden = drawing;
    this.undo.hidden = this.stop.hidden = this.done.hidden = !drawing;
    this.undo.disabled = !corners?.length;
    this.done.disabled = (corners?.length ?? 0) < 3;
    this.box.classList.toggle("low", drawing); // the map has to be seen
    if (!drawing) this.page.gestures.dropTaps(this.add);
  }

  /** @param {Zone} zone */
  makeRow(zone) {
    const row = make("li");
    const swatch = make("span", "", `swatch ${zone.percent ? "slow" : "keep-out"}`);
    const text = make("span", TEXTS.zones.row(zone.name, zone.percent), "grow");
    row.append(swatch, text);
    if (!this.page.mayDrive) return row;
    const remove = () => void this.send({ t: "delete_zone", zone: zone.name });
    row.append(makeSureButton(TEXTS.remove, remove, TEXTS.zones.remove(zone.name)));
    return row;
  }

  begin() {
    this.page.setMode("look");
    this.corners = [];
    this.page.gestures.takeTaps(this.add, () => this.cancel());
    this.rectangle.clear();
    this.refresh();
    this.page.map.canvas.focus();
  }

  /** @param {number} x @param {number} y m */
  add = (x, y) => {
    if (this.typed) this.corners = []; // another zone than the typed one
    this.typed = false;
    const { corners } = this;
    if (!corners) return;
    const { view } = this.page.map;
    if (corners.length > 2 && Math.hypot(corners[0][0] - x, corners[0][1] - y) * view.scale < NEAR) {
      this.finish();
      return;
    }
    if (corners.length < MOST_CORNERS) corners.push([round(x), round(y)]);
    this.changed();
  };

  /** Take corners that were typed, and show them all. @param {[number, number][]} corners */
  type(corners) {
    if (!this.corners) return;
    this.corners = corners;
    this.typed = true;
    const { map } = this.page;
    const hidden = corners.some((corner) => {
      const [x, y] = map.view.toScreen(...corner);
      return x < 0 || y < 0 || x > map.view.width || y > map.view.height;
    });
    if (hidden) {
      this.page.setFollow(false);
      map.fit();
    }
    this.changed();
  }

  back() {
    this.corners?.pop();
    this.typed = false;
    this.changed();
  }

  cancel() {
    this.corners = null;
    this.typed = false;
    this.sureOf = "";
    this.changed();
  }

  changed() {
    this.refresh();
    this.page.map.request();
  }

  finish() {
    const { corners } = this;
    if (!corners || corners.length < 3) return;
    const percent = Number(this.kind.value);
    const zone = this.name.value.trim() || freeName(percent ? "slow" : "keep-out", this.found.zones);
    const problem = checkName(zone);
    if (problem) {
      this.page.say(problem);
      return;
    }
    if (this.found.zones.some((each) => each.name === zone) && this.sureOf !== zone) {
      this.sureOf = zone;
      this.page.say(TEXTS.zones.taken(zone));
      return;
    }
    if (!this.send({ t: "put_zone", zone, percent, corners: corners.flat() })) return;
    this.name.value = "";
    this.name.blur();
    this.cancel();
  }

  /** @param {Record<string, unknown>} message */
  send(message) {
    const sent = this.page.drive?.send(message) ?? false;
    if (!sent) this.page.sayNotSent();
    return sent;
  }

  /** @param {CanvasRenderingContext2D} context @param {import("./view.js").View} view @param {Record<string, string>} colours */
  paint(context, view, colours) {
    for (const zone of this.found.zones) {
      const colour = colours[zone.percent ? "slow" : "keep-out"];
      outline(context, view, zone.corners, colour, true);
      if (view.scale < 12) continue;
      const count = zone.corners.length;
      const middle = [0, 1].map((axis) => zone.corners.reduce((sum, corner) => sum + corner[axis], 0) / count);
      const [x, y] = view.toScreen(middle[0], middle[1]);
      context.textAlign = "center";
      drawLabel(context, colours, TEXTS.zones.label(zone.name, zone.percent), colour, x, y + 4);
      context.textAlign = "start";
    }
    if (this.corners?.length) {
      const colour = colours[Number(this.kind.value) ? "slow" : "keep-out"];
      outline(context, view, this.corners, colour, this.corners.length > 2);
      for (const corner of this.corners) {
        context.beginPath();
        context.arc(...view.toScreen(...corner), 6, 0, 2 * Math.PI);
        context.fillStyle = colour;
        context.fill();
      }
    }
  }
}

/**
 * @param {CanvasRenderingContext2D} context @param {import("./view.js").View} view
 * @param {[number, number][]} corners @param {string} colour @param {boolean} closed
 */
export function outline(context, view, corners, colour, closed) {
  context.beginPath();
  for (const corner of corners) context.lineTo(...view.toScreen(...corner));
  if (closed) context.closePath();
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 2;
  context.stroke();
  if (!closed) return;
  context.globalAlpha *= 0.2;
  context.fill();
  context.globalAlpha /= 0.2;
}

/** @param {string} stem @param {Zone[]} zones */
function freeName(stem, zones) {
  const taken = new Set(zones.map((zone) => zone.name));
  for (let number = 1; ; number++) {
    const name = number === 1 ? stem : `${stem}-${number}`;
    if (!taken.has(name)) return name;
  }
}

/** @param {number} metres to centimetres */
const round = (metres) => Math.round(100 * metres) / 100;
