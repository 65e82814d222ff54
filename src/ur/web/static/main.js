// @ts-check
/** Joins sockets, map and controls. */

import { Banners, describeDriver, describeDriving, describeLink } from "./banners.js";
import { DriveSocket, tabId } from "./drive_socket.js";
import { Gestures } from "./gestures.js";
import { MapView } from "./map_view.js";
import { LayerPanel } from "./layers.js";
import { keepLink, listLayers, openLink } from "./link_state.js";
import { togglePanel } from "./panels.js";
import { PlacePanel } from "./places.js";
import { Stick } from "./stick.js";
import { TEXTS } from "./texts.js";
import { ViewSocket } from "./view_socket.js";
import { KIND, LAYER, readGrid, readJson, readPoints, readPose, readTile } from "./wire.js";

/** @typedef {"look" | "goal" | "drive" | "pose"} Mode */

const NOTE_TIME = 5000; // ms

/** @param {string} id @returns {HTMLElement} */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

class Page {
  /** @param {{role: string, robot: string}} session */
  constructor(session) {
    this.mayDrive = session.role === "drive";
    this.state = /** @type {any} */ (null);
    this.server = /** @type {any} */ (null);
    /** @type {Mode} */
    this.mode = "look";
    this.note = { text: "", until: 0 };
    this.stopAsked = false;
    this.map = new MapView(/** @type {HTMLCanvasElement} */ (element("map")));
    this.gestures = new Gestures(
      this.map,
      () => this.mode === "goal" || this.mode === "pose",
      (place) => this.point(place),
      () => ((this.map.whole = false), this.setFollow(false)),
    );
    this.banners = new Banners(element("banners"));
    this.drive = this.mayDrive
      ? new DriveSocket(tabId(), (answer) => this.take(answer), () => this.showStick())
      : null;
    this.stick = new Stick(
      element("stick"),
      element("knob"),
      (forward, turn) => this.push(forward, turn),
      () => this.drive?.letGo(),
    );
    this.places = new PlacePanel(
      element("places-panel"),
      this.mayDrive,
      (message) => this.sendPlace(message),
      () => (this.poseAge < 2 ? this.map.pose : null),
    );
    this.setFollow(openLink(this.map));
    new LayerPanel(element("layers-panel"), this.map, () => this.socket.reopen());
    this.label(session.robot);
    this.setMode("look");
    this.socket = new ViewSocket(
      () => listLayers(this.map.layers),
      (frame) => this.show(frame),
      () => location.replace("/login"),
    );
    setInterval(() => keepLink(this.map), 1000);
    setInterval(() => this.refresh(), 200);
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("pagehide", () => this.leave());
  }

  /** Seconds since the last pose. */
  get poseAge() {
    return (performance.now() - (this.poseAt ?? -Infinity)) / 1000;
  }

  /** @param {string} robot */
  label(robot) {
    document.title = robot;
    element("name").textContent = robot;
    element("map").setAttribute("aria-label", TEXTS.map);
    element("stick").setAttribute("aria-label", TEXTS.stick);
    element("stop").textContent = TEXTS.stop;
    element("stop").setAttribute("aria-label", TEXTS.stopHelp);
    // At once when touched: a browser makes no click of a finger that stays, or moves.
    element("stop").addEventListener("pointerdown", () => this.stop());
    element("stop").addEventListener("click", (event) => event.detail === 0 && this.stop()); // by key or screen reader
    element("empty").textContent = TEXTS.waitingForMap;
    /** @type {[string, string, () => void][]} */
    const buttons = [
      ["zoom-in", TEXTS.zoomIn, () => this.gestures.step(true)],
      ["zoom-out", TEXTS.zoomOut, () => this.gestures.step(false)],
      ["follow", TEXTS.follow, () => this.setFollow(!this.map.follow)],
      ["fit", TEXTS.fit, () => (this.setFollow(false), this.map.fit())],
      ["places", TEXTS.places, () => togglePanel("places")],
      ["layers", TEXTS.layers, () => togglePanel("layers")],
    ];
    for (const [id, label, act] of buttons) {
      element(id).setAttribute("aria-label", label);
      element(id).title = label;
      element(id).addEventListener("click", act);
    }
    element("goal-cancel").textContent = TEXTS.cancel;
    element("goal-cancel").addEventListener("click", () => this.drive?.send({ t: "cancel" }));
    element("goal-resume").textContent = TEXTS.resume;
    element("goal-resume").addEventListener("click", () => this.drive?.request({ t: "resume" }));
    element("modes").hidden = !this.mayDrive;
    for (const mode of /** @type {Mode[]} */ (["look", "goal", "drive", "pose"])) {
      const button = document.createElement("button");
      button.type = "button";
      button.id = `mode-${mode}`;
      button.textContent = TEXTS.modes[mode];
      button.addEventListener("click", () => this.setMode(mode));
      element("modes").append(button);
    }
  }

