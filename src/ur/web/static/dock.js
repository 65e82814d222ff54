// @ts-check
/** The place of open panels: beside the map on a desk, where their width can be dragged; over it on a small page. */

import { TEXTS } from "./texts.js";

const DESK = "(min-width: 900px) and (min-height: 500px)"; // as in layout.css
const LEAST = 280; // pixels
const MAP = 620; // pixels that the map keeps
const STEP = 32; // pixels of a key

export class Dock {
  /** @param {HTMLElement} box @param {number} width pixels, 0: by itself @param {() => void} onRoom there is more or less room */
  constructor(box, width, onRoom) {
    this.box = box;
    this.width = width;
    this.desk = matchMedia(DESK);
    this.count = 0;
    this.handle = document.createElement("div");
    this.handle.id = "dock-width";
    this.handle.tabIndex = 0;
    this.handle.role = "separator";
    this.handle.ariaOrientation = "vertical";
    this.handle.ariaLabel = TEXTS.dockWidth;
    this.handle.addEventListener("pointerdown", (event) => this.handle.setPointerCapture(event.pointerId));
    this.handle.addEventListener("pointermove", (event) => {
      if (this.handle.hasPointerCapture(event.pointerId)) this.resize(innerWidth - event.clientX);
    });
    this.handle.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: STEP, ArrowRight: -STEP }[event.key];
      if (!step) return;
      event.preventDefault();
      event.stopPropagation(); // arrows drive the robot elsewhere
      this.resize(this.box.offsetWidth + step);
    });
    box.before(this.handle);
    addEventListener("resize", () => (onRoom(), this.fill(this.count)));
    this.fill(0);
  }

  /** Panels cover the map, instead of standing beside it. */
  get covers() {
    return !this.desk.matches;
  }

  /** The most pixels that panels get. */
  get widest() {
    return Math.max(LEAST, innerWidth - MAP);
  }

  /** The number of panels that have room. */
  get most() {
    if (this.covers) return 1;
    return innerWidth >= 1500 ? 4 : innerHeight >= 700 ? 3 : 2;
  }

  /** Show this many panels. @param {number} count */
  fill(count) {
    this.count = count;
    document.body.dataset.docked = this.covers ? "0" : String(count);
    this.handle.hidden = this.covers || !count;
    const width = Math.min(this.width, this.widest);
    if (width) document.body.style.setProperty("--dock-chosen", `${width}px`);
    if (this.handle.hidden) return;
    this.handle.ariaValueMin = String(LEAST);
    this.handle.ariaValueMax = String(this.widest);
    this.handle.ariaValueNow = String(this.box.offsetWidth);
  }

  /** @param {number} width pixels */
  resize(width) {
    this.width = Math.round(Math.max(LEAST, Math.min(width, this.widest)));
    this.fill(this.count);
  }
}
