/** What deletes asks first: one press never does it, nor does a key that is held. */
import { h } from "./dom.js";
import { say } from "./words.js";

/**
 * Ask below a button whether it shall be done; whoever looks away has said no.
 * @param {HTMLElement} button  where the focus goes back to
 * @param {() => string} what  what would be done, in words
 * @param {() => void} act
 * @returns {{element: HTMLElement, ask: () => void}} the question, to be put on the page, and what shows it
 */
export function question(button, what, act) {
  const words = h("p", {});
  const end = () => {
    element.hidden = true;
    button.hidden = false;
  };
  const no = h("button", { class: "small", type: "button", onclick: () => {
    end();
    button.focus();
  } }, say("no"));
  const yes = h("button", { class: "small", type: "button", onclick: () => {
    end();
    act();
  } }, say("yes"));
  const element = h("div", { class: "stack asks", role: "alertdialog", hidden: true }, words, h("div", { class: "row" }, yes, no));
  element.addEventListener("focusout", (event) => {
    if (!(event.relatedTarget instanceof Node && element.contains(event.relatedTarget))) end();
  });
  element.addEventListener("keydown", (event) => event.key === "Escape" && no.click());
  const ask = () => {
    words.textContent = `${what()}? ${say("no_way_back")}`;
    element.setAttribute("aria-label", words.textContent);
    element.hidden = false;
    button.hidden = true;
    no.focus();
  };
  return { element, ask };
}
