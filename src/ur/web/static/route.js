// @ts-check
/** A route of points that are tapped on the map, and the route of the patrol that the robot drives. */

import { make, makeButton, makeNote, sentence } from "./elements.js";
import { isOn } from "./patrol.js";
import { TEXTS } from "./texts.js";
import { KIND } from "./wire.js";

/**
 * `name` is "" for a point of the map. `next`: the robot drives there.
 * @typedef {{name: string, x: number, y: number, next?: boolean}} Stop
 */

const MOST_POINTS = 50; // as `MOST_STOPS` of the server
const RADIUS = 11; // pixels of a numbered point

/** @type {import("./panels.js").Panel} */
export const ROUTE_PANEL = {
  name: "route",
  label: TEXTS.route.title,
  icon: "M3 19a2 2 0 1 0 4 0a2 2 0 1 0-4 0M17 5a2 2 0 1 0 4 0a2 2 0 1 0-4 0M7 19h8a3.5 3.5 0 0 0 0-7H9a3.5 3.5 0 0 1 0-7h8",
  make: (box, page) => {
    const panel = new RoutePanel(box, page);
    page.frames.onJson(KIND.STATE, ({ patrol }) => panel.show(patrol ?? null), {});
    return { show: (open) => !open && panel.cancel() };
  },
};

export class RoutePanel {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page */
  constructor(box, page) {
    this.box = box;
    this.page = page;
    /** Points that are tapped, m; null: none are taken. @type {[number, number][] | null} */
    this.points = null;
    /** @type {import("./patrol.js").PatrolState | null} */
    this.patrol = null;
    this.note = makeNote();
    this.tapButton = makeButton(TEXTS.route.tap, () => this.begin());
    this.tapButton.id = "route-tap";
    this.undo = makeButton(TEXTS.route.undo, () => (this.points?.pop(), this.changed()));
    this.undo.id = "route-undo";
    this.clear = makeButton(TEXTS.route.clear, () => ((this.points = []), this.changed()));
    this.clear.id = "route-clear";
    this.stop = makeButton(TEXTS.cancel, () => this.cancel());
    this.start = makeButton(TEXTS.start, () => this.send());
    this.start.id = "route-start";
    this.end = makeButton(TEXTS.patrol.end, () => page.drive?.request({ t: "patrol", do: "end" }) || page.sayNotSent());
    this.end.id = "route-end";
    this.repeat = make("input");
    this.repeat.type = "checkbox";
    this.repeat.id = "route-repeat";
    this.repeat.addEventListener("change", () => page.map.request());
    this.label = make("label");
    this.label.append(this.repeat, TEXTS.patrol.repeat);
    const row = make("div", "", "row");
    row.append(this.tapButton, this.undo, this.clear, this.stop, this.start, this.end);
    box.append(this.note, this.label, row);
    page.map.painters.push((context, view, colours) => this.paint(context, view, colours));
    this.refresh();
  }

  /** Show the state of the robot's patrol. @param {import("./patrol.js").PatrolState | null} patrol null: no node drives patrols */
  show(patrol) {
    this.patrol = patrol;
    if (this.points?.length && isOn(patrol) && isSame(listStops(patrol), this.points)) this.points = null; // it drives
    this.changed();
  }

  begin() {
    this.page.setMode("look");
    this.points = [];
    this.page.gestures.takeTaps(this.tap, () => this.cancel());
    this.changed();
    this.page.map.canvas.focus();
  }

  cancel() {
    if (!this.points) return;
    this.points = null;
    this.changed();
  }

  /** Have the robot drive the route. The points stay until it does: a request may be refused. */
  send() {
    const { page, points } = this;
    if (!points || points.length < 2) return;
    if (!page.drive?.request({ t: "patrol", do: "start", places: points, loop: this.repeat.checked })) page.sayNotSent();
  }

  changed() {
    this.refresh();
    this.page.map.request();
  }

