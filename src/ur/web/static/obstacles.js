// @ts-check
/** The obstacle stop: a line above the stick with what it does now, and the button that turns it on and off. */

import { element, make, makeButton, sentence } from "./elements.js";
import { announce } from "./heard.js";
import { TEXTS } from "./texts.js";

export class Obstacles {
  /** @param {import("./main.js").Page} page */
  constructor(page) {
    this.page = page;
    this.state = "none";
    this.text = make("span");
    this.button = makeButton("", () => {
      if (!page.drive?.send({ t: "obstacles", on: this.state === "off" })) page.sayNotSent();
    });
    this.line = element("obstacles");
    this.line.append(this.text, this.button);
  }

  /** Show the state that the mux reports; in other modes than Drive only where there is something to know. @param {any} state */
  show(state) {
    const report = state?.mux.obstacles ?? { state: "none", text: "" };
    const text = TEXTS.obstacles[/** @type {"off"} */ (report.state)] ?? sentence(report.text);
    if (report.state !== this.state && ["slowed", "stopped", "off"].includes(report.state)) announce(text);
    this.state = report.state;
    this.line.hidden = report.state === "none" || (report.state === "clear" && this.page.mode !== "drive");
    this.line.dataset.state = report.state;
    if (this.text.textContent !== text) this.text.textContent = text;
    this.button.textContent = report.state === "off" ? TEXTS.obstacles.turnOn : TEXTS.obstacles.turnOff;
    this.button.ariaLabel = `${this.button.textContent} ${TEXTS.obstacles.name}`;
    this.button.hidden = !this.page.mayDrive || (this.page.mode !== "drive" && report.state !== "off");
  }
}
