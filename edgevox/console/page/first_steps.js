/** What a phone that was just let in needs: robot audio, microphone and control, by one tap. */
import { h, sign } from "./dom.js";
import { whyNoControl } from "./lease.js";
import { whyNot } from "./notices.js";
import { say } from "./words.js";

/** @typedef {{element: HTMLElement, run: () => Promise<void>}} Step */

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 * @param {import("./talk_sound.js").Speech} speech
 */
export function firstSteps(store, link, speech) {
  const whyNoSound = () => speech.deaf && (speech.why || say("sound_failed"));
  const silent = () => !store.capabilities.sound;
  const hear = () => speech.hear(true);
  const allow = () => speech.use((sound) => sound.allow());
  const take = () => link.send({ type: "lease", action: "take" });
  const steps = [
    step(store, say("hear_here"), silent, whyNoSound, hear, () => speech.why),
    step(store, say("allow_microphone"), () => silent() || store.role !== "operator", whyNoSound, allow, () => speech.why),
    step(store, say("take_turn"), () => store.role !== "operator", () => whyNoControl(store), take, (error) => whyNot(error.code, error.why)),
  ];
  const start = h("button", { class: "primary big", type: "button", onclick: async () => {
    start.disabled = true;
    speech.chosen = true;
    const failed = await Promise.allSettled(steps.map((one) => one.run()));
    start.disabled = false;
    if (failed.some((one) => one.status === "rejected")) return start.focus(); // it says why, and is off now
    history.replaceState(null, "", "/");
    element.remove();
  } }, say("start"));
  const element = h("div", { class: "first stack" }, h("h2", {}, say("first_title")), ...steps.map((one) => one.element), start);
  return element;
}

/**
 * A switch, on at first; what it is for is done when the person starts.
 * @param {import("./store.js").Store} store
 * @param {string} words
 * @param {() => boolean} absent
 * @param {() => string} whyOff  why it cannot be had, if so
 * @param {() => Promise<any>} act
 * @param {(error: any) => string} whyFailed
 * @returns {Step}
 */
function step(store, words, absent, whyOff, act, whyFailed) {
  const why = h("p", { class: "small-text warn-text", role: "status" });
  const button = h("button", { class: "switch", type: "button", role: "switch", "aria-checked": "true", "aria-label": words,
    onclick: () => turn(!on()) });
  const on = () => button.getAttribute("aria-checked") === "true";
  const turn = (/** @type {boolean} */ to) => button.setAttribute("aria-checked", String(to));
  const element = h("div", { class: "step" }, h("div", { class: "row tight" }, h("span", { class: "fill" }, words), button), why);
  const show = () => {
    element.hidden = absent();
    const off = whyOff();
    if (off) turn(false);
    else if (button.disabled) turn(true);
    button.disabled = Boolean(off);
    if (off || store.link === "ready") why.textContent = off;
  };
  for (const type of ["hello", "lease", "link"]) store.on(type, show);
  show();
  const run = async () => {
    if (element.hidden || !on()) return;
    try {
      await act();
    } catch (error) {
      turn(false);
      why.textContent = whyFailed(error);
      throw error;
    }
  };
  return { element, run };
}
