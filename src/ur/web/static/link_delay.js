// @ts-check
/** The delay of the connection to the server, measured when a press of the stick ended because commands were late. */

const ENOUGH = 150; // ms: an older command is ignored; see ur_nodes.motion.challenge.freshness
const TRIES = 3; // the first may open a connection

export class LinkDelay {
  /** @param {() => Promise<unknown>} ask a short request to the server @param {() => number} now ms */
  constructor(ask = () => fetch("/api/me", { cache: "no-store" }), now = () => performance.now()) {
    this.ask = ask;
    this.now = now;
    /** The press that was judged. */
    this.hold = -1;
    /** Milliseconds there and back, 0: not measured, or fast enough for driving by hand. */
    this.slow = 0;
  }

  /** Measure for a press, once. @param {number} hold */
  async measure(hold) {
    if (hold === this.hold) return;
    this.hold = hold;
    let best = Infinity;
    for (let count = 0; count < TRIES; count++) {
      const began = this.now();
      const answer = await this.ask().catch(() => null);
      if (answer) best = Math.min(best, this.now() - began);
    }
    this.slow = best > ENOUGH && best < Infinity ? Math.round(best / 10) * 10 : 0;
  }
}
