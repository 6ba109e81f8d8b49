/** Hold to talk, the open microphone, and whether this browser speaks. */
import { h, sign } from "./dom.js";
import { toast } from "./notices.js";
import { say, sayOr } from "./words.js";

/** States in which nobody is heard, each with a sentence of the page. */
const BROKEN = ["denied", "absent", "busy", "lost", "failed", "unsupported"];

/** The keys that press a button. */
const PRESSES = ["Enter", " "];

/** Why this browser has no microphone for us; empty if it may have one. */
function whyDeaf() {
  if (!window.isSecureContext) return "insecure";
  return navigator.mediaDevices && window.AudioWorkletNode ? "" : "unsupported";
}

/** The part that makes and plays sound; it is fetched when somebody first wants it. Tells `sound` why it does not work. */
export class Speech {
  /** @param {import("./store.js").Store} store @param {import("./link.js").Link} link */
  constructor(store, link) {
    this.store = store;
    this.link = link;
    /** Why there is no sound, in words; empty if there may be. */
    this.why = "";
    /** @type {Promise<any> | null} */
    this.opened = null;
    /** Whether somebody has chosen if the robot is heard here. */
    this.chosen = false;
  }

  /** Why this browser can neither hear nor speak; empty if it may. */
  get deaf() {
    return whyDeaf();
  }

  /** @param {(sound: any) => any} action */
  async use(action) {
    this.opened ??= this.open().catch((error) => {
      this.opened = null;
      this.tell(error?.name === "NotAllowedError" ? "denied" : error?.name === "NotFoundError" ? "absent" : "failed");
      throw error;
    });
    return action(await this.opened);
  }

  async open() {
    const path = "./sound/sound.js"; // a name that is known only while it runs: the page works without
    const { Sound } = await import(path);
    const sound = new Sound((/** @type {any} */ state) => this.tell(typeof state === "string" ? state : state?.error ?? state?.state ?? ""));
    sound.onLevel = (/** @type {number} */ level) => this.store.tell("level", level);
    await sound.connect();
    return sound;
  }

  /** To speak takes control of a free robot. @param {boolean} on @param {(sound: any) => any} action */
  async speak(on, action) {
    if (on && this.store.free) await this.link.send({ type: "lease", action: "take" });
    return this.use(action);
  }

  /** Whether what the robot says is played here. @param {boolean} on */
  async hear(on) {
    this.chosen = true;
    await this.use((sound) => sound.hear(on));
    this.store.tell("hears", on);
  }

  /** Whether the browser will ask the person for the microphone. */
  async asks() {
    const name = /** @type {PermissionName} */ ("microphone"); // which not every browser knows
    return navigator.permissions.query({ name }).then(({ state }) => state === "prompt", () => false);
  }

  /** @param {string} code */
  tell(code) {
    const broken = BROKEN.includes(code) || code === "insecure";
    this.why = broken ? sayOr(`sound_${code}`, say("sound_failed")) : "";
    this.store.tell("sound", broken);
  }
}

/**
 * @param {import("./store.js").Store} store
 * @param {Speech} speech
 */
export function soundButtons(store, speech) {
  const why = h("p", { class: "quiet small-text", role: "status" });
  const open = toggle("waves", say("open_microphone"), (on) => speech.speak(on, (s) => s.open(on)));
  const hear = toggle("ear", say("hear_here"), (on) => speech.hear(on));
  const box = h("div", { class: "sound" }, h("div", { class: "row tight" }, holdToTalk(store, speech), named(open), named(hear)), why);
  store.on("sound", (broken) => {
    why.textContent = speech.why;
    if (broken) open.setAttribute("aria-pressed", "false"); // it never goes on by itself
  });
  store.on("hears", (on) => hear.setAttribute("aria-pressed", String(on)));
  showLevel(store, open);
  const show = () => {
    box.hidden = !store.capabilities.sound;
    open.disabled = Boolean(speech.deaf) || !store.may;
    hear.disabled = store.link !== "ready" || !window.isSecureContext || !window.AudioWorkletNode;
    if (speech.deaf) speech.tell(speech.deaf);
  };
  for (const type of ["hello", "lease", "link"]) store.on(type, show);
  return box;
}

/**
 * How loud the microphone is, for the style sheet to show while the button is on.
 * @param {import("./store.js").Store} store
 * @param {HTMLElement} button
 */
function showLevel(store, button) {
  store.on("level", (level) => button.style.setProperty("--level", level.toFixed(2)));
}

/**
 * The first time it is held the browser asks for the microphone, and what is said meanwhile is lost: the button says so,
 * and that it can be held again. With it this browser begins to play what the robot says, unless somebody has chosen that.
 * @param {import("./store.js").Store} store
 * @param {Speech} speech
 */
export function holdToTalk(store, speech) {
  const words = h("span", {}, say("hold_to_talk"));
  const button = h("button", { class: "hold fill", type: "button", "aria-pressed": "false" },
    sign("microphone"), words, h("span", { class: "level" }));
  showLevel(store, button);
  let held = false;
  const listen = async () => {
    let asked = false;
    let waits = true;
    speech.asks().then((asks) => {
      asked = asks;
      if (asks && waits) words.textContent = say("allow_microphone");
    });
    try {
      await speech.speak(true, (sound) => sound.hold(held));
      if (asked && !held && !(await speech.asks())) toast(say("microphone_ready"), "good");
    } catch {
      held = false;
      button.classList.remove("on");
      if (speech.why && !button.closest(".sound")) toast(speech.why); // where it does not stand already
    }
    waits = false;
    words.textContent = say("hold_to_talk");
  };
  const hold = (/** @type {boolean} */ on) => {
    if (on === held) return;
    held = on;
    button.classList.toggle("on", on);
    button.setAttribute("aria-pressed", String(on));
    if (!on) return void speech.speak(false, (sound) => sound.hold(held)).catch(() => {});
    listen();
    if (!speech.chosen) speech.hear(true).catch(() => {});
  };
  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    button.setPointerCapture(event.pointerId);
    hold(true);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture", "blur"])
    button.addEventListener(end, () => hold(false));
  button.addEventListener("keydown", (event) => PRESSES.includes(event.key) && !event.repeat && hold(true));
  button.addEventListener("keyup", (event) => PRESSES.includes(event.key) && hold(false));
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  window.addEventListener("blur", () => hold(false));
  const show = () => {
    button.hidden = !store.capabilities.sound;
    button.disabled = Boolean(speech.deaf) || !store.may;
    if (store.link !== "ready") hold(false);
  };
  for (const type of ["hello", "lease", "link"]) store.on(type, show);
  return button;
}

/** A round button with its name below it. @param {HTMLButtonElement} button */
const named = (button) => h("div", { class: "named" }, button, h("span", { "aria-hidden": "true" }, button.title));

/**
 * @param {string} name of its sign
 * @param {string} label
 * @param {(on: boolean) => Promise<any>} change
 */
function toggle(name, label, change) {
  const button = h("button", { class: "round", type: "button", "aria-pressed": "false", "aria-label": label, title: label }, sign(name));
  button.addEventListener("click", () => {
    const on = button.getAttribute("aria-pressed") !== "true";
    change(on).then(() => button.setAttribute("aria-pressed", String(on)), () => {});
  });
  return button;
}
