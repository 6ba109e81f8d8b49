/**
 * The line to the robot. It is either there, or nothing is sent: no command waits for a better time.
 */
import { language } from "./words.js";

const PING_MS = 400;
const SILENCE_MS = 800;
const GIVE_UP_MS = 3000;
const AGAIN_MS = [250, 500, 1000, 2000, 4000];

/**
 * What does not take control of a free robot. A stick takes it when it is pressed, and not while it is held: what is
 * held must not take back what was just given away.
 */
const TAKES_NO_CONTROL = ["stop", "look", "lease", "drive"];

/** A command was not sent, or not done; `code` says why where the robot said so, and `why` in the page's language. */
export class Refused extends Error {
  /** @param {string} message @param {string} [code] @param {string} [why] */
  constructor(message, code = "", why = "") {
    super(message);
    this.code = code;
    this.why = why;
  }
}

/** @param {string} path the address of one of the robot's sockets */
export function socketAddress(path) {
  return `${location.protocol === "https:" ? "wss:" : "ws:"}//${location.host}${path}`;
}

export class Link {
  /** @param {import("./store.js").Store} store */
  constructor(store) {
    this.store = store;
    /** @type {WebSocket | null} */
    this.socket = null;
    /** @type {Map<number, {resolve: (v: any) => void, reject: (e: Error) => void}>} */
    this.waiting = new Map();
    this.id = 0;
    this.heard = 0;
    /** A stop was pressed before the page was there; its Stop takes it over. */
    this.owesStop = false;
    /** What came before the page was there; null from then on. @type {string[] | null} */
    this.early = [];
    this.tries = 0;
    /** Milliseconds there and back, of the last ping. */
    this.roundtrip = 0;
    setInterval(() => this.watch(), 150);
    setInterval(() => this.ping(), PING_MS);
    document.addEventListener("visibilitychange", () => this.seen());
  }

  open() {
    const socket = new WebSocket(socketAddress(`/ws?language=${language()}`));
    this.socket = socket;
    this.heard = performance.now();
    socket.onopen = () => this.owesStop && this.write({ type: "stop" });
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = (event) => socket === this.socket && this.lost(event.code);
  }

  /** @param {number} code 4401: this page is no longer let in */
  lost(code) {
    this.socket = null;
    if (this.early) this.early = [];
    for (const { reject } of this.waiting.values()) reject(new Refused("gone", "gone"));
    this.waiting.clear();
    if (code === 4401) return this.store.linked("out");
    this.store.linked("gone");
    const pause = AGAIN_MS[Math.min(this.tries++, AGAIN_MS.length - 1)];
    setTimeout(() => this.reopen(), pause);
  }

  async reopen() {
    if (this.socket || this.store.link === "out") return;
    try {
      const me = await fetch("/api/me", { cache: "no-store" });
      if (me.status === 401) return this.store.linked("out");
    } catch {
      return this.lost(0);
    }
    this.open();
  }

  /** Tell the page what has come so far, and from now on at once. */
  begin() {
    /** @type {string[]} */
    const early = this.early ?? [];
    this.early = null;
    for (const one of early) this.receive(one);
  }

  /** Stop the robot as soon as there is a line, before the page is there. */
  stopSoon() {
    this.owesStop = true;
    if (this.socket?.readyState === WebSocket.OPEN) this.write({ type: "stop" });
  }

  /** @param {string} data */
  receive(data) {
    this.heard = performance.now();
    if (this.early) return void this.early.push(data);
    const message = JSON.parse(data);
    if (message.type === "hello") this.tries = 0;
    if (message.type === "pong") this.roundtrip = performance.now() - message.t;
    if (message.type === "ok") this.answered(message.reply_to)?.resolve(message);
    if (message.type === "error" && message.reply_to != null)
      this.answered(message.reply_to)?.reject(new Refused(message.message ?? "", message.reason, message.why));
    this.store.take(message);
    if (message.type === "hello" || this.store.link === "gone") this.store.linked("ready");
  }

  /** @param {number} id */
  answered(id) {
    const one = this.waiting.get(id);
    this.waiting.delete(id);
    return one;
  }

  /**
   * A hidden page judges no silence: its timers, and so its pings, run once a second or more seldom.
   * What counts is the silence since it is seen again.
   */
  seen() {
    this.heard = performance.now();
    this.ping();
  }

  watch() {
    if (!this.socket || document.hidden) return;
    const silence = performance.now() - this.heard;
    if (silence > SILENCE_MS && this.store.link === "ready") this.store.linked("gone");
    if (silence > GIVE_UP_MS) {
      this.socket.close();
      this.lost(0);
    }
  }

  ping() {
    if (this.socket?.readyState === WebSocket.OPEN) this.write({ type: "ping", t: performance.now() });
  }

  /** @param {Record<string, any>} message */
  write(message) {
    this.socket?.send(JSON.stringify({ id: ++this.id, ...message }));
    return this.id;
  }

  /**
   * Send a command now; the promise ends with the robot's answer. A stop is tried even on a line
   * that is silent, anything else is refused there. The first command takes control of a free robot.
   * @param {Record<string, any>} message
   * @returns {Promise<any>}
   */
  send(message) {
    const open = this.socket?.readyState === WebSocket.OPEN;
    if (!open || (this.store.link !== "ready" && message.type !== "stop"))
      return Promise.reject(new Refused("gone", "gone"));
    if (this.store.free && !TAKES_NO_CONTROL.includes(message.type)) this.write({ type: "lease", action: "take" });
    const id = this.write(message);
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }
}
