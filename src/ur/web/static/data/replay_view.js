// @ts-check
/** The replay that runs on the computer of this page: its position, pause, jumps and speed. */

import { make, makeButton, makeNote } from "../elements.js";
import { DATA_TEXTS } from "./texts.js";

/** @typedef {{position: number, length: number, speed: number, playing: boolean, ended: boolean}} ReplayState */

const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];

export class ReplayView {
  /** @param {HTMLElement} box hidden while no replay runs @param {boolean} mayDrive */
  constructor(box, mayDrive) {
    this.box = box;
    box.hidden = true;
    this.note = makeNote();
    this.play = makeButton(DATA_TEXTS.pauseReplay, () => this.send(this.playing ? "pause" : "play"));
    this.playing = true;
    this.slider = make("input");
    this.slider.type = "range";
    [this.slider.min, this.slider.step] = ["0", "0.1"];
    this.slider.ariaLabel = DATA_TEXTS.replayPosition;
    this.slider.disabled = !mayDrive;
    this.slider.addEventListener("change", () => this.send("jump", Number(this.slider.value)));
    for (const type of ["pointerdown", "keydown"]) this.slider.addEventListener(type, () => (this.held = true));
    for (const type of ["pointerup", "keyup", "blur"]) this.slider.addEventListener(type, () => (this.held = false));
    /** The user moves the slider. */
    this.held = false;
    this.speed = make("select");
    this.speed.ariaLabel = DATA_TEXTS.replaySpeed;
    this.speed.append(...SPEEDS.map((speed) => new Option(`${speed} ×`, String(speed))));
    this.speed.addEventListener("change", () => this.send("speed", Number(this.speed.value)));
    const row = make("div", "", "row");
    row.append(this.play, makeButton(DATA_TEXTS.backReplay, () => this.send("back", 10)), makeButton(DATA_TEXTS.aheadReplay, () => this.send("ahead", 10)), this.speed);
    box.append(make("h3", DATA_TEXTS.replay), this.note, this.slider);
    if (mayDrive) box.append(row);
  }

  async load() {
    this.take(await fetch("/api/replay").catch(() => null));
  }

  /** @param {string} name @param {number} value */
  async send(name, value = 0) {
    await this.take(await fetch("/api/replay", { method: "POST", body: JSON.stringify({ name, value }) }).catch(() => null));
  }

  /** @param {Response | null} answer */
  async take(answer) {
    /** @type {ReplayState | null} */
    const state = answer?.ok ? await answer.json() : null;
    this.box.hidden = !state;
    if (!state) return;
    this.playing = state.playing && !state.ended;
    this.play.textContent = this.playing ? DATA_TEXTS.pauseReplay : DATA_TEXTS.playReplay;
    this.note.textContent = DATA_TEXTS.replayState(state.position, state.length, state.ended);
    this.slider.ariaValueText = this.note.textContent;
    this.slider.max = String(state.length);
    if (!this.held) this.slider.value = String(state.position);
    const speed = String(state.speed);
    if (![...this.speed.options].some((each) => each.value === speed)) this.speed.append(new Option(`${speed} ×`, speed));
    if (document.activeElement !== this.speed) this.speed.value = speed;
  }
}
