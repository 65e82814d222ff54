// @ts-check
/** Joins sockets, map, controls and panels. */

import { labelControls, measureEdges, showMode } from "./controls.js";
import { DriveSocket, tabId } from "./drive_socket.js";
import { element, takesText } from "./elements.js";
import { FrameHandlers, showOnMap } from "./frames.js";
import { Gestures } from "./gestures.js";
import { keepLink, listLayers, openLink } from "./link_state.js";
import { MapScale } from "./map_scale.js";
import { MapView } from "./map_view.js";
import { Overlays } from "./overlays.js";
import { GROUPS } from "./panel_list.js";
import { Panels } from "./panels.js";
import { RUNS } from "./run_socket.js";
import { Status } from "./status.js";
import { Stick } from "./stick.js";
import { TEXTS } from "./texts.js";
import { ViewSocket } from "./view_socket.js";
import { KIND, readPose } from "./wire.js";

const BESIDE_STICK = 24; // pixels between the robot and the stick
const STOP_PULSE = 200; // ms that a phone vibrates

/** @typedef {"look" | "goal" | "drive" | "pose"} Mode */

export class Page {
  /** @param {{role: string, robot: string}} session */
  constructor(session) {
    this.mayDrive = session.role === "drive";
    this.state = /** @type {any} */ (null);
    this.server = /** @type {any} */ (null);
    /** @type {import("./wire.js").Pose | undefined} */
    this.pose = undefined;
    this.poseAt = -Infinity;
    /** @type {Mode} */
    this.mode = "look";
    this.map = new MapView(/** @type {HTMLCanvasElement} */ (element("map")), measureEdges);
    this.scale = new MapScale(this.map, element("scale"));
    this.gestures = new Gestures(
      this.map,
      () => this.mode === "goal" || this.mode === "pose",
      (place) => this.point(place),
      () => ((this.map.whole = false), this.setFollow(false)),
    );
    this.drive = this.mayDrive
      ? new DriveSocket(tabId(), (answer) => this.take(answer), () => this.showStick())
      : null;
    this.stick = new Stick(
      element("stick"),
      element("knob"),
      (forward, turn) => this.push(forward, turn),
      () => this.drive?.letGo(),
    );
    this.frames = new FrameHandlers();
    this.frames.onJson(KIND.SERVER, (server) => this.showServer(server));
    this.frames.onJson(KIND.STATE, (state) => this.showState(state));
    this.frames.on(KIND.POSE, (frame) => this.showPose(readPose(frame)));
    showOnMap(this.frames, this.map);
    this.overlays = new Overlays(this.frames, this.map);
    const link = openLink(this.map);
    this.setFollow(link.follow);
    /** Numbers that are plotted over time, `TOPIC:FIELD`. @type {Set<string>} */
    this.plots = link.plots ?? new Set();
    this.plotting = link.plots !== null;
    this.dockWidth = link.dock;
    labelControls(this, session.robot);
    this.setMode("look");
    this.socket = new ViewSocket(
      () => ({ layers: listLayers(this.map.layers), ...(this.plotting ? { plots: [...this.plots].join(",") } : {}) }),
      (frame) => this.frames.take(frame),
      () => location.replace("/login"),
    );
    /** @type {import("./camera.js").CameraPanel | null} */
    this.camera = null;
    /** @type {import("./gamepad.js").Gamepads | null} */
    this.gamepads = null;
    /** @type {import("./map_list.js").MapList | null} */
    this.mapList = null;
    /** @type {import("./data/recording_panel.js").RecordingPanel | null} */
    this.recordings = null;
    /** @type {import("./walls.js").WallTool | null} */
    this.walls = null;
    this.status = new Status(this);
    this.runs = RUNS;
    this.panels = new Panels(element("panels"), GROUPS, this);
    this.panels.show(link.panels);
    setInterval(() => keepLink(this), 1000);
    addEventListener("keydown", (event) => this.key(event), true); // before any control
    addEventListener("keyup", (event) => stops(event) && event.preventDefault(), true); // some browsers press a button by it
    addEventListener("pagehide", () => this.leave());
  }

  /** Seconds since the last pose. */
  get poseAge() {
    return (performance.now() - this.poseAt) / 1000;
  }

  /** @param {import("./wire.js").Pose} pose */
  showPose(pose) {
    if (this.server?.end === "no master") return; // it was under way when the robot ended
    this.pose = pose;
    this.poseAt = performance.now();
    this.map.setPose(pose);
    this.clearStick();
    this.overlays.follow(pose);
  }

  /** Move the map until the robot is below neither the stick nor the buttons above it. */
  clearStick() {
    const { pose, view } = this.map;
    if (!pose || this.mode !== "drive") return;
    for (const name of ["stick", "view"]) {
      const { left, top, right, bottom } = element(name).getBoundingClientRect();
      const [x, y] = view.toScreen(pose.x, pose.y);
      const [dx, dy] = [left - BESIDE_STICK - x, top - BESIDE_STICK - y];
      const below = left > view.width / 2 && dx < 0 && dy < 0 && x < right && y < bottom;
      if (below) view.pan(dx > dy ? dx : 0, dx > dy ? 0 : dy);
    }
  }

