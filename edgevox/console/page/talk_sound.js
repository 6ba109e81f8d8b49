/** Hold to talk, the open microphone, and whether this browser speaks. */
import { h, sign } from "./dom.js";
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

/**
 * The part that makes and plays sound; it is fetched when somebody first wants it.
 * @param {(state: any) => void} onState
 */
async function openSound(onState) {
  const path = "./sound/sound.js"; // a name that is known only while it runs: the page works without
  const { Sound } = await import(path);
  const sound = new Sound(onState);
  await sound.connect();
  return sound;
}

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function soundButtons(store, link) {
  const why = h("p", { class: "quiet small-text", role: "status" });
  /** @type {Promise<any> | null} */
  let opened = null;
  const tell = (/** @type {string} */ code) => (why.textContent = code && sayOr(`sound_${code}`, say("sound_failed")));
  const onState = (/** @type {any} */ state) => {
    const code = typeof state === "string" ? state : state?.error ?? state?.state ?? "";
    tell(BROKEN.includes(code) ? code : "");
    if (BROKEN.includes(code)) open.setAttribute("aria-pressed", "false"); // it never goes on by itself
  };
  const sound = () => (opened ??= openSound(onState).catch((error) => {
    opened = null;
    tell(error?.name === "NotAllowedError" ? "denied" : error?.name === "NotFoundError" ? "absent" : "failed");
    throw error;
  }));
  const use = (/** @type {(s: any) => any} */ action) => sound().then(action);
  /** To speak takes control of a free robot. */
  const speak = async (/** @type {boolean} */ on, /** @type {(s: any) => any} */ action) => {
    if (on && store.free) await link.send({ type: "lease", action: "take" });
    return use(action);
  };
  const talk = holdToTalk(speak);
  const open = toggle("waves", say("open_microphone"), (on) => speak(on, (s) => s.open(on)));
  const hear = toggle("ear", say("hear_here"), (on) => use((s) => s.hear(on)));
  const box = h("div", { class: "sound" }, h("div", { class: "row tight" }, talk, open, hear), why);
  const show = () => {
    const deaf = whyDeaf();
    const speaks = Boolean(store.capabilities.sound);
    box.hidden = !speaks;
    talk.disabled = open.disabled = Boolean(deaf) || !store.may;
    hear.disabled = store.link !== "ready" || !window.isSecureContext || !window.AudioWorkletNode;
    if (deaf) tell(deaf);
  };
  for (const type of ["hello", "lease", "link"]) store.on(type, show);
  store.on("link", (state) => state !== "ready" && (talk.dispatchEvent(new Event("release"))));
  return box;
}

/** @param {(on: boolean, action: (sound: any) => any) => Promise<any>} speak */
function holdToTalk(speak) {
  const button = h("button", { class: "hold fill", type: "button", "aria-pressed": "false" },
    sign("microphone"), h("span", {}, say("hold_to_talk")));
  let held = false;
  const hold = (/** @type {boolean} */ on) => {
    if (on === held) return;
    held = on;
    button.classList.toggle("on", on);
    button.setAttribute("aria-pressed", String(on));
    speak(on, (sound) => sound.hold(held)).catch(() => (held = false) || button.classList.remove("on"));
  };
  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    button.setPointerCapture(event.pointerId);
    hold(true);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture", "blur", "release"])
    button.addEventListener(end, () => hold(false));
  button.addEventListener("keydown", (event) => PRESSES.includes(event.key) && !event.repeat && hold(true));
  button.addEventListener("keyup", (event) => PRESSES.includes(event.key) && hold(false));
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  window.addEventListener("blur", () => hold(false));
  return button;
}

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