  /** @param {import("./wire.js").Frame} frame */
  async show(frame) {
    if (frame.kind === KIND.SERVER) this.server = readJson(frame);
    else if (frame.kind === KIND.STATE) this.showState(readJson(frame));
    else if (frame.kind === KIND.PLACES) {
      const found = readJson(frame);
      this.places.show(found);
      this.map.places = found.places;
      this.map.request();
    }
    else if (frame.kind === KIND.POSE) {
      this.pose = readPose(frame);
      this.poseAt = performance.now();
      this.map.setPose(this.pose);
    } else if (frame.kind === KIND.POINTS) {
      const points = readPoints(frame);
      if (frame.layer === LAYER.SCAN) this.map.scan = points;
      if (frame.layer === LAYER.PLAN) this.map.plan = points;
      if (frame.layer === LAYER.PARTICLES) this.map.particles = points;
      this.map.request();
    } else if (frame.kind === KIND.GRID) this.map.setGrid(frame.layer, readGrid(frame));
    else if (frame.kind === KIND.TILE) {
      const { generation, cells } = await readTile(frame);
      this.map.tilesOf(frame.layer)?.setTile(frame.x, frame.y, generation, cells);
      this.map.request();
    }
  }

  /** @param {any} state */
  showState(state) {
    this.state = state;
    this.map.outline = state.robot.outline;
    if (state.mux.stopped || state.mux.problem) this.stopAsked = false;
    const goal = state.goal;
    const over = ["none", "reached", "stopped", "failed"].includes(goal.state);
    this.map.goal = goal.place && !over ? { x: goal.place[0], y: goal.place[1], yaw: goal.place[2] } : null;
    if (over && goal.state !== "none" && this.goalSeen === `${goal.number}`) {
      this.say([TEXTS.goalStates[/** @type {"reached"} */ (goal.state)], goal.text].filter(Boolean).join(": "));
    }
    this.goalSeen = over ? "" : `${goal.number}`;
    element("goal").hidden = over;
    const left = goal.left === null ? "" : TEXTS.left(goal.left);
    const words = [TEXTS.goalStates[/** @type {"driving"} */ (goal.state)], goal.text || left];
    element("goal-text").textContent = words.filter(Boolean).join(", ");
    element("goal-cancel").hidden = !this.mayDrive;
    element("goal-resume").hidden = !this.mayDrive || goal.state !== "asking";
    const battery = state.battery;
    element("battery").textContent =
      battery === null ? "" : battery.share !== null ? TEXTS.battery(battery.share) : battery.volts ? `${battery.volts} V` : "";
    this.map.request();
    this.refresh();
  }

