// @ts-check
/** A plot on a canvas: a scale of three or four marks, and the last minute as a line. */

import { shortNumber, SPAN } from "./plot_series.js";
import { TEXTS } from "./texts.js";

const [LEFT, RIGHT, TOP, BOTTOM] = [46, 8, 6, 18]; // pixels beside the lines

/** @param {HTMLCanvasElement} canvas @param {import("./plot_series.js").Series} series @param {number} now the newest time of all plots */
export function drawPlot(canvas, series, now) {
  const [width, height, ratio] = [canvas.clientWidth, canvas.clientHeight, Math.min(devicePixelRatio || 1, 2)];
  if (!width || !height) return;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
  }
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const style = getComputedStyle(canvas);
  const [ink, line, accent] = ["--soft", "--line", "--accent"].map((name) => style.getPropertyValue(name).trim());
  const [low, high, step] = series.scale();
  const toX = (/** @type {number} */ time) => width - RIGHT - ((now - time) / SPAN) * (width - LEFT - RIGHT);
  const toY = (/** @type {number} */ value) => height - BOTTOM - ((value - low) / (high - low)) * (height - TOP - BOTTOM);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = "11px system-ui, sans-serif";
  context.fillStyle = ink;
  context.strokeStyle = line;
  context.lineWidth = 1;
  context.textBaseline = "middle";
  context.textAlign = "right";
  for (let value = low; value <= high + step / 2; value += step) {
    const y = Math.round(toY(value)) + 0.5;
    context.beginPath();
    context.moveTo(LEFT, y);
    context.lineTo(width - RIGHT, y);
    context.stroke();
    context.fillText(shortNumber(Math.abs(value) < step / 1e6 ? 0 : value, step), LEFT - 6, y);
  }
  context.textBaseline = "alphabetic";
  for (const ago of [60, 40, 20, 0]) {
    context.textAlign = ago === 60 ? "left" : ago ? "center" : "right";
    context.fillText(TEXTS.plots.ago(ago), toX(now - ago), height - 4);
  }
  context.save();
  context.beginPath();
  context.rect(LEFT, 0, width - LEFT, height);
  context.clip();
  context.strokeStyle = accent;
  context.lineWidth = 2;
  context.lineJoin = "round";
  for (const part of series.lines()) {
    context.beginPath();
    for (const [time, value] of part) context.lineTo(toX(time), toY(value));
    if (part.length === 1) context.lineTo(toX(part[0][0]) + 2, toY(part[0][1]));
    context.stroke();
  }
  context.restore();
}
