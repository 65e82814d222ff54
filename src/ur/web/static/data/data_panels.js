// @ts-check
/** Panels with data of the robot. The script of each is loaded when it is opened first. */

import { make } from "../elements.js";
import { KIND } from "../wire.js";
import { BATTERY } from "./battery_history.js";
import { DATA_TEXTS } from "./texts.js";

/** @typedef {(box: HTMLElement, page: import("../main.js").Page) => {show: (open: boolean) => void}} Maker */

/**
 * `early` is called when the page opens.
 * @param {string} name @param {string} label @param {string} icon @param {() => Promise<Maker>} load
 * @param {(page: import("../main.js").Page) => void} [early] @returns {import("../panels.js").Panel}
 */
function makeLazy(name, label, icon, load, early) {
  return {
    name,
    label,
    icon,
    wide: true,
    make: (box, page) => {
      early?.(page);
      /** @type {Promise<{show: (open: boolean) => void}> | null} */
      let part = null;
      let shown = false;
      /** @param {boolean} open */
      const show = async (open) => {
        if (shown === open) return;
        shown = open;
        part ??= load().then((maker) => maker(box, page));
        try {
          (await part).show(open);
        } catch {
          part = null;
          shown = false;
          box.append(make("p", DATA_TEXTS.noAnswer, "problem"));
        }
      };
      return { show };
    },
  };
}

export const TOPIC_PANEL = makeLazy("topics", DATA_TEXTS.topics, "M4 6h10M4 12h16M4 18h7M18 4v4M11 16v4", async () => (await import("./topic_panel.js")).makeTopicPanel);

export const STATUS_PANEL = makeLazy(
  "status",
  DATA_TEXTS.status,
  "M4 5h16v10H4zM9 19h6M12 15v4M7 10h2l2-3 2 5 1-2h3",
  async () => (await import("./status_panel.js")).makeStatusPanel,
  (page) => page.frames.onJson(KIND.STATE, ({ battery }) => BATTERY.take(battery ?? null, Date.now()), {}),
);
export const SCENE_PANEL = makeLazy("scene", DATA_TEXTS.scene, "M12 3l8 4.5v9L12 21l-8-4.5v-9zM4 7.5l8 4.5 8-4.5M12 12v9", async () => (await import("./scene_panel.js")).makeScenePanel);
export const RECORDING_PANEL = makeLazy("recordings", DATA_TEXTS.recordings, "M12 4a8 8 0 1 0 0 16a8 8 0 1 0 0-16M12 9a3 3 0 1 0 0 6a3 3 0 1 0 0-6", async () => (await import("./recording_panel.js")).makeRecordingPanel);
