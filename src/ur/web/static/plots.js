// @ts-check
/** Plots over time of what the user ticks: any numeric field of any topic. The address of the page holds them. */

import { make, makeButton, makeNote } from "./elements.js";
import { keepLink } from "./link_state.js";
import { drawPlot } from "./plot_drawing.js";
import { Series, shortNumber } from "./plot_series.js";
import { TEXTS } from "./texts.js";
import { KIND } from "./wire.js";

const MOST = 8; // plots; see ur.web.wire.requests
const PERIOD = 200; // ms between two drawings
/** What people look at first, where the robot has it. */
const FIRST = [
  "/odom:twist.twist.linear.x",
  "/odom:twist.twist.angular.z",
  "/cmd_vel:linear.x",
  "/cmd_vel:angular.z",
  "/battery_state:percentage",
  "/battery_state:voltage",
];

/** @type {import("./panels.js").Panel} */
export const PLOT_PANEL = {
  name: "plots",
  label: TEXTS.plots.title,
  icon: "M4 4v16h16M7 15l4-6 4 4 5-8",
  wide: true,
  make: (box, page) => {
    const panel = new PlotPanel(box, page);
    page.frames.onJson(KIND.FIELDS, ({ fields }) => panel.offer(fields));
    page.frames.onJson(KIND.VALUES, (values) => panel.take(values));
    return { show: (open) => panel.show(open) };
  },
};

export class PlotPanel {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page */
  constructor(box, page) {
    this.page = page;
    this.open = false;
    /** @type {Record<string, string[]>} */
    this.fields = {};
    /** @type {Map<string, {series: Series, row: HTMLElement, canvas: HTMLCanvasElement, value: HTMLElement}>} */
    this.rows = new Map();
    this.note = makeNote();
    this.charts = make("div", "", "charts");
    this.ticks = make("ul", "", "ticks");
    this.form = make("form", "", "row");
    this.topic = make("select");
    this.topic.id = "plot-topic";
    this.topic.ariaLabel = TEXTS.plots.topic;
    this.field = make("select");
    this.field.id = "plot-field";
    this.field.ariaLabel = TEXTS.plots.field;
    this.topic.addEventListener("change", () => this.listFields());
    const add = make("button", TEXTS.plots.add);
    add.id = "plot-add";
    this.form.append(this.topic, this.field, add);
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (this.field.value) this.tick(`${this.topic.value}:${this.field.value}`, true);
    });
    box.append(this.note, this.charts, this.ticks, this.form);
    this.refresh();
    setInterval(() => this.draw(), PERIOD);
  }

  /** @param {boolean} open */
  show(open) {
    this.open = open;
    this.page.plotting = open;
    this.page.socket.change();
    keepLink(this.page);
    this.draw();
  }

  /** @param {Record<string, string[]>} fields by topic */
  offer(fields) {
    if (JSON.stringify(fields) === JSON.stringify(this.fields)) return;
    this.fields = fields;
    const chosen = this.topic.value;
    this.topic.replaceChildren(...Object.keys(fields).map((name) => new Option(name, name)));
    if (chosen in fields) this.topic.value = chosen;
    this.listFields();
    this.refresh();
  }

  listFields() {
    const chosen = this.field.value;
    const fields = this.fields[this.topic.value] ?? [];
    this.field.replaceChildren(...fields.map((name) => new Option(name, name)));
    if (fields.includes(chosen)) this.field.value = chosen;
  }

  /** @param {string} plot @param {boolean} on */
  tick(plot, on) {
    const { plots } = this.page;
    if (on && plots.size >= MOST && !plots.has(plot)) {
      this.page.say(TEXTS.plots.full(MOST));
    } else if (on) plots.add(plot);
    else plots.delete(plot);
    keepLink(this.page);
    this.page.socket.change();
    this.refresh();
  }

  refresh() {
    const { plots } = this.page;
    const offered = FIRST.filter((plot) => {
      const [topic, field] = plot.split(":");
      return this.fields[topic]?.includes(field);
    });
    this.note.textContent = !Object.keys(this.fields).length ? TEXTS.plots.none : plots.size ? "" : TEXTS.plots.tick;
    this.note.hidden = !this.note.textContent;
    this.form.hidden = !Object.keys(this.fields).length;
    this.ticks.replaceChildren(...[...new Set([...plots, ...offered])].map((plot) => this.makeTick(plot)));
    for (const [plot, { row }] of this.rows) {
      if (!plots.has(plot)) {
        row.remove();
        this.rows.delete(plot);
      }
    }
    for (const plot of plots) if (!this.rows.has(plot)) this.addRow(plot);
  }

  /** @param {string} plot */
  makeTick(plot) {
    const row = make("li");
    const label = make("label");
    const input = make("input");
    input.type = "checkbox";
    input.checked = this.page.plots.has(plot);
    input.dataset.plot = plot;
    input.addEventListener("change", () => {
      this.tick(plot, input.checked);
      /** @type {HTMLElement | null} */ (this.ticks.querySelector(`[data-plot="${plot}"]`))?.focus(); // it was made anew
    });
    label.append(input, TEXTS.plots.names[/** @type {"/cmd_vel:linear.x"} */ (plot)] ?? plot);
    row.append(label);
    return row;
  }

  /** @param {string} plot */
  addRow(plot) {
    const name = TEXTS.plots.names[/** @type {"/cmd_vel:linear.x"} */ (plot)] ?? plot;
    const row = make("figure");
    const value = make("output", "", "number");
    const head = make("figcaption", name);
    head.append(value);
    const canvas = make("canvas");
    canvas.setAttribute("role", "img");
    canvas.ariaLabel = TEXTS.plots.picture(name);
    const close = makeButton("\u00d7", () => this.tick(plot, false), TEXTS.plots.remove(name));
    close.className = "close";
    head.append(close);
    row.append(head, canvas);
    this.charts.append(row);
    this.rows.set(plot, { series: new Series(), row, canvas, value });
  }

  /** @param {{t: number, v: Record<string, number>}} sample */
  take({ t, v }) {
    for (const [plot, value] of Object.entries(v)) this.rows.get(plot)?.series.add(t, value);
    this.newest = t;
  }

  draw() {
    if (!this.open || document.hidden) return;
    for (const { series, canvas, value } of this.rows.values()) {
      const text = shortNumber(series.value);
      if (value.textContent !== text) value.textContent = text;
      drawPlot(canvas, series, this.newest ?? 0);
    }
  }
}
