// @ts-check
/** The list of the map's places: drive to one or to several in turn, name the robot's, delete one. */

import { checkName, make, makeButton, makeNote, makeSureButton, replaceRows, sentence } from "./elements.js";
import { PatrolBox } from "./patrol.js";
import { PlaceEditor } from "./place_editor.js";
import { TEXTS } from "./texts.js";
import { KIND } from "./wire.js";

/** @typedef {{named: boolean, places: Record<string, [number, number, number]>, problem: string}} PlaceList */
const NO_PLACES = /** @type {PlaceList} */ ({ named: false, places: {}, problem: "" });

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
      (text) => page.say(text),
      (help, take) => page.pick(help, take),
    );
    page.frames.onJson(KIND.STATE, ({ patrol }) => places.patrol.show(patrol ?? null), {});
    page.frames.onJson(KIND.PLACES, (/** @type {PlaceList} */ found) => {
      places.show(found);
      page.map.places = found.places;
      page.map.request();
    }, NO_PLACES);
  },
};

export class PlacePanel {
  /**
   * @param {HTMLElement} box @param {boolean} mayDrive
   * @param {(message: Record<string, unknown>) => void} send
   * @param {() => import("./wire.js").Pose | null} where
   * @param {(text: string) => void} say
   * @param {(help: string, take: (place: import("./map_view.js").Place) => void) => void} pick has a place of the map pointed at
   */
  constructor(box, mayDrive, send, where, say, pick) {
    this.box = box;
    this.mayDrive = mayDrive;
    this.send = send;
    this.where = where;
    this.say = say;
    this.pick = pick;
    this.editor = new PlaceEditor(send, where, pick, say, () => this.show(this.found));
    this.patrol = new PatrolBox(mayDrive, send);
    /** The name of a place that is moved when its name is given again. */
    this.sureOf = "";
    this.found = NO_PLACES;
    /** @type {string[]} */
    this.names = [];
    this.note = makeNote();
    this.list = document.createElement("ul");
    this.form = document.createElement("form");
    this.input = document.createElement("input");
    this.input.placeholder = this.input.ariaLabel = TEXTS.placeName;
    this.input.id = "place-name";
    this.input.maxLength = 40;
    this.input.autocomplete = "off";
    this.input.autocapitalize = "off";
    const button = make("button", TEXTS.nameHere);
    button.id = "place-here";
    const onMap = makeButton(TEXTS.nameOnMap, () => this.name(true), TEXTS.nameOnMapHelp);
    onMap.id = "place-on-map";
    this.form.append(this.input, button, onMap);
    this.form.addEventListener("submit", (event) => (event.preventDefault(), this.name(false)));
    box.append(this.note, this.list, this.patrol.box, this.form);
  }

  /** @param {PlaceList} found */
  show(found) {
    this.found = found;
    const names = Object.keys(found.places);
    this.editor.take(found.places);
    this.names = names;
    this.note.textContent = sentence(found.problem) || (!found.named ? TEXTS.noMapName : names.length ? "" : TEXTS.noPlaces);
    this.note.hidden = !this.note.textContent;
    this.form.hidden = !this.mayDrive || !found.named;
    this.patrol.offer(names);
    replaceRows(this.list, names.flatMap((name) => (name === this.editor.name ? [this.makeRow(name), this.editor.row] : [this.makeRow(name)])));
  }

  /** @param {string} name */
  makeRow(name) {
    if (!this.mayDrive) return make("li", name);
    const row = make("li");
    const go = makeButton(name, () => this.send({ t: "go_to", place: name }), TEXTS.driveTo(name));
    go.className = "go";
    const remove = makeSureButton(TEXTS.remove, () => this.send({ t: "forget_place", place: name }), TEXTS.removePlace(name));
    const tick = make("input");
    tick.type = "checkbox";
    tick.checked = this.patrol.chosen.includes(name);
    tick.ariaLabel = TEXTS.patrol.include(name);
    tick.addEventListener("change", () => this.patrol.choose(name, tick.checked));
    const target = make("label", "", "tick");
    target.append(tick);
    const edit = makeButton(TEXTS.editPlace, () => this.editor.toggle(name), TEXTS.editPlaceOf(name));
    edit.ariaExpanded = String(this.editor.name === name);
    row.append(target, go, edit, remove);
    return row;
  }

  /** Give the name that was typed to the robot's place, or to one that is pointed at. @param {boolean} onMap */
  name(onMap) {
    const [pose, place] = [this.where(), this.input.value.trim()];
    const problem = checkName(place) || (pose || onMap ? "" : TEXTS.noPose);
    if (problem) {
      this.say(problem);
      return;
    }
    if (this.names.includes(place) && this.sureOf !== place) {
      this.sureOf = place;
      this.say(TEXTS.placeTaken(place));
      return;
    }
    this.sureOf = "";
    const send = (/** @type {{x: number, y: number, yaw?: number | null}} */ { x, y, yaw }) => this.send({ t: "name_place", place, x, y, yaw: yaw ?? 0 });
    this.input.value = "";
    this.input.blur(); // the keys drive again
    if (onMap) this.pick(TEXTS.pickPlace(place), send);
    else if (pose) send(pose);
  }
}
