// @ts-check
/** The devices that are logged in: named, logged out, and others invited by a link with its QR code. */

import { make, makeButton, makeNote, makeSureButton, replaceRows } from "./elements.js";
import { TEXTS } from "./texts.js";

/** @typedef {{id: string, name: string, role: "look" | "drive", address: string, first: number, last: number, until: number, own: boolean, open: boolean}} Device */

const EVERY = 5000; // ms between two looks at the list
const CODE_SIZE = 240; // pixels

/** @type {import("./panels.js").Panel} */
export const DEVICE_PANEL = {
  name: "devices",
  label: TEXTS.devices.title,
  icon: "M3 5h13v9H3zM1 18h13M17 9h5v11h-5zM19 17.5h1",
  make: (box, page) => {
    const panel = new DevicePanel(box, page.mayDrive);
    let timer = 0;
    return {
      show: (open) => {
        clearInterval(timer);
        if (!open) return panel.hideCode();
        panel.load();
        timer = setInterval(() => panel.load(), EVERY);
      },
    };
  },
};

class DevicePanel {
  /** @param {HTMLElement} box @param {boolean} mayDrive */
  constructor(box, mayDrive) {
    this.mayDrive = mayDrive;
    this.note = makeNote();
    this.list = make("ul");
    this.others = makeSureButton(TEXTS.devices.endOthers, () => this.change("end", { id: "others" }));
    this.form = make("form");
    this.input = make("input");
    this.input.placeholder = this.input.ariaLabel = TEXTS.devices.ownName;
    this.input.maxLength = 40;
    this.input.autocomplete = "off";
    this.form.append(this.input, make("button", TEXTS.devices.name));
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.change("name", { name: this.input.value });
    });
    const row = make("div", "", "row");
    row.append(makeButton(TEXTS.devices.inviteLook, () => this.invite("look")));
    if (mayDrive) row.append(makeButton(TEXTS.devices.inviteDrive, () => this.invite("drive")));
    this.code = make("div");
    box.append(this.note, this.list, this.form, this.others, make("h3", TEXTS.devices.invite), row, this.code);
    this.others.hidden = true;
    this.say("");
  }

  async load() {
    if (!this.mayDrive) return;
    const answer = await fetch("/api/sessions").catch(() => null);
    if (!answer?.ok) return this.say(answer ? await answer.text() : TEXTS.noAnswer);
    /** @type {Device[]} */
    const devices = await answer.json();
    this.say("");
    this.others.hidden = devices.length < 2;
    replaceRows(this.list, devices.map((device) => this.makeRow(device)));
  }

  /** @param {Device} device */
  makeRow(device) {
    const row = make("li");
    const text = make("span", "", "grow");
    text.append(make("b", device.name), make("br"), make("small", TEXTS.devices.facts(device, Date.now() / 1000)));
    row.append(text);
    if (!device.own) {
      row.append(makeSureButton(TEXTS.devices.end, () => this.change("end", { id: device.id }), TEXTS.devices.endOf(device.name)));
    }
    return row;
  }

  /** @param {"end" | "name"} what @param {Record<string, string>} value */
  async change(what, value) {
    const answer = await fetch(`/api/sessions/${what}`, { method: "POST", body: JSON.stringify(value) }).catch(() => null);
    if (!answer?.ok) return this.say(answer ? await answer.text() : TEXTS.noAnswer);
    if (what === "name") {
      this.say(TEXTS.devices.named((await answer.json()).name));
      this.input.value = "";
      if (!this.mayDrive) return;
    }
    await this.load();
  }

  /** @param {"look" | "drive"} role */
  async invite(role) {
    const answer = await fetch("/api/invite", { method: "POST", body: JSON.stringify({ role }) }).catch(() => null);
    if (!answer?.ok) return this.say(answer ? await answer.text() : TEXTS.noAnswer);
    const { link, code, local } = await answer.json();
    this.hideCode();
    const image = make("img");
    image.alt = TEXTS.devices.code;
    image.width = image.height = CODE_SIZE;
    const address = URL.createObjectURL(new Blob([code], { type: "image/svg+xml" }));
    image.addEventListener("load", () => URL.revokeObjectURL(address));
    image.src = address;
    const note = makeNote(TEXTS.devices.invited(role));
    this.code.append(note, image, make("pre", link));
    if (local) this.code.append(make("p", TEXTS.devices.local, "problem"));
    note.scrollIntoView();
  }

  /** A link is for one device: it is not left on the screen. */
  hideCode() {
    this.code.replaceChildren();
  }

  /** @param {string} text */
  say(text) {
    this.note.textContent = text;
    this.note.hidden = !text;
  }
}
