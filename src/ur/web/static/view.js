// @ts-check
/** The part of the plane that the canvas shows: metres to pixels and back. y points up on the plane, down on screens. */

const NEAREST = 400; // pixels a metre
const FARTHEST = 1;

export class View {
  constructor() {
    this.x = 0;
    this.y = 0;
    this.scale = 40;
    this.width = 1;
    this.height = 1;
  }

  /** @param {number} x @param {number} y @returns {[number, number]} */
  toScreen(x, y) {
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale];
  }

  /** @param {number} x @param {number} y @returns {[number, number]} */
  toPlane(x, y) {
    return [this.x + (x - this.width / 2) / this.scale, this.y - (y - this.height / 2) / this.scale];
  }

  /** @param {number} dx pixels @param {number} dy pixels */
  pan(dx, dy) {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
  }

  /** Zoom by a factor; the point of the plane below (x, y) stays there. @param {number} factor @param {number} x @param {number} y */
  zoom(factor, x, y) {
    const [px, py] = this.toPlane(x, y);
    this.scale = Math.min(NEAREST, Math.max(FARTHEST, this.scale * factor));
    const [qx, qy] = this.toPlane(x, y);
    this.x += px - qx;
    this.y += py - qy;
  }

  /**
   * Show a rectangle between the controls.
   * @param {number[]} bounds left, low, right, high @param {number[]} edges pixels of controls: left, right, above, below
   */
  fit(bounds, edges) {
    const [left, low, right, high] = bounds;
    const [before, behind, above, below] = edges;
    const room = [Math.max(50, this.width - before - behind), Math.max(50, this.height - above - below)];
    const scale = Math.min(room[0] / Math.max(0.5, right - left), room[1] / Math.max(0.5, high - low));
    this.scale = Math.min(NEAREST, Math.max(FARTHEST, scale));
    this.x = (left + right) / 2 - (before - behind) / 2 / this.scale;
    this.y = (low + high) / 2 + (above - below) / 2 / this.scale;
  }
}
