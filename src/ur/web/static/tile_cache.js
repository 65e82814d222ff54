// @ts-check
/**
 * A picture of the tiles as a far view shows them: panning copies it, instead of scaling hundreds of tiles each frame.
 *
 * It reaches beyond the view by a margin, and is made when two frames in a row show the same tiles at the same scale:
 * while the user zooms, or while tiles arrive, it would be used only once.
 */

import { View } from "./view.js";

const MARGIN = 256; // pixels beyond each edge of the view

/** @typedef {(context: CanvasRenderingContext2D, view: View) => void} Paint */

export class TileCache {
  constructor() {
    /** @type {CanvasRenderingContext2D | null} */
    this.context = null;
    /** What the picture shows: the view with its margin. */
    this.shown = new View();
    this.key = "";
    this.made = false;
  }

  /** @param {CanvasRenderingContext2D} context @param {View} view @param {number} version of the tiles @param {Paint} paint */
  draw(context, view, version, paint) {
    const { a, b } = context.getTransform();
    const ratio = Math.hypot(a, b);
    const key = [version, view.scale, ratio, view.width, view.height].join(" ");
    if (key !== this.key) {
      this.key = key;
      this.made = false;
      paint(context, view);
      return;
    }
    if (!this.made || !this.covers(view)) this.make(view, ratio, paint);
    if (!this.context) return;
    const [x, y] = this.offset(view).map((each) => Math.round(each * ratio) / ratio); // whole pixels: a copy, no scaling
    const { canvas } = this.context;
    context.drawImage(canvas, x, y, canvas.width / ratio, canvas.height / ratio);
  }

  /** Free the memory of the picture: the view is near. */
  drop() {
    this.context = null;
    this.key = "";
    this.made = false;
  }

  /** The left upper corner of the picture on the screen. @param {View} view */
  offset(view) {
    const { x, y } = this.shown;
    return [(x - view.x) * view.scale - MARGIN, (view.y - y) * view.scale - MARGIN];
  }

  /** @param {View} view */
  covers(view) {
    return this.offset(view).every((each) => each <= 0 && each >= -2 * MARGIN);
  }

  /** @param {View} view @param {number} ratio @param {Paint} paint */
  make(view, ratio, paint) {
    const { x, y, scale } = view;
    const [width, height] = [view.width + 2 * MARGIN, view.height + 2 * MARGIN];
    Object.assign(this.shown, { x, y, scale, width, height });
    this.context ??= document.createElement("canvas").getContext("2d");
    if (!this.context) return;
    const { canvas } = this.context;
    const size = [Math.ceil(width * ratio), Math.ceil(height * ratio)];
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    this.context.setTransform(1, 0, 0, 1, 0, 0);
    this.context.clearRect(0, 0, canvas.width, canvas.height);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    paint(this.context, this.shown);
    this.made = true;
  }
}
