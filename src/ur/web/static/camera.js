// @ts-check
/** The robot's camera, on a web socket of its own: the newest picture only, as fast as the connection bears. */

import { make, makeNote } from "./elements.js";
import { TEXTS } from "./texts.js";
import { HEAD } from "./wire.js";

const STAMP = 8; // bytes: seconds since 1970
const PAUSE = 1000; // ms before another connection is tried
const OLD = 3000; // ms

/** @type {import("./panels.js").Panel} */
export const CAMERA_PANEL = {
  name: "camera",
  label: TEXTS.camera.title,
  icon: "M3 8h4l2-3h6l2 3h4v11H3zM9 13a3 3 0 1 0 6 0a3 3 0 1 0-6 0",
  make: (box, page) => {
    const camera = new CameraPanel(box);
    page.camera = camera;
    return { show: (open) => camera.show(open) };
  },
};

export class CameraPanel {
  /** @param {HTMLElement} box */
  constructor(box) {
    box.classList.add("picture");
    this.canvas = make("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.ariaLabel = TEXTS.camera.picture;
    this.canvas.hidden = true;
    this.note = makeNote(TEXTS.camera.waiting);
    box.append(this.canvas, this.note);
    this.open = false;
    /** Pictures shown so far. */
    this.count = 0;
    this.shownAt = -Infinity;
    /** Seconds since 1970: when the newest picture was taken. */
    this.stamp = 0;
    /** @type {WebSocket | null} */
    this.socket = null;
    setInterval(() => this.check(), 500);
    document.addEventListener("visibilitychange", () => this.show(this.open));
  }

  /** @param {boolean} open */
  show(open) {
    this.open = open;
    if (open && !document.hidden) this.connect();
    else this.disconnect();
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
      setTimeout(() => this.show(this.open), PAUSE);
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
    const old = performance.now() - this.shownAt > OLD;
    this.canvas.hidden = this.count === 0;
    this.canvas.classList.toggle("old", old);
    this.note.hidden = !old;
    this.note.textContent = this.count ? TEXTS.camera.old : TEXTS.camera.waiting;
  }
}
