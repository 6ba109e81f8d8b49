/** Another sample rate, as sound streams in: a windowed sinc, of which a table holds the phases. */

const CROSSINGS = 12;
const PHASES = 128;

export class Resampler {
  /**
   * @param {number} from hertz
   * @param {number} to hertz
   */
  constructor(from, to) {
    this.step = from / to;
    const cutoff = Math.min(1, 0.95 / this.step);
    this.half = Math.ceil(CROSSINGS / cutoff);
    this.table = tableOf(this.half, cutoff);
    this.held = new Float32Array(2 * this.half);
    /** Where the next sample stands, in samples of `held`. */
    this.at = this.half;
  }

  /**
   * @param {Float32Array} samples what follows on what was pushed before, -1 to 1
   * @returns {Float32Array} what is ready; a few milliseconds stay inside
   */
  push(samples) {
    const all = new Float32Array(this.held.length + samples.length);
    all.set(this.held);
    all.set(samples, this.held.length);
    const count = Math.max(0, Math.ceil((all.length - this.half - this.at) / this.step));
    const out = new Float32Array(count);
    for (let i = 0; i < count; i++, this.at += this.step) out[i] = this.value(all, this.at);
    const drop = Math.max(0, Math.floor(this.at) - this.half);
    this.held = all.slice(drop);
    this.at -= drop;
    return out;
  }

  /**
   * @param {Float32Array} all
   * @param {number} at
   */
  value(all, at) {
    const whole = Math.floor(at);
    const taps = this.table[Math.round((at - whole) * PHASES)];
    const first = whole - this.half + 1;
    let sum = 0;
    for (let i = 0; i < taps.length; i++) sum += taps[i] * all[first + i];
    return sum;
  }
}

/**
 * The taps of each phase; they sum up to 1.
 * @param {number} half
 * @param {number} cutoff of the lower rate's half, in halves of the rate that comes in
 */
function tableOf(half, cutoff) {
  return Array.from({ length: PHASES + 1 }, (_, phase) => {
    const taps = Float32Array.from({ length: 2 * half }, (_, i) => tap(i - half + 1 - phase / PHASES, half, cutoff));
    const sum = taps.reduce((a, b) => a + b, 0);
    return taps.map((value) => value / sum);
  });
}

/**
 * @param {number} x samples from the middle
 * @param {number} half
 * @param {number} cutoff
 */
function tap(x, half, cutoff) {
  const sinc = x === 0 ? 1 : Math.sin(Math.PI * cutoff * x) / (Math.PI * cutoff * x);
  const window = Math.abs(x) >= half ? 0 : 0.5 + 0.5 * Math.cos((Math.PI * x) / half);
  return sinc * window;
}
