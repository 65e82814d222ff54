// @ts-check
/** Diagnostics, and the battery over time. */

import { make, makeNote } from "../elements.js";
import { BATTERY } from "./battery_history.js";
import { DATA } from "./data_socket.js";
import { DATA_TEXTS } from "./texts.js";

/** @typedef {{name: string, level: string, text: string, hardware: string, values: [string, string][]}} Component */

const PERIOD = 2000; // ms

/** @type {import("./data_panels.js").Maker} */
export function makeStatusPanel(box) {
  const panel = new StatusPanel(box);
  return { show: (open) => panel.show(open) };
}

class StatusPanel {
  /** @param {HTMLElement} box */
  constructor(box) {
    this.open = false;
    this.note = makeNote(DATA_TEXTS.connecting);
    this.components = make("div", "", "components");
    this.battery = make("h3", DATA_TEXTS.battery);
    this.batteryNote = make("p", DATA_TEXTS.noBattery);
    this.canvas = make("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.ariaLabel = DATA_TEXTS.battery;
    const charts = make("div", "", "charts");
    charts.append(this.canvas);
    box.append(this.note, this.components, this.battery, this.batteryNote, charts);
    DATA.on("status", (message) => this.take(message));
    DATA.on("state", (end) => end !== "up" && this.open && (this.note.textContent = end === "starting" ? DATA_TEXTS.notConnected : DATA_TEXTS.connecting));
    setInterval(() => this.draw(), PERIOD);
  }

  /** @param {boolean} open */
  show(open) {
    this.open = open;
    DATA.use(open);
    DATA.show({ status: open || undefined });
    this.draw();
  }

  /** @param {{components: Component[]}} message */
  take({ components }) {
    const bad = components.filter(({ level }) => level !== "ok").length;
    const reported = components.length ? DATA_TEXTS.components(bad, components.length) : DATA_TEXTS.noDiagnostics;
    if (this.note.textContent !== reported) this.note.textContent = reported;
    this.showComponents(components);
  }

  /** @param {Component[]} components */
  showComponents(components) {
    const before = new Map([...this.components.children].map((each) => [/** @type {HTMLElement} */ (each).dataset.name, /** @type {HTMLDetailsElement} */ (each)]));
    const rows = components.map((component) => {
      const row = before.get(component.name) ?? make("details");
      row.dataset.name = component.name;
      row.className = component.level;
      const title = row.querySelector("summary") ?? row.appendChild(make("summary"));
      const text = `${DATA_TEXTS.levels[component.level]}: ${component.name}${component.text ? `, ${component.text}` : ""}`;
      if (title.textContent !== text) title.textContent = text;
      const values = row.querySelector("dl") ?? row.appendChild(make("dl", "", "figures"));
      values.replaceChildren(...component.values.flatMap(([key, value]) => [make("dt", key), make("dd", value)]));
      return row;
    });
    if (rows.some((row, index) => this.components.children[index] !== row) || rows.length !== this.components.childElementCount) {
      this.components.replaceChildren(...rows);
    }
  }

  draw() {
    BATTERY.note(Date.now());
    if (!this.open || document.hidden) return;
    const { samples } = BATTERY;
    this.batteryNote.hidden = samples.length > 0;
    this.canvas.hidden = samples.length === 0;
    if (samples.length) drawBattery(this.canvas, samples);
  }
}

/** Draw the share, or the volts where there is no share. @param {HTMLCanvasElement} canvas @param {[number, number | null, number | null][]} samples */
function drawBattery(canvas, samples) {
  const scale = devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth * scale, canvas.clientHeight * scale];
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const style = getComputedStyle(canvas);
  const byShare = samples.some(([, share]) => share !== null);
  const values = samples.map(([at, share, volts]) => /** @type {const} */ ([at, byShare ? share : volts])).filter(([, value]) => value !== null);
  const numbers = values.map(([, value]) => Number(value));
  const [low, high] = byShare ? [0, 1] : [Math.min(...numbers) - 0.5, Math.max(...numbers) + 0.5];
  const first = samples[0][0];
  const last = samples[samples.length - 1][0];
  const span = Math.max(last - first, 600_000);
  const [left, right, top, bottom] = [44 * scale, width - 8 * scale, 8 * scale, height - 20 * scale];
  context.clearRect(0, 0, width, height);
  context.strokeStyle = style.getPropertyValue("--line");
  context.fillStyle = style.color;
  context.font = `${12 * scale}px system-ui`;
  context.lineWidth = scale;
  for (const value of [low, (low + high) / 2, high]) {
    const y = bottom - ((value - low) / (high - low)) * (bottom - top);
    context.strokeRect(left, y, right - left, 0);
    context.fillText(byShare ? DATA_TEXTS.percent(value) : `${value.toFixed(1)} V`, 0, y + 4 * scale);
  }
  context.fillText(DATA_TEXTS.ago(Math.round(span / 60_000)), left, height - 4 * scale);
  context.textAlign = "right";
  context.fillText(DATA_TEXTS.ago(0), right, height - 4 * scale);
  context.textAlign = "left";
  context.strokeStyle = style.getPropertyValue("--accent");
  context.lineWidth = 2 * scale;
  context.beginPath();
  for (const [at, value] of values) {
    context.lineTo(right - ((last - at) / span) * (right - left), bottom - ((Number(value) - low) / (high - low)) * (bottom - top));
  }
  context.stroke();
}
