// @ts-check
/** The list of layers over the map, each with a switch. */

import { SWITCHES, keepLink } from "./link_state.js";
import { TEXTS } from "./texts.js";
import { LAYERS } from "./wire_numbers.js";

/** @type {import("./panels.js").Panel} */
export const LAYER_PANEL = {
  name: "layers",
  label: TEXTS.layers,
  icon: "M12 3l9 5-9 5-9-5zM3 13l9 5 9-5",
  make: (box, page) => void new LayerPanel(box, page),
};

export class LayerPanel {
  /** @param {HTMLElement} box @param {import("./main.js").Page} page */
  constructor(box, page) {
    const { layers } = page.map;
    const list = document.createElement("ul");
    for (const name of SWITCHES) {
      const row = document.createElement("li");
      const label = document.createElement("label");
      const input = document.createElement("input");
      input.type = "checkbox";
      input.id = `layer-${name}`;
      input.checked = layers.has(name);
      input.addEventListener("change", () => {
        if (input.checked) layers.add(name);
        else layers.delete(name);
        keepLink(page);
        page.map.request();
        page.socket.change();
      });
      const swatch = document.createElement("span");
      swatch.className = `swatch ${name}`;
      label.append(input, swatch, LAYERS[name] ?? TEXTS.trail);
      row.append(label);
      list.append(row);
    }
    box.append(list);
  }
}
