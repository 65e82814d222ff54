// @ts-check
/** The list of the map's places: drive to one or to several in turn, name the robot's, delete one. */

import { checkName, make, makeNote, makeSureButton, replaceRows, sentence } from "./elements.js";
import { Patrol } from "./patrol.js";
import { TEXTS } from "./texts.js";
import { KIND, readJson } from "./wire.js";

/** @typedef {{named: boolean, places: Record<string, [number, number, number]>, problem: string}} PlaceList */

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
      (places, repeat, onEnd) => {
        const patrol = new Patrol(places, repeat, (place) => page.drive?.request({ t: "go_to", place }) ?? false, onEnd);
        patrol.begin(page.state.goal, performance.now());
        return patrol;
      },
      () => page.drive?.send({ t: "cancel" }),
      (text) => page.say(text),
    );
    page.frames.on(KIND.STATE, (frame) => {
      const { goal, mux } = readJson(frame);
      places.patrol?.step(goal, mux.stopped === true, performance.now());
    });
    page.places = places;
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
   * @param {(places: string[], repeat: boolean, onEnd: (end: import("./patrol.js").PatrolEnd, place: string, text: string) => void) => Patrol} startPatrol
   * @param {() => void} cancel the goal
   * @param {(text: string) => void} say
   */
  constructor(box, mayDrive, send, where, startPatrol, cancel, say) {
    this.box = box;
    this.mayDrive = mayDrive;
    this.send = send;
    this.where = where;
    this.startPatrol = startPatrol;
    this.cancel = cancel;
    this.say = say;
    /** The places of a patrol in its order. @type {string[]} */
    this.chosen = [];
    /** @type {Patrol | null} */
    this.patrol = null;
    /** The name of a place that is moved when its name is given again. */
    this.sureOf = "";
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
    const button = document.createElement("button");
    button.textContent = TEXTS.nameHere;
    button.id = "place-here";
    this.form.append(this.input, button);
    this.form.addEventListener("submit", (event) => this.name(event));
    this.patrolBox = make("div", "", "patrol");
    this.patrolNote = makeNote();
    this.patrolButton = make("button");
    this.patrolButton.type = "button";
    this.patrolButton.id = "patrol";
    this.patrolButton.addEventListener("click", () => this.togglePatrol());
    this.repeat = make("input");
    this.repeat.type = "checkbox";
    this.repeat.id = "patrol-repeat";
    const label = make("label");
    label.append(this.repeat, TEXTS.patrol.repeat);
    this.patrolBox.append(this.patrolNote, label, this.patrolButton);
    box.append(this.note, this.list, this.patrolBox, this.form);
    this.show({ named: false, places: {}, problem: "" });
  }

  /** @param {PlaceList} found */
  show(found) {
    const names = Object.keys(found.places);
    this.names = names;
    this.note.textContent = sentence(found.problem) || (!found.named ? TEXTS.noMapName : names.length ? "" : TEXTS.noPlaces);
    this.note.hidden = !this.note.textContent;
    this.form.hidden = !this.mayDrive || !found.named;
    this.chosen = this.chosen.filter((name) => names.includes(name));
    replaceRows(this.list, names.map((name) => this.makeRow(name)));
    this.showPatrol();
  }

  showPatrol() {
    const patrol = this.patrol?.running ? this.patrol : null;
    this.patrolBox.hidden = !this.mayDrive || this.list.children.length < 2;
    this.patrolButton.textContent = patrol ? TEXTS.patrol.end : TEXTS.patrol.start;
    this.patrolButton.disabled = !patrol && this.chosen.length < 2;
    this.repeat.disabled = patrol !== null;
    const list = patrol ? TEXTS.patrol.drives(patrol.place, patrol.places) : TEXTS.patrol.chosen(this.chosen);
    this.patrolNote.textContent = list;
  }

  togglePatrol() {
    if (this.patrol?.running) {
      this.patrol.end("ended");
      this.cancel();
      return;
    }
    this.patrol = this.startPatrol([...this.chosen], this.repeat.checked, (why, place, text) => {
      this.say(TEXTS.patrol.over[why](place, sentence(text)));
      this.showPatrol();
    });
    this.showPatrol();
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
    const remove = makeSureButton(TEXTS.remove, () => this.send({ t: "forget_place", place: name }), TEXTS.removePlace(name));
    const tick = make("input");
    tick.type = "checkbox";
    tick.checked = this.chosen.includes(name);
    tick.ariaLabel = TEXTS.patrol.include(name);
    tick.addEventListener("change", () => {
      this.chosen = this.chosen.filter((each) => each !== name);
      if (tick.checked) this.chosen.push(name);
      this.showPatrol();
    });
    const target = make("label", "", "tick");
    target.append(tick);
    row.append(target, go, remove);
    return row;
  }

  /** @param {SubmitEvent} event */
  name(event) {
    event.preventDefault();
    const [pose, place] = [this.where(), this.input.value.trim()];
    const problem = checkName(place) || (pose ? "" : TEXTS.noPose);
    if (problem || !pose) {
      this.say(problem);
      return;
    }
    if (this.names.includes(place) && this.sureOf !== place) {
      this.sureOf = place;
      this.say(TEXTS.placeTaken(place));
      return;
    }
    this.sureOf = "";
    this.send({ t: "name_place", place, x: pose.x, y: pose.y, yaw: pose.yaw });
    this.input.value = "";
    this.input.blur(); // the keys drive again
  }
}
