/** Control of the robot: one operator at a time has it, and can release it or hand it over. */
import { h } from "./dom.js";
import { tellRefusal } from "./notices.js";
import { say } from "./words.js";

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function leaseControl(store, link) {
  const ask = (/** @type {Record<string, any>} */ rest) => link.send({ type: "lease", ...rest }).catch(tellRefusal);
  const box = h("div", { class: "row tight lease" });
  const show = () => {
    const { holder, name, mine, waiting = [] } = store.lease;
    const parts = [];
    if (store.role !== "operator") parts.push(h("span", { class: "chip" }, say("viewer")));
    else if (mine) {
      parts.push(...waiting.slice(0, 1).map((one) => h("button", { class: "small", type: "button", onclick: () =>
        ask({ action: "give", to: one.client }) }, say("give_turn", { name: one.name ?? one.client }))));
      parts.push(h("button", { class: "small on", type: "button", title: say("you_command"), onclick: () =>
        ask({ action: "give" }) }, say("give_back")));
    } else if (holder) {
      parts.push(h("span", { class: "chip" }, say("commands_now", { name: name ?? holder })));
      parts.push(h("button", { class: "small", type: "button", onclick: () =>
        ask({ action: "request" }) }, say("ask_turn")));
    } else parts.push(h("button", { class: "small primary", type: "button", onclick: () =>
      ask({ action: "take" }) }, say("take_turn")));
    box.replaceChildren(...parts);
  };
  for (const type of ["hello", "lease", "link"]) store.on(type, show);
  return box;
}

/**
 * Disables the fields while this page has no control.
 * @param {import("./store.js").Store} store
 * @param {HTMLFieldSetElement} fields
 */
export function onlyWithTurn(store, fields) {
  const show = () => (fields.disabled = !store.commands);
  for (const type of ["hello", "lease", "link"]) store.on(type, show);
  show();
}
