// @ts-check
/** The scale of the map as a bar, and the coordinates of what is pointed at. */

import { make } from "./elements.js";
import { TEXTS } from "./texts.js";

const LONGEST = 110; // pixels of the bar
const STEPS = [1, 2, 5, 10];

export class MapScale {
  /** @param {import("./map_view.js").MapView} map @param {HTMLElement} box */
  constructor(map, box) {
    this.map = map;
    this.bar = make("div", "", "length");
    this.at = make("div", "", "number");
    box.append(this.bar, this.at);
    this.shown = 0;
    map.painters.push((_, view) => this.show(view.scale));
    const { canvas } = map;
    for (const name of ["pointermove", "pointerdown"]) {
      canvas.addEventListener(name, (event) => this.point(/** @type {PointerEvent} */ (event)));
    }
    for (const name of ["pointerleave", "pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (event) => {
        if (name === "pointerleave" || /** @type {PointerEvent} */ (event).pointerType !== "mouse") this.at.textContent = "";
      });
    }
  }

  /** @param {number} scale pixels a metre */
  show(scale) {
    if (scale === this.shown) return;
    this.shown = scale;
    const metres = longest(LONGEST / scale);
    this.bar.style.width = `${metres * scale}px`;
    this.bar.textContent = TEXTS.length(metres);
  }

  /** @param {PointerEvent} event */
  point(event) {
    const [x, y] = this.map.view.toPlane(event.offsetX, event.offsetY);
    this.at.textContent = TEXTS.coordinates(x, y);
  }
}

/** The longest of 1, 2 or 5 times a power of ten that is no longer than this. @param {number} most */
export function longest(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return power * Math.max(...STEPS.filter((step) => step * power <= most * (1 + 1e-9)));
}
