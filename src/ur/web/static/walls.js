// @ts-check
/** Walls of the map in use: drawn as straight lines, erased with a brush, and saved in one step. */

import { make, makeButton, makeNote, makeSureButton } from "./elements.js";
import { makeLine, Rectangle } from "./rectangle.js";
import { TEXTS } from "./texts.js";

/**
 * `width` and points in m.
 * @typedef {{erase: boolean, width: number, points: [number, number][]}} Stroke
 * @typedef {{name: string, restorable: boolean, why: string}} WallState the map that can be changed; "" and why there is none
 */

const WIDTHS = [0.05, 0.1, 0.2, 0.4, 0.8, 1.6]; // m
const MOST_STROKES = 100; // as the server takes them
const LONGEST = 4000; // characters of a request
const PATIENCE = 15_000; // ms for an answer

export const NO_WALLS = /** @type {WallState} */ ({ name: "", restorable: false, why: "no server" });

export class WallTool {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page @param {() => void} onChange */
  constructor(box, page, onChange) {
    this.page = page;
    this.onChange = onChange;
    /** Takes what is drawn on the map. */
    this.active = false;
    this.waiting = 0; // the timer of a request
    this.state = NO_WALLS;
    /** The map that the strokes belong to. */
    this.map = "";
    /** @type {Stroke[]} */
    this.strokes = [];
    /** @type {Stroke | null} */
    this.stroke = null;
    this.erases = false;
    this.note = makeNote();
    this.begin = makeButton(TEXTS.walls.begin, () => this.open());
    this.begin.id = "walls-begin";
    this.restore = makeSureButton(TEXTS.walls.restore, () => this.send({ t: "restore_walls", map: this.state.name }));
    this.restore.id = "walls-restore";
    this.draw = makeButton(TEXTS.walls.draw, () => this.choose(false));
    this.erase = makeButton(TEXTS.walls.erase, () => this.choose(true));
    this.erase.id = "walls-erase";
    this.width = make("select");
    this.width.id = "walls-width";
    this.width.ariaLabel = TEXTS.walls.width;
    for (const width of WIDTHS) {
      const option = make("option", TEXTS.length(width));
      option.value = String(width);
      this.width.append(option);
    }
    this.width.value = String(WIDTHS[1]);
    this.undo = makeButton(TEXTS.mapTools.undo, () => (this.strokes.pop(), this.changed()));
    this.undo.id = "walls-undo";
    this.save = makeButton(TEXTS.walls.save, () => this.ask());
    this.save.id = "walls-save";
    this.save.className = "start";
    const stop = makeButton(TEXTS.cancel, () => ((this.strokes = []), this.pause()));
    stop.id = "walls-cancel";
    const where = () => (page.poseAge < 2 ? (page.pose ?? null) : null);
    this.line = new Rectangle(where, () => {}, TEXTS.walls.line, makeLine);
    this.line.box.append(makeButton(TEXTS.walls.add, () => this.type()));
    this.rows = make("div", "", "walls");
    const row = make("div", "", "row");
    row.append(this.draw, this.erase, this.width, this.undo, stop, this.save);
    this.rows.append(row, this.line.box);
    box.append(this.note, this.rows);
    page.map.painters.push((context, view, colours) => this.paint(context, view, colours));
  }

  /** @param {WallState} state */
  take(state) {
    this.state = state;
    if (state.name && state.name !== this.map && this.strokes.length) {
      this.strokes = [];
      this.page.say(TEXTS.walls.otherMap);
    }
    if (state.name) this.map = state.name;
    else if (this.active) this.pause();
    this.changed();
  }

  open() {
    if (!this.state.name) return void this.say(TEXTS.walls.why[this.state.why] ?? this.state.why);
    this.page.setMode("look");
    this.page.setFollow(false);
    this.active = true;
    this.page.gestures.takeTaps(this.tap, () => this.pause(), this.pen);
    this.choose(this.erases);
    this.page.map.canvas.focus();
  }

  /** Leave the map to others; what is not saved stays. */
  pause() {
    this.active = false;
    this.stroke = null;
    this.page.gestures.dropTaps(this.tap);
    this.line.clear();
    this.changed();
  }

  /** @param {boolean} erases */
  choose(erases) {
    this.erases = erases;
    this.changed();
  }

  changed() {
    const { active, erases, strokes, waiting } = this;
    const count = strokes.length;
    this.say(waiting ? TEXTS.walls.saving : active ? TEXTS.walls.help(erases, count) : count ? TEXTS.walls.unsaved(count) : "");
    this.rows.hidden = !active;
    this.draw.setAttribute("aria-pressed", String(!erases));
    this.erase.setAttribute("aria-pressed", String(erases));
    this.undo.disabled = !count || waiting !== 0;
    this.save.disabled = !count || waiting !== 0;
    this.restore.disabled = waiting !== 0;
    this.page.map.canvas.style.cursor = active ? "crosshair" : "";
    this.onChange();
    this.page.map.request();
  }

