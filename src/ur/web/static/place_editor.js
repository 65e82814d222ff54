// @ts-check
/** The line below a place of the list that renames it, or moves it to the robot or to a point of the map. */

import { checkName, make, makeButton } from "./elements.js";
import { TEXTS } from "./texts.js";

/** @typedef {{x: number, y: number, yaw?: number | null}} At */

export class PlaceEditor {
  /**
   * @param {(message: Record<string, unknown>) => void} send
   * @param {() => At | null} where the robot is
   * @param {(help: string, take: (place: At) => void) => void} pick
   * @param {(text: string) => void} say @param {() => void} redraw the list
   */
  constructor(send, where, pick, say, redraw) {
    this.send = send;
    this.say = say;
    this.redraw = redraw;
    /** The place that is edited; "": none. */
    this.name = "";
    /** x, y, yaw by name. @type {Record<string, number[]>} */
    this.places = {};
    /** The old name is deleted as soon as the new one is seen in the list. @type {{from: string, to: string} | null} */
    this.renamed = null;
    this.input = make("input");
    this.input.maxLength = 40;
    this.input.autocomplete = "off";
    this.input.autocapitalize = "off";
    const rename = make("button", TEXTS.rename);
    const form = make("form");
    form.append(this.input, rename);
    form.addEventListener("submit", (event) => (event.preventDefault(), this.rename()));
    const move = (/** @type {At} */ { x, y, yaw }) => send({ t: "name_place", place: this.name, x, y, yaw: yaw ?? 0 });
    const here = makeButton(TEXTS.moveHere, () => {
      const pose = where();
      if (pose) move(pose);
      else say(TEXTS.noPose);
    });
    const onMap = makeButton(TEXTS.moveOnMap, () => pick(TEXTS.pickPlace(this.name), move));
    const buttons = make("div", "", "row");
    buttons.append(onMap, here);
    this.row = make("li", "", "edited");
    this.row.append(form, buttons);
  }

  /** Edit a place, or end that. @param {string} name */
  toggle(name) {
    this.name = this.name === name ? "" : name;
    this.input.value = this.name;
    this.input.ariaLabel = TEXTS.newName(this.name);
    this.redraw();
    if (this.name) this.input.focus();
  }

  /** Take the places of the robot. @param {Record<string, number[]>} places */
  take(places) {
    this.places = places;
    const { renamed } = this;
    if (renamed && renamed.to in places) {
      this.renamed = null;
      if (renamed.from in places) this.send({ t: "forget_place", place: renamed.from });
    }
    if (this.name && !(this.name in places)) this.name = "";
  }

  rename() {
    const [from, to] = [this.name, this.input.value.trim()];
    if (to === from) return;
    const problem = checkName(to) || (to in this.places ? TEXTS.nameTaken(to) : "");
    if (problem) {
      this.say(problem);
      return;
    }
    const [x, y, yaw] = this.places[from];
    this.renamed = { from, to };
    this.send({ t: "name_place", place: to, x, y, yaw });
    this.toggle(from);
  }
}
