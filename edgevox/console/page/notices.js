/** What everybody must see: the stop, a robot that is gone, and short words on what was refused. */
import { h } from "./dom.js";
import { say, sayOr } from "./words.js";

const SHOWN_MS = 6000;

/** @type {HTMLElement} */
export const toasts = h("div", { class: "toasts", role: "status", "aria-live": "polite" });

/** @param {string} text @param {string} [kind] */
export function toast(text, kind = "bad") {
  const one = h("div", { class: `toast ${kind}` }, text);
  toasts.append(one);
  while (toasts.children.length > 3) toasts.firstChild?.remove();
  setTimeout(() => one.remove(), SHOWN_MS);
}

/** Why something was not done, in the page's language. @param {string | undefined} code @param {string | undefined} why what the robot says */
export const whyNot = (code, why) => why ? say("refused", { why }) : sayOr(`why_${code}`, say("why_invalid"));

/** Say why something was not done. @param {any} error */
export function tellRefusal(error) {
  toast(whyNot(error.code, error.why));
}

/** @param {import("./store.js").Store} store */
export function noticeBar(store) {
  const gone = h("div", { class: "notice bad", role: "alert", hidden: true }, say("gone"));
  store.on("link", (state) => (gone.hidden = state !== "gone"));
  return h("div", { class: "notices" }, gone);
}

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
