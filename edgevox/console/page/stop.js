/** The software stop: a button that is always there, and the space bar. */
import { h, showMoving, sign, spaceIsWords } from "./dom.js";
import { whyNoControl } from "./lease.js";
import { tellRefusal } from "./notices.js";
import { say } from "./words.js";

/** What the space bar presses. */
const PRESSED = "button:not(.stop), a[href], summary, select, input[type=checkbox]";
/** Whether the pointer was used after the keyboard last moved on. */
let pointed = false;

/**
 * Whether the space bar would press what has the keyboard. That counts only where the keyboard has gone by itself:
 * after a click, the space bar must not do again what was clicked.
 * @param {EventTarget | null} target
 */
const spacePresses = (target) => !pointed && target instanceof Element && target.matches(PRESSED);

/** Whether it is the space bar, and presses nothing any more. @param {KeyboardEvent} event */
function takesSpace(event) {
  if (event.key === "Tab") pointed = false;
  if (event.code !== "Space" && event.key !== " ") return false;
  if (event.isComposing || spaceIsWords(event.target) || spacePresses(event.target)) return false;
  event.preventDefault();
  event.stopPropagation();
  return true;
}

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function stopBar(store, link) {
  const { press, element: lost } = insistentStop(store, link);
  const button = h("button", { class: "stop", type: "button", "aria-keyshortcuts": "Space" },
    sign("hand"), h("span", { class: "stop-word" }, say("stop")), h("kbd", {}, say("space_bar")));
  button.addEventListener("pointerdown", (event) => event.button === 0 && press());
  button.addEventListener("click", (event) => event.detail === 0 && press()); // by keyboard, or a reader
  document.addEventListener("pointerdown", () => (pointed = true), { capture: true });
  document.addEventListener("keydown", (event) => takesSpace(event) && !event.repeat && press(), { capture: true });
  document.addEventListener("keyup", takesSpace, { capture: true }); // held down it would press what has the focus
  const said = h("p", { class: "stopped-words" });
  const resume = h("button", { class: "resume", type: "button", onclick: () =>
    link.send({ type: "resume" }).catch(tellRefusal) }, sign("again"), say("resume"));
  const stopped = h("div", { class: "stopped", role: "alert", hidden: true }, said, resume);
  const show = () => {
    const { engaged, by, since } = store.stop;
    showMoving(stopped, !engaged);
    const at = since ? new Date(since * 1000).toLocaleTimeString() : "";
    const text = engaged ? [by ? say("stopped_by", { by }) : say("stopped"), at].filter(Boolean).join(" · ") : "";
    if (said.textContent !== text) said.textContent = text;
    resume.disabled = !store.may;
    resume.title = whyNoControl(store);
    document.documentElement.classList.toggle("is-stopped", engaged);
  };
  for (const type of ["hello", "stop", "lease", "link"]) store.on(type, show);
  return h("div", { class: "stop-area", role: "region", "aria-label": say("software_stop") }, lost, stopped, button);
}

/**
 * A stop that did not arrive says so until it does, or until somebody dismisses that. It is sent again when the robot
 * is back.
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
function insistentStop(store, link) {
  let owed = link.owesStop; // it was pressed, and the robot has not answered
  link.owesStop = false;
  let refused = false;
  let shouts = false;
  const close = h("button", { class: "round plain", type: "button", "aria-label": say("close"), onclick: () => settle() }, sign("close"));
  const element = h("div", { class: "stop-lost", role: "alert", hidden: true }, h("p", {}, say("stop_lost")), close);
  const show = () => {
    shouts = owed && (shouts || refused || store.link !== "ready");
    showMoving(element, !shouts);
  };
  const settle = () => {
    owed = refused = false;
    show();
  };
  const press = () => {
    owed = true;
    show();
    link.send({ type: "stop" }).then(settle, (error) => {
      refused = error.code !== "gone";
      show();
    });
  };
  store.on("link", (state) => {
    show();
    if (owed && state === "ready") press();
  });
  return { press, element };
}
