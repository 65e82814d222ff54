// @ts-check
/** Tools of the map: measure distances on it, turn it, and change its walls. */

import { make, makeButton, makeNote } from "./elements.js";
import { drawLabel } from "./overlays.js";
import { TEXTS } from "./texts.js";
import { NO_WALLS, WallTool } from "./walls.js";
import { KIND } from "./wire.js";

/** @type {import("./panels.js").Panel} */
export const MAP_PANEL = {
  name: "map_tools",
  label: TEXTS.mapTools.title,
  icon: "M3 17L17 3l4 4L7 21zM7 13l2 2M10 10l2 2M13 7l2 2",
  make: (box, page) => {
    const panel = new MapPanel(box, page);
    page.walls = panel.walls;
    page.frames.onJson(KIND.STATE, ({ map }) => panel.walls.take(map?.walls ?? NO_WALLS), {});
    return { show: (open) => !open && (panel.end(), panel.walls.pause()) };
  },
};

export class MapPanel {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page */
  constructor(box, page) {
    this.box = box;
    this.page = page;
    /** Points that are measured, m; null: none are taken. @type {[number, number][] | null} */
    this.points = null;
    this.note = makeNote();
    this.measure = makeButton(TEXTS.mapTools.measure, () => this.begin());
    this.measure.id = "measure";
    this.undo = makeButton(TEXTS.mapTools.undo, () => (this.points?.pop(), this.changed()));
    this.done = makeButton(TEXTS.mapTools.done, () => this.end());
    this.done.id = "measure-done";
    this.turn = makeButton(TEXTS.mapTools.turn, () => page.map.turn());
    this.turn.id = "map-turn";
    const row = make("div", "", "row");
    box.append(this.note, row);
    this.walls = new WallTool(box, page, () => this.refresh());
    row.append(this.measure, this.undo, this.done, this.turn, this.walls.begin, this.walls.restore);
    page.map.painters.push((context, view, colours) => this.paint(context, view, colours));
  }

  begin() {
    this.page.setMode("look");
    this.points = [];
    this.page.gestures.takeTaps(this.tap, () => this.end());
    this.changed();
    this.page.map.canvas.focus();
  }

  end() {
    if (!this.points) return;
    this.points = null;
    this.changed();
  }

  changed() {
    this.refresh();
    this.page.map.request();
  }

  refresh() {
    const { points, walls } = this;
    const { mayDrive } = this.page;
    const measuring = points !== null;
    const help = mayDrive ? TEXTS.mapTools.helpDriver : TEXTS.mapTools.help;
    this.note.hidden = !measuring && !walls.note.hidden;
    this.note.textContent = !measuring ? help : points.length < 2 ? TEXTS.mapTools.tap : TEXTS.mapTools.length(lengthOf(points));
    const busy = measuring || walls.active;
    this.measure.hidden = this.turn.hidden = busy;
    walls.begin.hidden = busy || !mayDrive;
    walls.restore.hidden = walls.begin.hidden || !walls.state.restorable;
    this.undo.hidden = this.done.hidden = !measuring;
    this.undo.disabled = !points?.length;
    this.box.classList.toggle("low", busy); // the map has to be seen
    if (!measuring) this.page.gestures.dropTaps(this.tap);
  }

  /** @param {number} x @param {number} y m */
  tap = (x, y) => {
    this.points?.push([x, y]);
    this.changed();
  };

  /** @param {CanvasRenderingContext2D} context @param {import("./view.js").View} view @param {Record<string, string>} colours */
  paint(context, view, colours) {
    const { points } = this;
    if (!points?.length) return;
    const seen = points.map((point) => view.toScreen(...point));
    context.lineJoin = "round";
    for (const [width, colour] of /** @type {[number, string][]} */ ([[6, colours["robot-edge"]], [2.5, colours.wall]])) {
      context.beginPath();
      for (const point of seen) context.lineTo(...point);
      context.lineWidth = width;
      context.strokeStyle = colour;
      context.stroke();
    }
    context.textAlign = "center";
    context.fillStyle = colours.wall;
    for (const [index, [x, y]] of seen.entries()) {
      context.beginPath();
      context.arc(x, y, 5, 0, 2 * Math.PI);
      context.fill();
      if (!index) continue;
      const text = TEXTS.metres(lengthOf(points.slice(index - 1, index + 1)));
      const [atX, atY] = [(x + seen[index - 1][0]) / 2, (y + seen[index - 1][1]) / 2 - 8];
      drawLabel(context, colours, text, colours.wall, atX, atY);
    }
    context.textAlign = "start";
  }
}

/** The length of a line, m. @param {[number, number][]} points */
export function lengthOf(points) {
  return points.slice(1).reduce((sum, [x, y], index) => sum + Math.hypot(x - points[index][0], y - points[index][1]), 0);
}
