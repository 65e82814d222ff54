// @ts-check
/** The robot's camera, on a web socket of its own: the newest picture only, as fast as the connection bears. */

import { make, makeButton, makeNote } from "./elements.js";
import { TEXTS } from "./texts.js";
import { HEAD, KIND } from "./wire.js";

const STAMP = 8; // bytes: seconds since 1970
const PAUSE = 1000; // ms before another connection is tried
const OLD = 3000; // ms
const CHOICE = 2000; // ms in which a camera that is chosen is shown, or is not

/** @type {import("./panels.js").Panel} */
export const CAMERA_PANEL = {
  name: "camera",
  label: TEXTS.camera.title,
  icon: "M3 8h4l2-3h6l2 3h4v11H3zM9 13a3 3 0 1 0 6 0a3 3 0 1 0-6 0",
  make: (box, page) => {
    const camera = new CameraPanel(box, page);
    page.camera = camera;
    page.frames.onJson(KIND.STATE, ({ cameras }) => camera.list(cameras ?? { topic: "", topics: [] }), {});
    return { show: (open) => camera.show(open), leave: () => camera.spread(false) };
  },
};

export class CameraPanel {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page */
  constructor(box, page) {
    this.box = box;
    this.page = page;
    box.classList.add("picture");
    this.canvas = make("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.ariaLabel = TEXTS.camera.picture;
    this.canvas.hidden = true;
    this.note = makeNote(TEXTS.camera.waiting);
    this.choice = make("select");
    this.choice.id = "camera-topic";
    this.choice.ariaLabel = TEXTS.camera.choose;
    this.choice.disabled = !page.mayDrive;
    this.choice.hidden = true;
    this.choice.addEventListener("change", () => this.choose());
    const row = make("div", "", "row");
    this.full = makeButton(TEXTS.camera.larger, () => this.spread(!this.isSpread));
    this.full.id = "camera-full";
    row.append(this.choice, this.full);
    box.append(row, this.canvas, this.note);
    /** The topic that all pages show; "" before it is known. */
    this.topic = "";
    this.chosenAt = -Infinity;
    this.open = false;
    /** Pictures shown so far. */
    this.count = 0;
    this.shownAt = -Infinity;
    /** Seconds since 1970: when the newest picture was taken. */
    this.stamp = 0;
    /** @type {WebSocket | null} */
    this.socket = null;
    setInterval(() => this.check(), 500);
    document.addEventListener("visibilitychange", () => this.connectOrNot());
    document.addEventListener("fullscreenchange", () => document.fullscreenElement ?? this.spread(false)); // by the browser's key
  }

  /** @param {boolean} open */
  show(open) {
    this.open = open;
    if (!open) this.spread(false);
    this.connectOrNot();
  }

  connectOrNot() {
    if (this.open && !document.hidden) this.connect();
    else this.disconnect();
  }

  /** Whether the picture takes the whole page. */
  get isSpread() {
    return this.box.classList.contains("full");
  }

  /**
   * Have the picture take the whole page, and the screen where the browser has that, or its panel only.
   * @param {boolean} full @returns {boolean} whether that changes anything
   */
  spread(full) {
    if (full === this.isSpread) return false;
    const { mode } = this.page;
    if (full && (mode === "goal" || mode === "pose")) this.page.setMode("look"); // the map is covered
    this.box.classList.toggle("full", full);
    document.body.toggleAttribute("data-full", full);
    this.full.textContent = full ? TEXTS.camera.smaller : TEXTS.camera.larger;
    if (full) document.documentElement.requestFullscreen?.().catch(() => {}); // the page is full then, not the screen
    else if (document.fullscreenElement) document.exitFullscreen().catch(() => {});
    return true;
  }

  /** Show the topics of cameras, and the one that is shown. @param {{topic: string, topics: string[]}} cameras */
  list({ topic, topics }) {
    const { choice } = this;
    if (topics.join() !== [...choice.options].map((each) => each.value).join()) {
      choice.replaceChildren(...topics.map((each) => new Option(each)));
    }
    choice.hidden = topics.length < 2;
    if (topic && topic !== this.topic) {
      this.topic = topic;
      this.count = 0; // the picture is that of another camera
      this.shownAt = this.chosenAt = -Infinity;
    }
    this.check();
  }

  /** Have all pages show the camera that is chosen. */
  choose() {
    this.chosenAt = performance.now();
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(this.choice.value);
  }

  connect() {
    if (this.socket) return;
    const socket = new WebSocket(`ws://${location.host}/ws/camera`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onmessage = (event) => this.take(socket, event.data);
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.socket = null;
      setTimeout(() => this.connectOrNot(), PAUSE);
    };
  }

  disconnect() {
    const { socket } = this;
    this.socket = null;
    if (socket?.readyState === WebSocket.CONNECTING) socket.onopen = () => socket.close(); // closing it now is an error
    else socket?.close();
  }

  /** @param {WebSocket} socket @param {ArrayBuffer} data */
  async take(socket, data) {
    const jpeg = new Blob([new Uint8Array(data, HEAD + STAMP)], { type: "image/jpeg" });
    const picture = await createImageBitmap(jpeg).catch(() => null);
    if (picture && this.socket === socket) {
      if (this.canvas.width !== picture.width || this.canvas.height !== picture.height) {
        [this.canvas.width, this.canvas.height] = [picture.width, picture.height];
      }
      this.canvas.getContext("2d")?.drawImage(picture, 0, 0);
      this.stamp = new DataView(data).getFloat64(HEAD, true);
      this.shownAt = performance.now();
      this.count += 1;
      this.check();
    }
    picture?.close();
    if (socket.readyState === WebSocket.OPEN) socket.send("shown");
  }

  check() {
    if (!this.open) return;
    if (performance.now() - this.chosenAt > CHOICE) this.choice.value = this.topic;
    const old = performance.now() - this.shownAt > OLD;
    this.canvas.hidden = this.count === 0;
    this.canvas.classList.toggle("old", old);
    this.note.hidden = !old;
    this.note.textContent = this.count ? TEXTS.camera.old : TEXTS.camera.waiting;
  }
}
