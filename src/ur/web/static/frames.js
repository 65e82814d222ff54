// @ts-check
/** Frames of the server by their kind: each part of the page takes those that it shows. */

import { KIND, LAYER, readGrid, readJson, readPoints, readTile } from "./wire.js";

/** @typedef {(frame: import("./wire.js").Frame) => void} FrameHandler */

export class FrameHandlers {
  constructor() {
    /** @type {Map<number, FrameHandler[]>} */
    this.handlers = new Map();
    /** Have parts of the page show that nothing runs. @type {(() => void)[]} */
    this.forgets = [];
  }

  /** Have a function called with each frame of a kind. @param {number} kind @param {FrameHandler} handler */
  on(kind, handler) {
    this.handlers.set(kind, [...(this.handlers.get(kind) ?? []), handler]);
  }

  /** Have a function called with each value of a kind, and with `nothing` while nothing runs. @param {number} kind @param {(value: any) => void} handler @param {any} [nothing] */
  onJson(kind, handler, nothing) {
    this.on(kind, (frame) => handler(readJson(frame)));
    if (!nothing) return;
    this.forgets.push(() => handler(nothing));
    handler(nothing);
  }

  /** @param {import("./wire.js").Frame} frame */
  take(frame) {
    for (const handler of this.handlers.get(frame.kind) ?? []) handler(frame);
  }
}

/** Have a map show points, grids and tiles. @param {FrameHandlers} frames @param {import("./map_view.js").MapView} map */
export function showOnMap(frames, map) {
  frames.on(KIND.POINTS, (frame) => {
    const points = readPoints(frame);
    if (frame.layer === LAYER.SCAN) map.scan = points;
    if (frame.layer === LAYER.PLAN) map.plan = points;
    if (frame.layer === LAYER.PARTICLES) map.particles = points;
    map.request();
  });
  frames.on(KIND.GRID, (frame) => map.setGrid(frame.layer, readGrid(frame)));
  frames.on(KIND.TILE, async (frame) => {
    const { generation, cells } = await readTile(frame);
    map.tilesOf(frame.layer)?.setTile(frame.x, frame.y, generation, cells);
    map.request();
  });
}
