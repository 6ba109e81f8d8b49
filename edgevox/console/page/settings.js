/** The robot's settings that can change while it runs, and the language of this page. */
import { h, redraw } from "./dom.js";
import { onlyWithControl } from "./lease.js";
import { question, tellRefusal } from "./notices.js";
import { LANGUAGES, chooseLanguage, language, languageName, say, sayOr } from "./words.js";

const CONFIRMS = ["never", "unsure", "always"];

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function settingsPanel(store, link) {
  const fields = h("fieldset", { class: "bare stack" });
  const set = (/** @type {string} */ name, /** @type {any} */ value) =>
    link.send({ type: "set", name, value }).catch((error) => {
      tellRefusal(error);
      show();
    });
  const show = () => {
    const c = store.controls;
    redraw(fields,
      choice(say("robot_language"), c.languages?.length ? c.languages : Object.keys(LANGUAGES), c.language ?? "", languageName, (v) => set("language", v)),
      choice(say("voice"), ["", ...(c.voices ?? [])], c.voice ?? "", (v) => v || say("best_voice"), (v) => set("voice", v)),
      choice(say("confirm"), c.confirms ?? CONFIRMS, c.confirm ?? "", (v) => sayOr(`confirm_${v}`, v), (v) => set("confirm", v)),
      flip(say("muted"), Boolean(c.muted), (on) => set("muted", on)));
  };
  for (const type of ["hello", "controls"]) store.on(type, show);
  onlyWithControl(store, fields);
  const page = choice(say("page_language"), Object.keys(LANGUAGES), language(), languageName, chooseLanguage);
  const leave = h("button", { type: "button" }, say("log_out"));
  const { element: sure, ask } = question(leave, () => say("log_out"), () =>
    fetch("/api/logout", { method: "POST" }).finally(() => location.reload()));
  leave.addEventListener("click", ask);
  return h("section", { class: "card settings-card scroll stack", tabindex: "0", "aria-label": say("settings") },
    h("h2", {}, say("robot")), fields, h("h2", {}, say("this_page")), page,
    certificateLink(), leave, sure);
}

/**
 * @param {string} words
 * @param {string[]} values
 * @param {string} now
 * @param {(value: string) => string} called
 * @param {(value: string) => void} chosen
 */
function choice(words, values, now, called, chosen) {
  const all = values.includes(now) ? values : [now, ...values];
  const select = h("select", { "aria-label": words }, ...all.map((v) => h("option", { value: v, selected: v === now }, called(v))));
  select.addEventListener("change", () => chosen(select.value));
  return h("label", { class: "field wide" }, h("span", {}, words), select);
}

/** @param {string} words @param {boolean} on @param {(on: boolean) => void} change */
function flip(words, on, change) {
  return h("div", { class: "field wide" }, h("span", {}, words), h("button", { class: "switch", type: "button", role: "switch",
    "aria-checked": String(on), "aria-label": words, onclick: () => change(!on) }));
}

export function certificateLink() {
  return h("p", { class: "small-text", hidden: location.protocol !== "https:" }, h("a", { href: "/ca" }, say("certificate")));
}
