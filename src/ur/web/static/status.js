// @ts-check
/** The state of robot and connection in words: header, banners, and the line about the goal. */

import { describeAssistants } from "./assistants.js";
import { Banners, describeDriver, describeDriving, describeLink } from "./banners.js";
import { element, make, sentence } from "./elements.js";
import { announce } from "./heard.js";
import { LinkDelay } from "./link_delay.js";
import { Obstacles } from "./obstacles.js";
import { describePatrol, isActive, isOn } from "./patrol.js";
import { TEXTS } from "./texts.js";

const NOTE_TIME = 5000; // ms
const EXPLORED = ["complete", "incomplete", "stopped"];
const OVER = ["none", "reached", "stopped", "failed"];

export class Status {
  /** @param {import("./main.js").Page} page */
  constructor(page) {
    this.page = page;
    this.banners = new Banners(element("banners"));
    this.obstacles = new Obstacles(page);
    this.note = { text: "", until: 0, red: false };
    this.stopAsked = false;
    this.delay = new LinkDelay();
    this.goalSeen = "";
    /** The number of the newest goal, of which the end was announced. @type {number | null} */
    this.goalKnown = null;
    /** The goal and its state that were announced. */
    this.goalHeard = "";
    element("empty").textContent = TEXTS.waitingForMap;
    element("goal-cancel").textContent = TEXTS.cancel;
    element("goal-cancel").addEventListener("click", () => page.drive?.send({ t: "cancel" }));
    setInterval(() => this.refresh(), 200);
  }

  /** Show a line for some seconds. @param {string} text @param {boolean} red */
  say(text, red = false) {
    this.note = { text: sentence(text), until: performance.now() + (red ? 3 : 1) * NOTE_TIME, red };
    this.refresh();
  }

  /** Show a state of the robot. @param {any} state */
  show(state) {
    if (state.mux.stopped || state.mux.problem) this.stopAsked = false;
    if (state.mux.stopped && this.note.text === TEXTS.stopFailed) this.note.until = 0; // it arrived by the other connection
    const goal = state.goal;
    const over = OVER.includes(goal.state);
    const others = state.exploring?.state === "exploring" && state.lease?.client !== this.page.drive?.client; // the banner tells of it
    const refused = this.goalKnown !== null && this.goalKnown !== goal.number; // at once: it was never seen to drive
    this.goalKnown = goal.number;
    if (!others && over && goal.state !== "none" && (refused || this.goalSeen === `${goal.number}`)) {
      this.say([TEXTS.goalStates[/** @type {"reached"} */ (goal.state)], goal.text].filter(Boolean).join(": "));
    }
    this.goalSeen = over ? "" : `${goal.number}`;
    const heard = over || others ? "" : `${goal.number} ${goal.state}`;
    if (heard && heard !== this.goalHeard) announce(TEXTS.goalStates[/** @type {"driving"} */ (goal.state)]);
    this.goalHeard = heard;
    element("goal").hidden = over || others;
    this.page.map.goal = over || !goal.place ? null : { x: goal.place[0], y: goal.place[1], yaw: goal.place[2] };
    const left = goal.left === null ? "" : TEXTS.left(goal.left);
    const words = [TEXTS.goalStates[/** @type {"driving"} */ (goal.state)], goal.text || left];
    element("goal-text").textContent = words.filter(Boolean).join(", ");
    element("goal-cancel").hidden = !this.page.mayDrive;
    showBattery(state.battery);
    this.refresh();
  }

  /** Drop what was known of the robot. */
  forget() {
    this.stopAsked = false;
    this.goalKnown = null;
    this.goalSeen = this.goalHeard = "";
    element("goal").hidden = true;
    showBattery(null);
  }

  refresh() {
    const { page } = this;
    const { state, drive, map, pose } = page;
    const link = describeLink({ age: page.socket.age, server: page.server, pose: pose ?? null, poseAge: page.poseAge });
    const old = link.length > 0;
    if (page.server?.end === "no master" && !page.server.moved && page.mayDrive && link.length && !page.panels.isOpen("programs")) {
      link[0].buttons = [{ label: TEXTS.programs, act: () => page.panels.toggle("programs") }];
    }
    /** @type {import("./banners.js").Banner[]} */
    const banners = [...link];
    if (state?.mux.stopped) {
      const release = { label: TEXTS.release, act: () => void drive?.send({ t: "release" }) };
      banners.unshift({ text: TEXTS.emergency, red: true, buttons: page.mayDrive ? [release] : [] });
    } else if (this.stopAsked) banners.unshift({ text: TEXTS.stopAsked, red: true });
    if (state?.mux.problem) banners.unshift({ text: sentence(state.mux.problem), red: true });
    if (!old && state?.lost) banners.push({ text: sentence(state.lost), red: true });
    if (!old && state?.bumpers?.length) banners.push({ text: TEXTS.bumpers(state.bumpers), red: true });
    if (!old && state) {
      const request = (/** @type {string} */ action) => void drive?.request({ t: "lease", do: action });
      const ask = page.mayDrive ? (/** @type {Record<string, unknown>} */ message) => void drive?.request(message) : null;
      if (isOn(state.patrol)) banners.push(describePatrol(state.patrol, ask));
      if (!isActive(state.patrol)) banners.push(...describeDriver(state.lease, drive?.client ?? "", page.mayDrive, request));
      if (state.missing.length && page.mode !== "drive") banners.push({ text: TEXTS.missing(state.missing[0]) });
    }
    banners.push(...describeAssistants(page));
    const { exploring } = state ?? {};
    if (exploring && (!old || EXPLORED.includes(exploring.state))) banners.push({ text: sentence(exploring.line) });
    if (drive?.press === "dead") {
      const { delay } = this;
      if (drive.why === "late") void delay.measure(drive.hold);
      const slow = drive.why === "late" && delay.slow > 0;
      banners.push({ text: slow ? TEXTS.slowLink(delay.slow) : TEXTS.over[/** @type {"late"} */ (drive.why)] });
    }
    if (this.note.until > performance.now()) banners.push({ text: this.note.text, red: this.note.red });
    this.banners.show(banners);
    this.obstacles.show(old ? null : state);
    element("dot").classList.toggle("up", !old);
    element("empty").hidden = map.tiles.grid !== null || map.pose !== null || old;
    element("driver").textContent = old ? "" : describeDriving(state, drive?.client ?? "");
    const mine = !old && drive !== null && state?.lease?.state === "held" && state.lease.client === drive.client;
    element("holding").hidden = !mine || page.mode === "drive" || !element("goal").hidden;
    element("velocity").textContent = pose && !old ? TEXTS.speed(pose.speed) : "";
    if (map.old !== old) {
      map.old = old;
      map.request();
    }
    page.showStick();
  }
}

/** @param {{share: number | null, volts: number | null} | null} battery */
function showBattery(battery) {
  const box = element("battery");
  const text = !battery ? "" : battery.share !== null ? TEXTS.percent(battery.share) : battery.volts ? TEXTS.volts(battery.volts) : "";
  if (box.lastChild?.textContent === text) return;
  box.title = text && `${TEXTS.battery} ${text}`;
  box.replaceChildren(...(text ? [make("span", `${TEXTS.battery} `, "heard"), text] : [])); // a drawing for those who see
}
