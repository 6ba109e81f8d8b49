/** What is known now, and who wants to hear of a change. */

/** @typedef {import("./wire.js")} _ */
/** @typedef {"waiting" | "ready" | "gone" | "out"} LinkState */

/** Slower than this, in m/s or rad/s, the robot stands. */
const STILL = 0.02;

/** What every part of the page reads. Only `Link` and `main` write it. */
export class Store {
  constructor() {
    /** @type {LinkState} */
    this.link = "waiting";
    this.robot = "";
    this.role = "viewer";
    this.client = "";
    /** @type {import("./wire.js").Capabilities} */
    this.capabilities = {};
    /** @type {import("./wire.js").Skill[]} */
    this.skills = [];
    /** What places, things and other words of the robot are called in the page's language. @type {Record<string, string>} */
    this.words = {};
    /** What arguments are called in the page's language. @type {Record<string, string>} */
    this.arguments = {};
    /** @type {import("./wire.js").Controls} */
    this.controls = {};
    /** @type {import("./wire.js").Lease} */
    this.lease = {};
    /** @type {import("./wire.js").Stop} */
    this.stop = { engaged: false };
    this.recording = false;
    /** @type {import("./wire.js").Scene | null} */
    this.scene = null;
    /** @type {import("./wire.js").Live} */
    this.live = {};
    /** @type {import("./wire.js").Status} */
    this.status = {};
    /** @type {Map<string, Set<(value: any) => void>>} */
    this.listeners = new Map();
  }

  /** Whether this page has control just now. */
  get commands() {
    return this.link === "ready" && this.role === "operator" && Boolean(this.lease.mine);
  }

  /** Whether nobody has control, so that this page's first command takes it. */
  get free() {
    return this.link === "ready" && this.role === "operator" && !this.lease.holder;
  }

  /** Whether a command of this page would be taken just now. */
  get may() {
    return this.commands || this.free;
  }

  /** Whether the robot moves, or a goal is on that moves it. */
  get moves() {
    const { moving, goal, velocity } = this.live;
    return Boolean(moving || goal) || Math.abs(velocity?.linear ?? 0) > STILL || Math.abs(velocity?.angular ?? 0) > STILL;
  }

  /** What a place, a thing or another word of the robot is called. @param {{name?: string, label?: string}} one */
  called({ name = "", label }) {
    return this.words[name] ?? label ?? name.replaceAll("_", " ");
  }

  /** What a call of a skill does, in the page's words. @param {string} name @param {Record<string, any>} [given] */
  doing(name, given = {}) {
    const values = Object.entries(given).map(([argument, value]) => typeof value === "string"
      ? this.called({ name: value }) : `${this.arguments[argument] ?? argument.replaceAll("_", " ")} ${value}`);
    const label = this.skills.find((one) => one.name === name)?.label || name.replaceAll("_", " ");
    return values.length ? `${label}: ${values.join(", ")}` : label;
  }

  /**
   * Call it with every message of a type from now on.
   * @param {string} type
   * @param {(value: any) => void} listener
   */
  on(type, listener) {
    const all = this.listeners.get(type) ?? new Set();
    this.listeners.set(type, all.add(listener));
  }

  /** @param {string} type @param {any} [value] */
  tell(type, value) {
    for (const listener of this.listeners.get(type) ?? []) listener(value);
  }

  /** @param {import("./wire.js").Message} message */
  take(message) {
    const { type, ...rest } = message;
    if (type === "hello") this.welcome(rest);
    else if (type === "scene") this.scene = rest.bounds ? /** @type {any} */ (rest) : null; // an arm has no map
    else if (type === "live") this.live = rest;
    else if (type === "status") this.status = rest;
    else if (type === "lease") this.lease = rest;
    else if (type === "recording") this.recording = Boolean(rest.running);
    else if (type === "stop") this.stop = /** @type {any} */ (rest);
    else if (type === "controls") this.controls = { ...this.controls, ...rest };
    this.tell(type, message);
    if (type === "hello") for (const past of message.talk ?? []) this.take(past);
  }

  /** @param {Record<string, any>} hello */
  welcome(hello) {
    this.robot = hello.robot ?? "";
    this.role = hello.role ?? "viewer";
    this.client = hello.client ?? "";
    this.capabilities = hello.capabilities ?? {};
    this.skills = hello.skills ?? [];
    this.words = hello.words ?? {};
    this.arguments = hello.arguments ?? {};
    this.controls = { languages: hello.languages ?? [], ...hello.controls };
    this.lease = hello.lease ?? {};
    this.stop = hello.stop ?? { engaged: false };
    this.recording = Boolean(hello.recording);
    this.live = {};
  }

  /** @param {LinkState} state */
  linked(state) {
    if (state === this.link) return;
    this.link = state;
    document.documentElement.dataset.link = state;
    this.tell("link", state);
  }
}
