// @ts-check
/** The speed limit, which the robot keeps for every client, and the gamepad. */

import { make, sentence } from "./elements.js";
import { Gamepads } from "./gamepad.js";
import { TEXTS } from "./texts.js";
import { KIND } from "./wire.js";

const LEAST = 10; // percent

/** @type {import("./panels.js").Panel} */
export const SPEED_PANEL = {
  name: "speed",
  label: TEXTS.speedLimit.title,
  icon: "M4 18a9 9 0 1 1 16 0M12 15l5-6M11 15a1 1 0 1 0 2 0a1 1 0 1 0-2 0",
  make: (box, page) => {
    const note = make("p");
    const label = make("label", "", "stacked");
    const value = make("span");
    const slider = make("input");
    slider.type = "range";
    slider.id = "speed-limit";
    [slider.min, slider.max, slider.step] = [String(LEAST), "100", "5"];
    slider.ariaLabel = TEXTS.speedLimit.title;
    label.append(value, slider);
    const pads = make("p");
    const sources = make("p");
    box.append(note, label, sources, pads);
    const show = (/** @type {number} */ percent) => {
      const top = page.state?.robot.limits[0] ?? 0;
      value.textContent = TEXTS.speedLimit.value(percent, (percent / 100) * top);
      slider.ariaValueText = value.textContent;
    };
    slider.addEventListener("input", () => show(Number(slider.value)));
    slider.addEventListener("change", () => {
      if (!page.drive?.send({ t: "limit", percent: Number(slider.value) })) page.sayNotSent();
    });
    page.frames.onJson(KIND.STATE, ({ limit, sources: names, mux }) => {
      const word = (/** @type {string} */ name) => TEXTS.sources[name] ?? name;
      sources.textContent = names?.length ? TEXTS.commandSources(names.map(word), word(mux.active)) : "";
      sources.hidden = !names?.length;
      slider.disabled = !page.mayDrive || typeof limit !== "number";
      const help = TEXTS.speedLimit[limit === null ? "none" : limit === undefined ? "unknown" : "help"];
      const { stop } = page.state?.robot ?? {};
      note.textContent = stop ? `${help} ${sentence(stop)}.` : help;
      if (document.activeElement !== slider || slider.disabled) slider.value = String(limit ?? 100);
      if (document.activeElement !== slider) show(limit ?? 100);
    }, {});
    if (page.drive === null) return;
    const { drive } = page;
    page.gamepads = new Gamepads(
      () => page.mode === "drive",
      (forward, turn) => page.push(forward, turn),
      () => drive.letGo(),
      () => void page.stop(),
      () => drive.press !== "idle",
    );
    const name = () => (pads.textContent = page.gamepads?.names.map(TEXTS.speedLimit.gamepad).join(" ") ?? "");
    addEventListener("gamepadconnected", name);
    addEventListener("gamepaddisconnected", name);
  },
};
