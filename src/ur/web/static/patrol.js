// @ts-check
/** A patrol: from place to place, in the order in which they were chosen, until it ends or a goal fails. */

/** @typedef {{number: number, state: string, text: string}} Goal */
/** @typedef {"late" | "failed" | "replaced" | "refused" | "emergency" | "done" | "ended"} PatrolEnd */

const ANSWER_TIME = 5000; // ms until a goal that was sent must be known to navigation
const PAUSE = 1000; // ms at each place

export class Patrol {
  /**
   * @param {string[]} places @param {boolean} repeat begin again after the last place
   * @param {(place: string) => boolean} send send a goal; false: it cannot be sent now
   * @param {(end: PatrolEnd, place: string, text: string) => void} onEnd
   */
  constructor(places, repeat, send, onEnd) {
    this.places = places;
    this.repeat = repeat;
    this.send = send;
    this.onEnd = onEnd;
    this.index = 0;
    this.running = true;
    /** The number of the goal of this patrol; null: not known yet. @type {number | null} */
    this.mine = null;
    this.newest = -1; // of the goals before
    this.sentAt = -Infinity;
    this.reachedAt = Infinity;
  }

  get place() {
    return this.places[this.index] ?? "";
  }

  /** Begin, or go on to the next place. @param {Goal} goal the newest one @param {number} now in ms */
  begin(goal, now) {
    this.mine = null;
    this.reachedAt = Infinity;
    this.newest = goal.number;
    this.sentAt = now;
    if (!this.send(this.place)) this.end("late");
  }

  /** Take the state of navigation. @param {Goal} goal @param {boolean} stopped by an emergency @param {number} now in ms */
  step(goal, stopped, now) {
    if (!this.running) return;
    if (stopped) {
      this.end("emergency");
      return;
    }
    if (this.mine === null) {
      if (goal.number <= this.newest) {
        if (now - this.sentAt > ANSWER_TIME) this.end("late");
        return;
      }
      this.mine = goal.number;
    }
    if (goal.number > this.mine) this.end("replaced");
    else if (goal.state === "stopped") this.end("ended");
    else if (goal.state === "failed") this.end("failed", goal.text);
    else if (goal.state === "reached") this.arrive(goal, now);
  }

  /** @param {Goal} goal @param {number} now */
  arrive(goal, now) {
    this.reachedAt = Math.min(this.reachedAt, now);
    if (now - this.reachedAt < PAUSE) return;
    const last = this.index + 1 === this.places.length;
    if (last && !this.repeat) {
      this.end("done");
      return;
    }
    this.index = last ? 0 : this.index + 1;
    this.begin(goal, now);
  }

  /** @param {PatrolEnd} why @param {string} text */
  end(why, text = "") {
    if (!this.running) return;
    this.running = false;
    this.onEnd(why, this.place, text);
  }
}
