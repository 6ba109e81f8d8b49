/** The robot's speech, played as it comes. Runs where the browser mixes sound. */
import { Resampler } from "./resampler.js";

const RATE = 16000;
/** Seconds that are gathered before the first is played, for a line that is not even. */
const LEAD_S = 0.04;
/**
 * Seconds that may wait: the robot sends 0.1 s before it is due, and what is 0.2 s late is not played.
 */
const MOST_S = 0.3;

class Playback extends AudioWorkletProcessor {
  constructor() {
    super();
    /** @type {Float32Array[]} */
    this.waiting = [];
    /** Samples that wait, and how many of the first piece are played. */
    this.count = this.used = 0;
    this.turn = 0;
    this.since = 0;
    this.playing = false;
    this.resampler = new Resampler(RATE, sampleRate);
    this.port.onmessage = ({ data }) => (data ? this.add(data.turn, new Int16Array(data.samples)) : this.flush());
  }

  flush() {
    this.waiting = [];
    this.count = this.used = 0;
    this.playing = false;
    this.resampler = new Resampler(RATE, sampleRate);
  }

  /**
   * @param {number} turn
   * @param {Int16Array} samples
   */
  add(turn, samples) {
    const ready = this.resampler.push(Float32Array.from(samples, (one) => one / 32768));
    if (!this.count) this.since = currentTime;
    this.turn = turn;
    this.waiting.push(ready);
    this.count += ready.length;
    while (this.count > MOST_S * sampleRate) this.drop();
  }

  /** Forget the oldest piece. */
  drop() {
    const oldest = this.waiting.shift();
    this.count -= (oldest?.length ?? 0) - this.used;
    this.used = 0;
  }

  /**
   * @param {Float32Array[][]} _inputs
   * @param {Float32Array[][]} outputs
   */
  process(_inputs, outputs) {
    const channel = outputs[0]?.[0];
    if (!channel || !this.count) return this.rest();
    if (!this.playing && currentTime - this.since < LEAD_S) return true;
    if (!this.playing) this.port.postMessage(this.turn);
    this.playing = true;
    for (let i = 0; i < channel.length && this.count; i++) channel[i] = this.next();
    return true;
  }

  next() {
    const value = this.waiting[0][this.used++];
    this.count--;
    if (this.used === this.waiting[0].length) {
      this.waiting.shift();
      this.used = 0;
    }
    return value;
  }

  rest() {
    this.playing = false;
    return true;
  }
}

registerProcessor("edgevox-playback", Playback);
