// @ts-check
/** The list of layers over the map, each with a switch. */

import { LAYERS, keepLink } from "./link_state.js";
import { TEXTS } from "./texts.js";

/** @type {import("./panels.js").Panel} */
export const LAYER_PANEL = {
  name: "layers",
  label: TEXTS.layers,
  icon: "M12 3l9 5-9 5-9-5zM3 13l9 5 9-5",
  make: (box, page) => void new LayerPanel(box, page.map, () => page.socket.reopen()),
};

export class LayerPanel {
  /** @param {HTMLElement} box @param {import("./map_view.js").MapView} map @param {() => void} onChange */
  constructor(box, map, onChange) {
    const { layers } = map;
    const title = document.createElement("h2");
    title.textContent = TEXTS.layers;
    const list = document.createElement("ul");
    for (const name of LAYERS) {
      const row = document.createElement("li");
      const label = document.createElement("label");
      const input = document.createElement("input");
      input.type = "checkbox";
      input.id = `layer-${name}`;
      input.checked = layers.has(name);
      input.addEventListener("change", () => {
        if (input.checked) layers.add(name);
        else layers.delete(name);
        keepLink(map);
        map.request();
        onChange();
      });
      const swatch = document.createElement("span");
      swatch.className = `swatch ${name}`;
      label.append(input, swatch, TEXTS.layerNames[/** @type {"scan"} */ (name)]);
      row.append(label);
      list.append(row);
    }
    box.append(title, list);
  }
}
