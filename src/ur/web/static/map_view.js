// @ts-check
/** The map on the canvas: tiles, plan, scan, goal and robot. Draws only when something has changed. */

import { MapTiles } from "./map_tiles.js";
import { View } from "./view.js";
import { SWITCHES } from "./link_state.js";
import { drawLabel } from "./overlays.js";
import { LAYER } from "./wire.js";

/** Of `style.css`, beside those of the layers. */
const COLOURS = ["unknown", "free", "wall", "goal", "place", "keep-out", "slow", "robot", "robot-edge", "given-up"];

/** `dragged`: the user has drawn the heading. @typedef {{x: number, y: number, yaw: number | null, dragged?: boolean}} Place */

const LABEL = 16; // pixels of its height
const LONGEST_LABEL = 24; // characters of a name on the map

export class MapView {
  /** @param {HTMLCanvasElement} canvas @param {() => number[]} edges pixels of controls: left, right, above, below */
  constructor(canvas, edges) {
    this.canvas = canvas;
    this.edges = edges;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
    this.view = new View();
    this.tiles = new MapTiles();
    /** @type {import("./wire.js").Pose | null} */
    this.pose = null;
    /** Costmaps, the one below first. @type {Record<string, MapTiles>} */
    this.costs = { global: new MapTiles(true), local: new MapTiles(true) };
    /** Names of the layers that are shown. @type {Set<string>} */
    this.layers = new Set();
    this.particles = new Float32Array();
    this.scan = new Float32Array();
    this.plan = new Float32Array();
    /** @type {Place | null} */
    this.goal = null;
    /** What the user is about to point at. @type {Place | null} */
    this.pointed = null;
    /** @type {number[][]} */
    this.outline = [];
    /** x, y, yaw by name. @type {Record<string, [number, number, number]>} */
    this.places = {};
    /** Draw more on the map, below the robot. @type {((context: CanvasRenderingContext2D, view: View, colours: Record<string, string>) => void)[]} */
    this.painters = [];
    this.follow = false;
    this.old = false;
    this.fitted = false;
    /** The user has not moved the map: the whole of it stays in view. */
    this.whole = true;
    this.drawn = 0;
    /** @type {Record<string, string>} */
    this.colours = {};
    this.due = false;
    new ResizeObserver(() => (this.resize(), this.draw())).observe(canvas); // it was emptied: the next frame would be black
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.readColours());
    this.readColours();
    this.resize();
  }

  readColours() {
    const style = getComputedStyle(document.documentElement);
    for (const name of [...SWITCHES, ...COLOURS]) {
      this.colours[name] = style.getPropertyValue(`--map-${name}`).trim();
    }
    this.tiles.setColours(this.colours.unknown, this.colours.free, this.colours.wall);
    for (const [name, tiles] of Object.entries(this.costs)) tiles.setCostColour(this.colours[name]);
    this.request();
  }

  resize() {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    this.view.width = this.canvas.clientWidth;
    this.view.height = this.canvas.clientHeight;
    this.canvas.width = Math.round(this.view.width * ratio);
    this.canvas.height = Math.round(this.view.height * ratio);
    this.ratio = ratio;
    if (this.whole) this.fit();
    this.request();
  }

  /** @param {number} layer @returns {MapTiles | null} */
  tilesOf(layer) {
    if (layer === LAYER.MAP) return this.tiles;
    return layer === LAYER.GLOBAL ? this.costs.global : layer === LAYER.LOCAL ? this.costs.local : null;
  }

  /** Show a point in the middle: x, y in m, pixels a metre. @param {number[]} at @param {boolean} turned */
  show([x, y, scale], turned = false) {
    this.whole = false;
    this.fitted = true;
    Object.assign(this.view, { x, y, turned });
    this.view.scale = Math.min(400, Math.max(1, scale));
    this.request();
  }

  /** @param {number} layer @param {import("./wire.js").Grid} grid */
  setGrid(layer, grid) {
    this.tilesOf(layer)?.setGrid(grid);
    if (layer === LAYER.MAP && (!this.fitted || this.whole)) this.fit();
    this.request();
  }

  fit() {
    const bounds = this.tiles.bounds();
    if (!bounds || this.view.width < 2) return;
    this.fitted = this.whole = true;
    this.view.fit(bounds, this.edges(), innerHeight > innerWidth);
    this.request();
  }

  /** Turn what is shown by 90 degrees, or back. */
  turn() {
    this.whole = false;
    this.view.turned = !this.view.turned;
    this.request();
  }

  /** @param {import("./wire.js").Pose} pose */
  setPose(pose) {
    this.pose = Number.isFinite(pose.x) ? pose : null;
    this.request();
  }

  /** Remove all but the map. */
  forget() {
    this.pose = this.goal = null;
    this.scan = this.plan = this.particles = new Float32Array();
    this.request();
  }

  request() {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.draw();
    });
  }

  draw() {
    const { context, view, colours } = this;
    if (this.follow && this.pose && !this.pointed) [view.x, view.y] = [this.pose.x, this.pose.y];
    context.setTransform(this.ratio ?? 1, 0, 0, this.ratio ?? 1, 0, 0);
    context.fillStyle = colours.unknown;
    context.fillRect(0, 0, view.width + 1, view.height + 1); // the last pixels of the canvas may be halves of ours
    this.tiles.draw(context, view);
    context.globalAlpha = this.old ? 0.4 : 1;
    for (const [name, tiles] of Object.entries(this.costs)) if (this.layers.has(name)) tiles.draw(context, view);
    for (const paint of this.painters) paint(context, view, colours);
    if (this.layers.has("particles")) this.drawPoints(this.particles, colours.particles);
    if (this.layers.has("plan")) this.drawPlan();
    if (this.layers.has("scan")) this.drawPoints(this.scan, colours.scan);
    this.drawPlaces();
    if (this.goal) this.drawArrow(this.goal, colours.goal, 0.4);
    this.drawRobot();
    context.globalAlpha = 1;
    if (this.pointed) this.drawArrow(this.pointed, colours.goal, 0.6);
    this.drawn += 1;
  }

  drawPlan() {
    const { context, plan } = this;
    if (plan.length < 4) return;
    context.beginPath();
    for (let index = 0; index < plan.length; index += 2) context.lineTo(...this.view.toScreen(plan[index], plan[index + 1]));
    context.strokeStyle = this.colours.plan;
    context.lineWidth = 3;
    context.lineJoin = "round";
    context.stroke();
  }

  /** @param {Float32Array} points @param {string} colour */
  drawPoints(points, colour) {
    const { context, view } = this;
    const size = Math.max(2.5, Math.min(6, 0.04 * view.scale));
    context.fillStyle = colour;
    for (let index = 0; index < points.length; index += 2) {
      const [x, y] = view.toScreen(points[index], points[index + 1]);
      context.fillRect(x - size / 2, y - size / 2, size, size);
    }
  }

  drawPlaces() {
    const { context, view, colours } = this;
    context.font = "600 13px system-ui, sans-serif";
    const taken = Object.values(this.places).map(([px, py]) => view.toScreen(px, py)).map(([x, y]) => [x - 7, y, 14]);
    for (const [name, [px, py, yaw]] of Object.entries(this.places)) {
      const [x, y] = view.toScreen(px, py);
      if (x < -200 || y < -20 || x > view.width + 20 || y > view.height + 20) continue;
      const [along, across] = [Math.cos(view.toAngle(yaw)), -Math.sin(view.toAngle(yaw))];
      for (const [width, colour] of /** @type {[number, string][]} */ ([[5, colours["robot-edge"]], [2.5, colours.place]])) {
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.beginPath();
        context.arc(x, y, 5, 0, 2 * Math.PI);
        context.moveTo(x + 5 * along, y + 5 * across);
        context.lineTo(x + 12 * along, y + 12 * across);
        context.stroke();
      }
      const text = name.length > LONGEST_LABEL ? `${name.slice(0, LONGEST_LABEL - 1)}\u2026` : name;
      const [left, middle] = placeLabel(x, y, context.measureText(text).width, taken, view.width);
      drawLabel(context, colours, text, colours.place, left, middle + 4);
    }
  }

  drawRobot() {
    const { context, view, pose, outline } = this;
    if (!pose || !outline.length) return;
    const [x, y] = view.toScreen(pose.x, pose.y);
    const reach = Math.max(...outline.map((corner) => Math.hypot(...corner)));
    const scale = Math.max(view.scale, 9 / reach); // seen from far away, too
    context.save();
    context.translate(x, y);
    context.rotate(-view.toAngle(pose.yaw));
    context.beginPath();
    for (const corner of outline) context.lineTo(corner[0] * scale, -corner[1] * scale);
    context.closePath();
    context.fillStyle = this.colours.robot;
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = this.colours["robot-edge"];
    context.stroke();
    const tip = reach * scale;
    context.beginPath();
    context.moveTo(0.65 * tip, 0);
    context.lineTo(-0.25 * tip, 0.4 * tip);
    context.lineTo(-0.05 * tip, 0);
    context.lineTo(-0.25 * tip, -0.4 * tip);
    context.closePath();
    context.fillStyle = this.colours["robot-edge"];
    context.fill();
    context.restore();
  }

  /** @param {Place} place @param {string} colour @param {number} metres */
  drawArrow(place, colour, metres) {
    const { context, view } = this;
    const length = Math.max(34, metres * view.scale);
    context.save();
    context.translate(...view.toScreen(place.x, place.y));
    context.rotate(-view.toAngle(place.yaw ?? 0));
    context.lineCap = context.lineJoin = "round";
    for (const [width, stroke] of /** @type {[number, string][]} */ ([[8, this.colours["robot-edge"]], [4, colour]])) {
      context.lineWidth = width;
      context.strokeStyle = stroke;
      context.beginPath();
      context.arc(0, 0, 7, 0, 2 * Math.PI);
      if (place.yaw !== null) {
        context.moveTo(9, 0);
        context.lineTo(length, 0);
        context.moveTo(length - 10, -8);
        context.lineTo(length, 0);
        context.lineTo(length - 10, 8);
      }
      context.stroke();
    }
    context.restore();
  }
}

/** Left end and middle of a label beside a point, where it lies on nothing that is `taken` and before the edge, if it can. @param {number} x @param {number} y @param {number} width @param {number[][]} taken left, middle and width of each @param {number} edge */
export function placeLabel(x, y, width, taken, edge) {
  const spots = [[x + 15, y], [x - 15 - width, y], [x - width / 2, y - 20], [x - width / 2, y + 20]];
  const free = spots.find(([left, middle]) => left > 0 && left + width < edge && !taken.some(([l, m, w]) => left < l + w && l < left + width && Math.abs(m - middle) < LABEL));
  taken.push([...(free ?? spots[0]), width]);
  return free ?? spots[0];
}
