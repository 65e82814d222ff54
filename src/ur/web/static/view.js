// @ts-check
/** The part of the plane that the canvas shows: metres to pixels and back. y points up on the plane, down on screens. */

const NEAREST = 400; // pixels a metre
const FARTHEST = 1;
const WORTH = 1.15; // times as large: a map is turned

export class View {
  constructor() {
    this.x = 0;
    this.y = 0;
    this.scale = 40;
    this.width = 1;
    this.height = 1;
    /** The plane is turned by 90 degrees: its x axis points up. */
    this.turned = false;
  }

  /** @param {number} x @param {number} y @returns {[number, number]} */
  toScreen(x, y) {
    const [dx, dy] = [(x - this.x) * this.scale, (y - this.y) * this.scale];
    return this.turned ? [this.width / 2 - dy, this.height / 2 - dx] : [this.width / 2 + dx, this.height / 2 - dy];
  }

  /** @param {number} x @param {number} y @returns {[number, number]} */
  toPlane(x, y) {
    const [dx, dy] = [(x - this.width / 2) / this.scale, (y - this.height / 2) / this.scale];
    return this.turned ? [this.x - dy, this.y - dx] : [this.x + dx, this.y - dy];
  }

  /** The angle on the screen of a yaw on the plane, both counterclockwise from the right. @param {number} yaw */
  toAngle(yaw) {
    return this.turned ? yaw + Math.PI / 2 : yaw;
  }

  /** The yaw on the plane of an angle on the screen. @param {number} angle */
  toYaw(angle) {
    return this.turned ? angle - Math.PI / 2 : angle;
  }

  /** @param {number} dx pixels @param {number} dy pixels */
  pan(dx, dy) {
    const [x, y] = this.toPlane(this.width / 2 - dx, this.height / 2 - dy);
    Object.assign(this, { x, y });
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
   * Show a rectangle between the controls, turned where that is allowed and shows it larger.
   * @param {number[]} bounds left, low, right, high @param {number[]} edges pixels of controls: left, right, above, below
   * @param {boolean} mayTurn
   */
  fit(bounds, edges, mayTurn = false) {
    const [left, low, right, high] = bounds;
    const [before, behind, above, below] = edges;
    const room = [Math.max(50, this.width - before - behind), Math.max(50, this.height - above - below)];
    const size = [Math.max(0.5, right - left), Math.max(0.5, high - low)];
    const straight = Math.min(room[0] / size[0], room[1] / size[1]);
    const turned = Math.min(room[0] / size[1], room[1] / size[0]);
    this.turned = mayTurn && turned > WORTH * straight;
    this.scale = Math.min(NEAREST, Math.max(FARTHEST, this.turned ? turned : straight));
    [this.x, this.y] = [(left + right) / 2, (low + high) / 2];
    this.pan((before - behind) / 2, (above - below) / 2);
  }

  /**
   * The same part of the plane without the turn, and a context on which what is drawn by it is turned.
   * @param {CanvasRenderingContext2D} context @returns {View}
   */
  straighten(context) {
    const { x, y, scale, width, height } = this;
    context.transform(0, -1, 1, 0, 0, height);
    return Object.assign(new View(), { x, y, scale, width: height, height: width });
  }
}
