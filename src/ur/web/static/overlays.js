// @ts-check
/** Small things over the map: sonars, other robots, fiducials, frontiers, the spread of the pose, and the robot's trail. */

import { KIND, LAYER, readJson } from "./wire.js";

const TRAIL_STEP = 0.05; // m between two points of the trail
const TRAIL_JUMP = 1; // m: the localiser has corrected itself, or the robot was carried
const MOST_TRAIL = 4000;

/** @typedef {CanvasRenderingContext2D} Context @typedef {import("./view.js").View} View @typedef {Record<string, string>} Colours */

export class Overlays {
  /** @param {import("./frames.js").FrameHandlers} frames @param {import("./map_view.js").MapView} map */
  constructor(frames, map) {
    this.map = map;
    /** What the robot's end has sent, by layer. @type {Map<number, any>} */
    this.found = new Map();
    /** @type {([number, number] | null)[]} null: a gap */
    this.trail = [];
    frames.on(KIND.OVERLAY, (frame) => {
      this.found.set(frame.layer, readJson(frame));
      map.request();
    });
    map.painters.push((context, view, colours) => this.paint(context, view, colours));
  }

  /** Lengthen the trail. @param {import("./wire.js").Pose} pose */
  follow(pose) {
    if (!Number.isFinite(pose.x)) return;
    const last = this.trail.at(-1);
    const step = last ? Math.hypot(pose.x - last[0], pose.y - last[1]) : Infinity;
    if (step < TRAIL_STEP) return;
    if (last && step > TRAIL_JUMP) this.trail.push(null);
    this.trail.push([pose.x, pose.y]);
    if (this.trail.length > MOST_TRAIL) this.trail.splice(0, this.trail.length - MOST_TRAIL);
  }

  /** @param {Context} context @param {View} view @param {Colours} colours */
  paint(context, view, colours) {
    const { layers } = this.map;
    for (const [name, draw] of Object.entries(DRAW)) {
      if (layers.has(name)) draw(context, view, colours, name === "trail" ? { trail: this.trail } : this.found.get(numberOf(name)) ?? {});
    }
  }
}

/** How each layer is drawn from the value of `ur_nodes.web.layers.overlays`, the lowest first.
 * @type {Record<string, (context: Context, view: View, colours: Colours, value: any) => void>} */
const DRAW = {
  frontiers: (context, view, colours, value) => drawFrontiers(context, view, colours, value.frontiers ?? []),
  trail: (context, view, colours, value) => drawTrail(context, view, colours.trail, value.trail),
  fiducials: (context, view, colours, value) => drawFiducials(context, view, colours, value.marks ?? []),
  sonars: (context, view, colours, value) => drawCones(context, view, colours.sonars, value.cones ?? []),
  covariance: (context, view, colours, value) => drawSpread(context, view, colours.covariance, value),
  robots: (context, view, colours, value) => drawRobots(context, view, colours, value.robots ?? {}),
};

/** @param {string} name */
function numberOf(name) {
  return LAYER[/** @type {keyof typeof LAYER} */ (name.toUpperCase())];
}

/** @param {Context} context @param {View} view @param {string} colour @param {([number, number] | null)[]} trail */
function drawTrail(context, view, colour, trail) {
  context.beginPath();
  let gap = true;
  for (const point of trail) {
    if (point && gap) context.moveTo(...view.toScreen(...point));
    else if (point) context.lineTo(...view.toScreen(...point));
    gap = point === null;
  }
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.lineJoin = "round";
  context.setLineDash([6, 4]);
  context.stroke();
  context.setLineDash([]);
}

