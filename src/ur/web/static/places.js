// @ts-check
/** The list of the map's places: drive to one, name the robot's, delete one. */

import { TEXTS } from "./texts.js";
import { KIND, readJson } from "./wire.js";

/** @typedef {{named: boolean, places: Record<string, [number, number, number]>, problem: string}} PlaceList */

const SURE_TIME = 4000; // ms to press "delete" again

/** @type {import("./panels.js").Panel} */
export const PLACE_PANEL = {
  name: "places",
  label: TEXTS.places,
  icon: "M12 21c4-5 6-8 6-11a6 6 0 0 0-12 0c0 3 2 6 6 11zM10 10a2 2 0 1 0 4 0a2 2 0 1 0-4 0",
  make: (box, page) => {
    const places = new PlacePanel(
      box,
      page.mayDrive,
      (message) => page.sendPlace(message),
      () => (page.poseAge < 2 ? (page.pose ?? null) : null),
    );
    page.frames.on(KIND.PLACES, (frame) => {
      const found = readJson(frame);
      places.show(found);
      page.map.places = found.places;
      page.map.request();
    });
  },
};

export class PlacePanel {
  /**
   * @param {HTMLElement} box @param {boolean} mayDrive
   * @param {(message: Record<string, unknown>) => void} send
   * @param {() => import("./wire.js").Pose | null} where
   */
  constructor(box, mayDrive, send, where) {
    this.box = box;
    this.mayDrive = mayDrive;
    this.send = send;
    this.where = where;
    const title = document.createElement("h2");
    title.textContent = TEXTS.places;
    this.note = document.createElement("p");
    this.list = document.createElement("ul");
    this.form = document.createElement("form");
    this.input = document.createElement("input");
    this.input.placeholder = this.input.ariaLabel = TEXTS.placeName;
    this.input.id = "place-name";
    this.input.maxLength = 40;
    this.input.autocomplete = "off";
    this.input.autocapitalize = "off";
    const button = document.createElement("button");
    button.textContent = TEXTS.nameHere;
    button.id = "place-here";
    this.form.append(this.input, button);
    this.form.addEventListener("submit", (event) => this.name(event));
    box.append(title, this.note, this.list, this.form);
    this.show({ named: false, places: {}, problem: "" });
  }

  /** @param {PlaceList} found */
  show(found) {
    const names = Object.keys(found.places);
    this.note.textContent = found.problem || (!found.named ? TEXTS.noMapName : names.length ? "" : TEXTS.noPlaces);
    this.note.hidden = !this.note.textContent;
    this.form.hidden = !this.mayDrive || !found.named;
    this.list.replaceChildren(...names.map((name) => this.makeRow(name)));
  }

  /** @param {string} name */
  makeRow(name) {
    const row = document.createElement("li");
    if (!this.mayDrive) {
      row.textContent = name;
      return row;
    }
    const go = document.createElement("button");
    go.type = "button";
    go.className = "go";
    go.textContent = name;
    go.ariaLabel = TEXTS.driveTo(name);
    go.addEventListener("click", () => this.send({ t: "go_to", place: name }));
    const remove = document.createElement("button");
    remove.type = "button";
    remove.textContent = TEXTS.remove;
    remove.ariaLabel = TEXTS.removePlace(name);
    let sureUntil = -Infinity;
    remove.addEventListener("click", () => {
      if (performance.now() < sureUntil) {
        this.send({ t: "forget_place", place: name });
        return;
      }
      sureUntil = performance.now() + SURE_TIME;
      remove.textContent = TEXTS.sure;
      setTimeout(() => (remove.textContent = TEXTS.remove), SURE_TIME);
    });
    row.append(go, remove);
    return row;
  }

  /** @param {SubmitEvent} event */
  name(event) {
    event.preventDefault();
    const [pose, place] = [this.where(), this.input.value.trim()];
    if (!place || !pose) return;
    this.send({ t: "name_place", place, x: pose.x, y: pose.y, yaw: pose.yaw });
    this.input.value = "";
    this.input.blur(); // the keys drive again
  }
}
