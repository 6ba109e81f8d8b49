/** The line for sound: this browser's microphone to the robot, and what the robot says back. */
import { socketAddress } from "../link.js";
import { Lateness } from "./lateness.js";

const AUDIO = 0;
const HEAD_UP = 8;
const HEAD_DOWN = 9;
const FRAME_BYTES = 640;
/** So much may wait to leave: 0.2 s. What is said when more waits would be heard late. */
const MOST_WAITING = 10 * (HEAD_UP + FRAME_BYTES);
/** Who lets go lets go a little early. */
const LET_GO_MS = 150;
/** The microphone is kept for so long, so that the next word does not wait for it. */
const KEPT_MS = 30_000;
const AGAIN_MS = 1000;
/** What the robot said is not played when it is later than this. */
const OLD_MS = 200;
const CONNECT_MS = 5000;
/** A quiet room is so much softer than the loudest sound. */
const QUIET_DB = 60;

export class Sound {
  /** @param {(state: string) => void} onState what the robot says of it, and what went wrong */
  constructor(onState) {
    this.onState = onState;
    /** Called with a turn when its first sample is played. @type {(turn: number) => void} */
    this.onPlaying = () => {};
    /** Called with how loud the microphone is, 0 to 1, while somebody may speak. @type {(level: number) => void} */
    this.onLevel = () => {};
    this.context = new AudioContext({ latencyHint: "interactive" });
    /** @type {Promise<void> | null} */
    this.worklets = null;
    /** @type {Promise<WebSocket> | null} */
    this.line = null;
    /** @type {Promise<Microphone> | null} */
    this.microphone = null;
    /** @type {AudioWorkletNode | null} */
    this.player = null;
    this.held = this.opened = this.hearing = false;
    /** Whether there was a microphone since it is held. */
    this.heard = false;
    this.sequence = 0;
    this.lateness = new Lateness();
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.letting = undefined;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.keeping = undefined;
  }

  /** Opens the line. Raises where there is none. */
  async connect() {
    await this.context.resume();
    this.worklets ??= addWorklets(this.context);
    await this.worklets;
    await this.socket();
  }

  /**
   * What is said while it is held is meant for the robot.
   * @param {boolean} on
   */
  async hold(on) {
    clearTimeout(this.letting);
    if (!on) {
      if (this.held) this.letting = setTimeout(() => this.letGo(), this.heard ? LET_GO_MS : 0);
      return;
    }
    if (this.held) return;
    this.held = true;
    this.heard = false;
    await this.speak({ type: "talk", held: true }, () => this.held);
    this.heard = true;
  }

  /** Ask the person for the microphone, before anything is said. */
  allow() {
    return this.speak({}, () => false);
  }

  /**
   * An open microphone: whoever wants something says the wake word, if the robot has one.
   * @param {boolean} on
   */
  async open(on) {
    this.opened = on;
    if (on) return this.speak({ type: "open", on }, () => this.opened);
    this.tell({ type: "open", on });
    this.keep();
  }

  /**
   * Whether what the robot says is played here.
   * @param {boolean} on
   */
  async hear(on) {
    this.hearing = on;
    if (on) this.player ??= this.makePlayer();
    else this.player?.port.postMessage(null);
    const socket = await this.socket();
    socket.send(JSON.stringify({ type: "hear", on: this.hearing }));
  }

  letGo() {
    this.held = false;
    this.tell({ type: "talk", held: false });
    this.keep();
  }

  /**
   * Ask the robot to listen, once there is something to listen to.
   * @param {object} asked
   * @param {() => boolean} wanted whether it still is
   */
  async speak(asked, wanted) {
    clearTimeout(this.keeping);
    try {
      this.microphone ??= openMicrophone(this.context, (frame) => this.send(frame));
      const [socket] = await Promise.all([this.socket(), this.microphone]);
      if (wanted()) socket.send(JSON.stringify(asked));
    } catch (error) {
      this.microphone = null;
      this.held = this.opened = false;
      this.onState(reason(error));
      throw error;
    } finally {
      this.keep();
    }
  }

  /** Give the microphone back a while after it was last of use. */
  keep() {
    clearTimeout(this.keeping);
    if (this.held || this.opened) return;
    this.onLevel(0);
    this.keeping = setTimeout(() => {
      this.microphone?.then((one) => one.close(), () => {});
      this.microphone = null;
    }, KEPT_MS);
  }