/** Cones of x, y, yaw, range, field of view, 1 for an echo. @param {Context} context @param {View} view @param {string} colour @param {number[][]} cones */
function drawCones(context, view, colour, cones) {
  const before = context.globalAlpha;
  for (const [px, py, yaw, range, width, echo] of cones) {
    const [x, y] = view.toScreen(px, py);
    const angle = view.toAngle(yaw);
    const [from, to] = [-angle - width / 2, -angle + width / 2];
    context.fillStyle = context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(x, y);
    context.arc(x, y, range * view.scale, from, to);
    context.closePath();
    context.globalAlpha = before * (echo ? 0.3 : 0.1);
    context.fill();
    if (!echo) continue;
    context.globalAlpha = before;
    context.lineWidth = 3;
    context.beginPath();
    context.arc(x, y, range * view.scale, from, to);
    context.stroke();
  }
  context.globalAlpha = before;
}

/** The area in which the robot is with 95 %. @param {Context} context @param {View} view @param {string} colour @param {{at?: number[], spread?: number[]}} found */
function drawSpread(context, view, colour, { at, spread }) {
  if (!at || !spread) return;
  const [xx, xy, yy] = spread;
  const [mean, half] = [(xx + yy) / 2, Math.hypot((xx - yy) / 2, xy)];
  const axes = [mean + half, mean - half].map((each) => 2.45 * Math.sqrt(Math.max(0, each)) * view.scale);
  context.beginPath();
  const angle = view.toAngle(Math.atan2(2 * xy, xx - yy) / 2);
  context.ellipse(...view.toScreen(at[0], at[1]), Math.max(2, axes[0]), Math.max(2, axes[1]), -angle, 0, 2 * Math.PI);
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 2;
  context.stroke();
  context.globalAlpha *= 0.2;
  context.fill();
  context.globalAlpha /= 0.2;
}

/** @param {Context} context @param {View} view @param {Colours} colours @param {[number, number, number][]} marks */
function drawFiducials(context, view, colours, marks) {
  const size = Math.max(9, 0.15 * view.scale);
  for (const [id, px, py] of marks) {
    const [x, y] = view.toScreen(px, py);
    context.fillStyle = colours.fiducials;
    context.strokeStyle = colours["robot-edge"];
    context.lineWidth = 2;
    context.fillRect(x - size / 2, y - size / 2, size, size);
    context.strokeRect(x - size / 2, y - size / 2, size, size);
    drawLabel(context, colours, String(id), colours.fiducials, x + size / 2 + 3, y + 4);
  }
}

/** 1 for one that was given up, then x, y, ... @param {Context} context @param {View} view @param {Colours} colours @param {number[][]} frontiers */
function drawFrontiers(context, view, colours, frontiers) {
  const size = Math.max(4, 0.08 * view.scale);
  for (const [blocked, ...points] of frontiers) {
    context.fillStyle = colours[blocked ? "given-up" : "frontiers"];
    for (let index = 0; index < points.length; index += 2) {
      const [x, y] = view.toScreen(points[index], points[index + 1]);
      context.fillRect(x - size / 2, y - size / 2, size, size);
    }
  }
}

/** x, y, yaw by name. @param {Context} context @param {View} view @param {Colours} colours @param {Record<string, number[]>} robots */
function drawRobots(context, view, colours, robots) {
  const size = Math.max(10, 0.25 * view.scale);
  for (const [name, [px, py, yaw]] of Object.entries(robots)) {
    const [x, y] = view.toScreen(px, py);
    context.save();
    context.translate(x, y);
    context.rotate(-view.toAngle(yaw));
    context.beginPath();
    for (const [along, across] of [[1, 0], [-0.7, 0.7], [-0.35, 0], [-0.7, -0.7]]) context.lineTo(along * size, across * size);
    context.closePath();
    context.fillStyle = colours.robots;
    context.strokeStyle = colours["robot-edge"];
    context.lineWidth = 2;
    context.fill();
    context.stroke();
    context.restore();
    drawLabel(context, colours, name, colours.robots, x + size + 4, y + 4);
  }
}

/** Write on the map. @param {Context} context @param {Colours} colours @param {string} text @param {string} colour @param {number} x @param {number} y */
export function drawLabel(context, colours, text, colour, x, y) {
  context.font = "600 13px system-ui, sans-serif";
  context.lineJoin = "round";
  context.lineWidth = 4;
  context.strokeStyle = colours["robot-edge"];
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
}
