/** Control of the robot: one operator at a time has it, and can release it or hand it over. */
import { h, keepFocus } from "./dom.js";
import { tellRefusal } from "./notices.js";
import { say } from "./words.js";

/** @typedef {import("./store.js").Store} Store */
/** @typedef {import("./link.js").Link} Link */

const CHANGES = ["hello", "lease", "link"];

/**
 * Control as the header shows it.
 * @param {Store} store
 * @param {Link} link
 */
export function leaseControl(store, link) {
  const viewer = h("span", { class: "chip" }, say("viewer"));
  const take = h("button", { class: "small primary", type: "button", onclick: () => change(link, "take") }, say("take_turn"));
  const menu = ownMenu(store, link);
  const box = h("div", { class: "row tight lease" }, viewer, take, otherHolder(store, link), menu.element);
  const show = () => keepFocus(box, () => {
    viewer.hidden = store.role === "operator";
    take.hidden = store.role !== "operator" || Boolean(store.lease.holder);
    menu.show();
  });
  for (const type of CHANGES) store.on(type, show);
  return box;
}

/** @param {Link} link @param {string} action @param {string} [to] */
const change = (link, action, to) => link.send({ type: "lease", action, to }).catch(tellRefusal);

/**
 * Who else has control, with a button that asks for it; once that is asked, with one that withdraws it.
 * @param {Store} store
 * @param {Link} link
 */
export function otherHolder(store, link) {
  const words = h("span", { class: "chip" });
  const ask = h("button", { class: "small", type: "button", onclick: () => change(link, "request") }, say("ask_turn"));
  const withdraw = h("button", { class: "small", type: "button", onclick: () => change(link, "withdraw") }, say("withdraw"));
  const box = h("div", { class: "row tight other-holder", role: "status", hidden: true }, words, ask, withdraw);
  const show = () => keepFocus(box, () => {
    const waits = (store.lease.waiting ?? []).some((one) => one.client === store.client);
    box.hidden = store.role !== "operator" || !store.lease.holder || Boolean(store.lease.mine);
    if (box.hidden) return; // what is hidden itself loses the keyboard at once, before another can get it
    words.textContent = say(waits ? "asked_turn" : "commands_now", { name: holderOf(store) });
    ask.hidden = waits;
    withdraw.hidden = !waits;
  });
  for (const type of CHANGES) store.on(type, show);
  return box;
}

/** @param {Store} store */
const holderOf = (store) => store.lease.name || store.lease.holder || "";

/**
 * That this page has control, and behind it what gives it away: no single tap does.
 * @param {Store} store
 * @param {Link} link
 */
function ownMenu(store, link) {
  const menu = h("div", { class: "menu", id: "lease-menu", hidden: true });
  const button = h("button", { class: "small on", type: "button", "aria-controls": "lease-menu" });
  const open = (/** @type {boolean} */ on) => {
    menu.hidden = !on;
    button.setAttribute("aria-expanded", String(on));
  };
  const give = (/** @type {string} */ words, /** @type {string | undefined} */ to = undefined) => h("button", { type: "button", onclick: () => {
    open(false);
    button.focus();
    change(link, "give", to);
  } }, words);
  button.addEventListener("click", () => open(menu.hidden));
  const element = h("div", { class: "own-control" }, button, menu);
  element.addEventListener("focusout", (event) =>
    event.relatedTarget instanceof Node && !element.contains(event.relatedTarget) && open(false));
  element.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || menu.hidden) return;
    open(false);
    button.focus();
  });
  document.addEventListener("pointerdown", ({ target }) =>
    target instanceof Node && !element.contains(target) && open(false));
  let shown = "none yet";
  const show = () => {
    const { mine, waiting = [] } = store.lease;
    element.hidden = store.role !== "operator" || !mine;
    if (element.hidden) open(false);
    const first = waiting[0];
    button.textContent = first ? say("asks_turn", { name: first.name || first.client }) : say("you_command");
    button.classList.toggle("asked", Boolean(first));
    const now = JSON.stringify(waiting);
    if (now === shown) return;
    shown = now;
    if (menu.contains(document.activeElement)) button.focus(); // what stands in its place does something else
    menu.replaceChildren(...waiting.map((one) => give(say("give_turn", { name: one.name || one.client }), one.client)),
      give(say("give_back")));
  };
  open(false);
  return { element, show };
}

/** Why this page may not command now, in words; empty if it may. @param {Store} store */
export function whyNoControl(store) {
  if (store.role !== "operator") return say("viewer");
  return store.lease.holder && !store.lease.mine ? say("commands_now", { name: holderOf(store) }) : "";
}

/**
 * Disables the fields while this page may not command.
 * @param {Store} store
 * @param {HTMLFieldSetElement} fields
 */
export function onlyWithControl(store, fields) {
  const show = () => (fields.disabled = !store.may);
  for (const type of CHANGES) store.on(type, show);
  show();
}
