// @ts-check
/** The battery since the page was opened: its charge every 10 s, for hours. */

const PERIOD = 10_000; // ms
const MOST = 2880; // samples: 8 hours

export class BatteryHistory {
  constructor() {
    /** Time in ms, share or null, volts or null. @type {[number, number | null, number | null][]} */
    this.samples = [];
    /** @type {{share: number | null, volts: number | null} | null} */
    this.newest = null;
  }

  /** @param {{share: number | null, volts: number | null} | null} battery @param {number} now ms */
  take(battery, now) {
    this.newest = battery;
    this.note(now);
  }

  /** Keep the newest state: it is sent only when it changes. @param {number} now ms */
  note(now) {
    const last = this.samples.at(-1);
    if (!this.newest || (last && now - last[0] < PERIOD)) return;
    this.samples = [...this.samples.slice(1 - MOST), [now, this.newest.share, this.newest.volts]];
  }
}

/** The battery since the page was opened. */
export const BATTERY = new BatteryHistory();
