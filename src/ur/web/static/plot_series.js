// @ts-check
/** Numbers over time, and the scale on which they are drawn. */

export const SPAN = 60; // s that a plot shows
const GAP = 2; // s without a number after which the line is interrupted
const MOST = 2000;

/** The numbers of one plot: times in s of the robot's end, which may begin anew. */
export class Series {
  constructor() {
    /** @type {[number, number][]} */
    this.points = [];
  }

  /** @param {number} time @param {number} value */
  add(time, value) {
    const last = this.points.at(-1);
    if (last && time < last[0]) this.points = []; // another robot's end
    if (last && time === last[0]) return; // the same frame again, after a gap in the connection
    this.points.push([time, value]);
    const first = this.points.findIndex(([at]) => time - at <= SPAN);
    if (first > 0) this.points.splice(0, first);
    if (this.points.length > MOST) this.points.splice(0, this.points.length - MOST);
  }

  /** The newest number. */
  get value() {
    return this.points.at(-1)?.[1] ?? null;
  }

  /** Runs of points without a gap. @returns {[number, number][][]} */
  lines() {
    /** @type {[number, number][][]} */
    const lines = [];
    let before = -Infinity;
    for (const point of this.points) {
      if (point[0] - before > GAP) lines.push([]);
      lines[lines.length - 1].push(point);
      before = point[0];
    }
    return lines;
  }

  /** Lower and upper end of the scale: round numbers round all that is shown. @returns {[number, number, number]} and the step between marks */
  scale() {
    const values = this.points.map(([, value]) => value);
    let [low, high] = values.length ? [Math.min(...values), Math.max(...values)] : [0, 1];
    if (high - low < 1e-6 * Math.max(1, Math.abs(high))) [low, high] = [low - Math.max(0.05, Math.abs(low) * 0.05), high + Math.max(0.05, Math.abs(high) * 0.05)];
    const step = niceStep((high - low) / 2);
    return [Math.floor(low / step + 1e-9) * step, Math.ceil(high / step - 1e-9) * step, step];
  }
}

/** 1, 2 or 5 times a power of ten, not below. @param {number} least */
export function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return (([1, 2, 5].find((each) => each * power >= least * (1 - 1e-9)) ?? 10) * power);
}

/** A number in few characters, other than that of a value a step away. @param {number | null} value @param {number} step */
export function shortNumber(value, step = 1) {
  if (value === null) return "\u2013";
  const size = Math.abs(value);
  if (size !== 0 && (size < 0.001 || size >= 1e6)) return value.toExponential(1);
  const digits = Math.max(size < 10 ? 3 : size < 100 ? 2 : 1, Math.ceil(-Math.log10(step)));
  return String(Number(value.toFixed(Math.min(digits, 9))));
}