  /** @param {string} text */
  say(text) {
    if (this.note.textContent !== text) this.note.textContent = text;
    this.note.hidden = !text;
  }

  tap = () => {}; // the pen has it

  /** A finger or the mouse on the map: a wall is straight, what is erased follows it. @type {import("./gestures.js").Pen} */
  pen = (phase, x, y) => {
    if (this.waiting) return;
    const point = /** @type {[number, number]} */ ([round(x), round(y)]);
    const { stroke } = this;
    if (phase === "down") this.stroke = { erase: this.erases, width: Number(this.width.value), points: [point, point] };
    else if (phase === "drop") this.stroke = null;
    else if (stroke?.erase) extend(stroke, point);
    else if (stroke) stroke.points[1] = point;
    if (phase === "up" && stroke) this.put(stroke);
    this.page.map.request();
  };

  /** @param {Stroke} stroke */
  put(stroke) {
    this.stroke = null;
    const points = simplify(stroke.points, Math.max(0.01, stroke.width / 10));
    const strokes = [...this.strokes, { ...stroke, points }];
    if (strokes.length > MOST_STROKES || JSON.stringify(this.pack(strokes)).length > LONGEST) this.page.say(TEXTS.walls.full);
    else this.strokes = strokes;
    this.changed();
  }

  type() {
    const points = this.line.points();
    if (!points) return;
    this.put({ erase: this.erases, width: Number(this.width.value), points });
    this.line.clear();
    this.line.box.open = true;
  }

  /** @param {Stroke[]} strokes */
  pack(strokes) {
    const packed = strokes.map(({ erase, width, points }) => [Number(erase), width, ...points.flat()]);
    return { t: "draw_walls", map: this.map, strokes: packed };
  }

  ask() {
    if (this.strokes.length) this.send(this.pack(this.strokes));
  }

  /** @param {Record<string, unknown>} request */
  send(request) {
    if (!this.page.drive?.send(request)) return this.page.sayNotSent();
    this.waiting = setTimeout(() => this.answered({ t: "late" }), PATIENCE);
    this.changed();
  }

  /** Take the answer to a request. @param {{t: string, what?: string}} answer */
  answered({ t, what }) {
    clearTimeout(this.waiting);
    this.waiting = 0;
    if (t === "done" && what === "draw_walls") this.strokes = [];
    if (t === "done") this.pause();
    else this.changed();
    if (t === "done") this.say(what === "draw_walls" ? TEXTS.walls.saved : TEXTS.walls.restored);
    else if (t === "late") this.page.say(TEXTS.walls.late);
  }

  /** @param {CanvasRenderingContext2D} context @param {import("./view.js").View} view @param {Record<string, string>} colours */
  paint(context, view, colours) {
    context.lineCap = context.lineJoin = "round";
    for (const { erase, width, points } of this.stroke ? [...this.strokes, this.stroke] : this.strokes) {
      const [first, ...others] = points.map((point) => view.toScreen(...point));
      context.beginPath();
      context.moveTo(...first);
      for (const point of others) context.lineTo(...point);
      const size = Math.max(2, width * view.scale);
      for (const [wide, colour] of /** @type {[number, string][]} */ ([[size + 4, colours.goal], [size, erase ? colours.free : colours.wall]])) {
        context.lineWidth = wide;
        context.strokeStyle = colour;
        context.stroke();
      }
    }
    context.lineCap = "butt";
  }
}

/** Add a point where it is worth one. @param {Stroke} stroke @param {[number, number]} point */
function extend({ points, width }, point) {
  const [x, y] = points[points.length - 1];
  if (Math.hypot(point[0] - x, point[1] - y) > Math.max(0.02, width / 8)) points.push(point);
}

/** The points of a line that are farther than a tolerance from the line through the others. @param {[number, number][]} points @param {number} tolerance m @returns {[number, number][]} */
export function simplify(points, tolerance) {
  const [[x0, y0], [x1, y1]] = [points[0], points[points.length - 1]];
  const length = Math.hypot(x1 - x0, y1 - y0);
  let [far, most] = [0, tolerance];
  for (let index = 1; index < points.length - 1; index++) {
    const [x, y] = [points[index][0] - x0, points[index][1] - y0];
    const aside = length ? Math.abs((x1 - x0) * y - (y1 - y0) * x) / length : Math.hypot(x, y);
    if (aside > most) [far, most] = [index, aside];
  }
  if (!far) return [points[0], points[points.length - 1]];
  return [...simplify(points.slice(0, far + 1), tolerance).slice(0, -1), ...simplify(points.slice(far), tolerance)];
}

/** @param {number} metres to centimetres */
const round = (metres) => Math.round(100 * metres) / 100;