  /** @param {any} server */
  showServer(server) {
    if (server.end === "no master" && this.state) this.forget();
    this.server = server;
  }

  /** Drop what was known of a robot that no longer runs; its map stays, greyed. */
  forget() {
    this.state = null;
    this.pose = undefined;
    this.poseAt = -Infinity;
    for (const forget of this.frames.forgets) forget();
    this.overlays.found.clear();
    this.overlays.trail = [];
    this.map.forget();
    this.status.forget();
  }

  /** @param {any} state */
  showState(state) {
    this.state = state;
    this.map.outline = state.robot.outline;
    element("sideways").hidden = this.mode !== "drive" || !state.robot.limits[2];
    this.status.show(state);
    this.map.request();
  }

  /** @param {Mode} mode */
  setMode(mode) {
    this.mode = mode;
    this.gestures.drop();
    this.gestures.picker = null;
    if (mode === "goal" || mode === "pose") this.gestures.loseTaps(); // a press on the map points at a place
    showMode(mode, this.mayDrive);
    this.stick.enable(mode === "drive");
    element("sideways").hidden = mode !== "drive" || !this.state?.robot.limits[2];
  }

  /** Send a request about a place. @param {Record<string, unknown>} message */
  sendPlace(message) {
    if (!this.drive?.request(message)) this.sayNotSent();
    else if (message.t === "go_to") this.panels.showMap();
  }

  /** Have the user point at a place of the map, once. @param {string} help @param {(place: import("./map_view.js").Place) => void} take */
  pick(help, take) {
    this.setMode("look");
    this.gestures.loseTaps();
    this.panels.showMap();
    element("hint").textContent = help;
    document.body.dataset.mode = "goal"; // its cursor
    this.gestures.picker = (place) => (this.setMode("look"), take(place));
    this.map.canvas.focus();
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
    const { x, y, yaw, dragged } = place;
    const sent = this.drive?.request(this.mode === "pose" ? { t: "pose", x, y, yaw } : { t: "goal", x, y, yaw: dragged === false ? null : yaw });
    if (!sent) this.sayNotSent();
    this.setMode("look");
  }

  /** @param {number} forward @param {number} turn shares of the limits */
  push(forward, turn) {
    const [speed, rate, aside] = this.state?.robot.limits ?? [0, 0, 0];
    const left = aside > 0 && (this.stick.shifted || element("sideways").ariaPressed === "true");
    this.drive?.move(forward * speed, left ? 0 : turn * rate, left ? turn * aside : 0);
    element("hint").textContent = ""; // it was understood
  }

  showStick() {
    const press = this.drive?.press ?? "idle";
    element("stick").classList.toggle("held", press === "held");
    element("stick").classList.toggle("dead", press === "dead");
    element("stick").classList.toggle("blocked", !this.drive?.newest);
  }

  /** @param {any} answer */
  take(answer) {
    if (answer.what === "save_map") this.mapList?.answered(answer);
    if (answer.what === "save_recording") return this.recordings?.answered(answer);
    if (answer.what === "draw_walls" || answer.what === "restore_walls") this.walls?.answered(answer);
    if (answer.t !== "refused" || answer.what === "save_map") return;
    const why = TEXTS.refused[/** @type {"late"} */ (answer.why)] ?? answer.why;
    this.say(why);
  }

  /** Stop everything that drives, by any connection there is. */
  async stop() {
    this.stick.drop();
    if (navigator.userActivation?.hasBeenActive) navigator.vibrate?.(STOP_PULSE);
    this.status.stopAsked = true;
    this.drive?.send({ t: "stop" });
    this.status.refresh();
    const answer = await fetch("/api/stop", { method: "POST" }).catch(() => null);
    if (!answer?.ok) {
      this.status.stopAsked = false;
      this.say(TEXTS.stopFailed, true);
    }
  }

  /** The space bar stops; Enter ticks boxes in its place. @param {KeyboardEvent} event */
  key(event) {
    const box = event.target instanceof HTMLInputElement && event.target.type === "checkbox" ? event.target : null;
    const ticks = box && event.key === "Enter";
    if (!ticks && !stops(event)) return;
    event.preventDefault();
    if (event.repeat) return;
    if (ticks) box.click();
    else this.stop();
  }

  /** Leave the robot to others, unless it drives to a goal of this page. */
  leave() {
    const driving = this.state && !element("goal").hidden;
    if (!driving && this.state?.lease?.client === this.drive?.client) this.drive?.request({ t: "lease", do: "release" });
  }

  /** Say why a request could not be sent. */
  sayNotSent() {
    this.say(this.server?.end === "up" ? TEXTS.refused.late : TEXTS.refused.away);
  }

  /** @param {string} text @param {boolean} red */
  say(text, red = false) {
    this.status.say(text, red);
  }
}

/** Whether a key is the space bar, other than in a text. @param {KeyboardEvent} event */
function stops({ code, target, ctrlKey, metaKey, altKey }) {
  return code === "Space" && !takesText(target) && !ctrlKey && !metaKey && !altKey;
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