  refresh() {
    const { points, patrol } = this;
    const [tapping, on] = [points !== null, isOn(patrol)];
    this.note.textContent = this.describe();
    this.tapButton.hidden = tapping || on || !this.page.mayDrive;
    this.tapButton.disabled = !patrol;
    this.end.hidden = tapping || !on || !this.page.mayDrive;
    this.label.hidden = this.undo.hidden = this.clear.hidden = this.stop.hidden = this.start.hidden = !tapping;
    this.undo.disabled = this.clear.disabled = !points?.length;
    this.start.disabled = (points?.length ?? 0) < 2 || on || !patrol;
    this.box.classList.toggle("low", tapping); // the map has to be seen
    if (!tapping) this.page.gestures.dropTaps(this.tap);
  }

  /** The line of the panel. */
  describe() {
    const { points, patrol } = this;
    if (!patrol) return TEXTS.refused["no patrol"];
    if (isOn(patrol)) return sentence(patrol.line);
    return points ? TEXTS.route.points(points.length, MOST_POINTS) : TEXTS.route.help;
  }

  /** @param {number} x @param {number} y m */
  tap = (x, y) => {
    if (this.points && this.points.length < MOST_POINTS) this.points.push([round(x), round(y)]);
    this.changed();
  };

  /** @param {CanvasRenderingContext2D} context @param {import("./view.js").View} view @param {Record<string, string>} colours */
  paint(context, view, colours) {
    const { patrol, points } = this;
    if (patrol && isOn(patrol)) drawRoute(context, view, colours, listStops(patrol), patrol.loop);
    if (points) drawRoute(context, view, colours, points.map(([x, y]) => ({ name: "", x, y })), this.repeat.checked);
  }
}

/** The places of a patrol of which the coordinates are known. @param {import("./patrol.js").PatrolState | null} patrol @returns {Stop[]} */
export function listStops(patrol) {
  const stops = patrol?.stops ?? [];
  return stops.map(([name, x, y], index) => ({ name, x, y, next: index === patrol?.index })).filter(({ x, y }) => Number.isFinite(x) && Number.isFinite(y));
}

/** Whether a patrol drives to these points. @param {Stop[]} stops @param {[number, number][]} points */
export function isSame(stops, points) {
  const close = (/** @type {[number, number]} */ [x, y], /** @type {number} */ index) => Math.hypot(stops[index].x - x, stops[index].y - y) < 0.01;
  return stops.length === points.length && points.every(close);
}

/**
 * Draw the line of a route, and the number of each point that has no name.
 * @param {CanvasRenderingContext2D} context @param {import("./view.js").View} view @param {Record<string, string>} colours
 * @param {Stop[]} stops @param {boolean} loop
 */
function drawRoute(context, view, colours, stops, loop) {
  const seen = stops.map(({ x, y }) => view.toScreen(x, y));
  context.lineJoin = "round";
  for (const [width, colour] of /** @type {[number, string][]} */ ([[6, colours["robot-edge"]], [2.5, colours.place]])) {
    context.beginPath();
    for (const point of seen) context.lineTo(...point);
    if (loop && seen.length > 2) context.closePath();
    context.lineWidth = width;
    context.strokeStyle = colour;
    context.stroke();
  }
  context.font = "600 13px system-ui, sans-serif";
  context.textAlign = "center";
  context.lineWidth = 2;
  context.strokeStyle = colours["robot-edge"];
  for (const [index, [x, y]] of seen.entries()) {
    if (stops[index].name) continue; // the map has its name there
    context.beginPath();
    context.arc(x, y, RADIUS, 0, 2 * Math.PI);
    context.fillStyle = stops[index].next ? colours.goal : colours.place;
    context.fill();
    context.stroke();
    context.fillStyle = colours["robot-edge"];
    context.fillText(String(index + 1), x, y + 4.5);
  }
  context.textAlign = "start";
}

/** @param {number} metres to centimetres */
const round = (metres) => Math.round(100 * metres) / 100;