  refresh() {
    const age = this.socket.age;
    const link = describeLink({ age, server: this.server, pose: this.pose ?? null, poseAge: this.poseAge });
    const state = this.state;
    /** @type {import("./banners.js").Banner[]} */
    const banners = [...link];
    if (state?.mux.stopped) {
      const release = { label: TEXTS.release, act: () => void this.drive?.send({ t: "release" }) };
      banners.unshift({ text: TEXTS.emergency, red: true, buttons: this.mayDrive ? [release] : [] });
    } else if (this.stopAsked) banners.unshift({ text: TEXTS.stopAsked, red: true });
    if (state?.mux.problem) banners.unshift({ text: state.mux.problem, red: true });
    if (!link.length && state) {
      const request = (/** @type {string} */ action) => void this.drive?.request({ t: "lease", do: action });
      banners.push(...describeDriver(state.lease, this.drive?.client ?? "", this.mayDrive, request));
      if (state.missing.length && this.mode !== "drive") banners.push({ text: TEXTS.missing(state.missing[0]) });
    }
    if (this.drive?.press === "dead") banners.push({ text: TEXTS.over[/** @type {"late"} */ (this.drive.why)] });
    if (this.note.until > performance.now()) banners.push({ text: this.note.text });
    this.banners.show(banners);
    element("dot").classList.toggle("up", link.length === 0);
    element("empty").hidden = this.map.tiles.grid !== null || link.length > 0;
    element("driver").textContent = link.length ? "" : describeDriving(this.state, this.drive?.client ?? "");
    element("speed").textContent = this.pose && !link.length ? TEXTS.speed(this.pose.speed) : "";
    if (this.map.old !== link.length > 0) {
      this.map.old = link.length > 0;
      this.map.request();
    }
    this.showStick();
  }

  /** @param {Mode} mode */
  setMode(mode) {
    this.mode = mode;
    document.body.dataset.mode = mode;
    this.gestures.drop();
    for (const each of element("modes").children) {
      each.setAttribute("aria-pressed", String(each.id === `mode-${mode}`));
    }
    element("hint").textContent = !this.mayDrive ? TEXTS.lookOnly : mode === "look" ? "" : TEXTS.modeHelp[mode];
    element("stick").hidden = mode !== "drive";
    this.stick.enable(mode === "drive");
  }

  /** @param {Record<string, unknown>} message */
  sendPlace(message) {
    if (!this.drive?.request(message)) this.say(TEXTS.refused.late);
    else if (message.t === "go_to") togglePanel("places");
  }

  /** @param {boolean} follow */
  setFollow(follow) {
    this.map.follow = follow;
    if (follow) this.map.whole = false;
    element("follow").setAttribute("aria-pressed", String(follow));
    this.map.request();
  }

  /** @param {import("./map_view.js").Place} place */
  point(place) {
    const sent = this.drive?.request({ t: this.mode === "pose" ? "pose" : "goal", ...place });
    if (!sent) this.say(TEXTS.refused.late);
    this.setMode("look");
  }

  /** @param {number} forward @param {number} turn shares of the limits */
  push(forward, turn) {
    const [speed, rate] = this.state?.robot.limits ?? [0, 0];
    this.drive?.move(forward * speed, turn * rate);
  }

  showStick() {
    const press = this.drive?.press ?? "idle";
    element("stick").classList.toggle("held", press === "held");
    element("stick").classList.toggle("dead", press === "dead");
    element("stick").classList.toggle("blocked", !this.drive?.newest);
  }

  /** @param {any} answer */
  take(answer) {
    if (answer.t === "refused") this.say(TEXTS.refused[/** @type {"late"} */ (answer.why)] ?? answer.why);
  }

  /** Stop everything that drives, by whatever connection there is. */
  async stop() {
    this.stick.drop();
    this.stopAsked = true;
    this.drive?.send({ t: "stop" });
    this.refresh();
    const answer = await fetch("/api/stop", { method: "POST" }).catch(() => null);
    if (!answer?.ok) {
      this.stopAsked = false;
      this.say(TEXTS.stopFailed);
    }
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.target instanceof HTMLInputElement || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.code === "Space" && !event.repeat) {
      event.preventDefault();
      this.stop();
    }
  }

  /** Leave the robot to others, unless it drives to a goal of this page. */
  leave() {
    const driving = this.state && !element("goal").hidden;
    if (!driving && this.state?.lease?.client === this.drive?.client) this.drive?.request({ t: "lease", do: "release" });
  }

  /** @param {string} text */
  say(text) {
    this.note = { text, until: performance.now() + NOTE_TIME };
    this.refresh();
  }
}

async function start() {
  const answer = await fetch("/api/me");
  if (!answer.ok) {
    location.replace("/login");
    return;
  }
  const page = new Page(await answer.json());
  Object.assign(globalThis, { page }); // for tests and for the console
}

start();