  /** @param {ArrayBuffer} frame */
  async send(frame) {
    if (!this.held && !this.opened) return;
    this.onLevel(loudness(new Int16Array(frame)));
    const socket = await this.line;
    if (socket?.readyState !== WebSocket.OPEN || socket.bufferedAmount > MOST_WAITING) return;
    const message = new Uint8Array(HEAD_UP + FRAME_BYTES);
    const head = new DataView(message.buffer);
    head.setUint32(0, this.sequence++ >>> 0, true);
    head.setUint32(4, Math.round(performance.now()) >>> 0, true);
    message.set(new Uint8Array(frame), HEAD_UP);
    socket.send(message);
  }

  /** Where there is a line; where there is none there is nothing to end. @param {object} message */
  tell(message) {
    this.line?.then((socket) => socket.readyState === WebSocket.OPEN && socket.send(JSON.stringify(message)), () => {});
  }

  socket() {
    this.line ??= openLine().then(
      (socket) => this.use(socket),
      (error) => {
        this.line = null;
        throw error;
      },
    );
    return this.line;
  }

  /** @param {WebSocket} socket */
  use(socket) {
    this.lateness = new Lateness();
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.onState(JSON.parse(data).state) : this.take(data));
    socket.onclose = () => this.lost();
    return socket;
  }

  /** Nothing that was going on goes on by itself, but for what is heard here. */
  lost() {
    clearTimeout(this.letting);
    this.line = null;
    this.held = this.opened = false;
    this.player?.port.postMessage(null);
    this.keep();
    this.onState("lost");
    if (this.hearing) this.again();
  }

  again() {
    setTimeout(() => this.hearing && this.hear(true).then(() => this.onState("closed"), () => this.again()), AGAIN_MS);
  }

  /** @param {ArrayBuffer} message */
  take(message) {
    const head = new DataView(message);
    if (!this.player || !this.hearing) return;
    if (head.getUint8(0) !== AUDIO) return this.player.port.postMessage(null);
    if (this.lateness.of(performance.now(), head.getUint32(5, true)) > OLD_MS) return;
    const samples = message.slice(HEAD_DOWN);
    this.player.port.postMessage({ turn: head.getUint32(1, true), samples }, [samples]);
  }

  makePlayer() {
    const player = new AudioWorkletNode(this.context, "edgevox-playback", { numberOfInputs: 0, outputChannelCount: [1] });
    player.port.onmessage = ({ data }) => this.onPlaying(data);
    player.connect(this.context.destination);
    return player;
  }
}

/** How loud it is between a quiet room, 0, and as loud as can be, 1; the ear's measure. @param {Int16Array} samples */
function loudness(samples) {
  const square = samples.reduce((sum, one) => sum + (one / 32768) ** 2, 0) / samples.length;
  return Math.min(1, Math.max(0, 1 + (10 * Math.log10(square + 1e-9)) / QUIET_DB));
}

/** @typedef {{close: () => void}} Microphone */

/**
 * @param {AudioContext} context
 * @param {(frame: ArrayBuffer) => void} onFrame
 * @returns {Promise<Microphone>}
 */
async function openMicrophone(context, onFrame) {
  const audio = { channelCount: 1, echoCancellation: true, noiseSuppression: true, autoGainControl: true };
  const stream = await navigator.mediaDevices.getUserMedia({ audio });
  const source = context.createMediaStreamSource(stream);
  const capture = new AudioWorkletNode(context, "edgevox-capture", { numberOfOutputs: 0 });
  capture.port.onmessage = ({ data }) => onFrame(data);
  source.connect(capture);
  return {
    close() {
      source.disconnect();
      for (const track of stream.getTracks()) track.stop();
    },
  };
}

/** @returns {Promise<WebSocket>} */
function openLine() {
  return new Promise((resolve, reject) => {
    const socket = new WebSocket(socketAddress("/ws/sound"));
    socket.binaryType = "arraybuffer";
    const late = setTimeout(() => socket.close(), CONNECT_MS);
    socket.onopen = () => (clearTimeout(late), resolve(socket));
    socket.onclose = () => (clearTimeout(late), reject(new Error("lost")));
  });
}

/** @param {AudioContext} context */
async function addWorklets(context) {
  if (!context.audioWorklet) throw new Error("unsupported");
  for (const name of ["capture_worklet.js", "playback_worklet.js"])
    await context.audioWorklet.addModule(new URL(name, import.meta.url));
}

/** @param {any} error */
function reason(error) {
  if (error?.name === "NotAllowedError") return "denied";
  if (error?.name === "NotFoundError") return "absent";
  return error?.message === "lost" ? "lost" : "failed";
}
