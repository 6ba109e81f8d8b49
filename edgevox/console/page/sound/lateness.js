/** How much later sound comes than the most prompt of late; both clocks count milliseconds. */

/** The clocks of page and robot may part by a millisecond in so many; none is worse. */
const DRIFT = 2000;
const WRAP = 2 ** 32;

export class Lateness {
  constructor() {
    this.least = 0;
    this.at = NaN;
  }

  /**
   * Milliseconds, not below 0.
   * @param {number} now
   * @param {number} sent starts over at 2**32
   */
  of(now, sent) {
    if (Number.isNaN(this.at)) this.least = now - sent;
    else this.least += (now - this.at) / DRIFT;
    this.at = now;
    const off = now - sent - this.least + WRAP / 2;
    const late = off - Math.floor(off / WRAP) * WRAP - WRAP / 2;
    if (late < 0) this.least += late;
    return Math.max(0, late);
  }
}
