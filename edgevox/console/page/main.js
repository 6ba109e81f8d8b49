/** Puts the page together. */
import { paired } from "./boot.js";
import { doPanel } from "./do.js";
import { guardPresses, h, sign } from "./dom.js";
import { link, store } from "./early.js";
import { knowPanel, recordingSign } from "./know.js";
import { leaseControl } from "./lease.js";
import { noticeBar, toasts } from "./notices.js";
import { seePanel } from "./see.js";
import { settingsPanel } from "./settings.js";
import { stopBar } from "./stop.js";
import { questionCard, talkPanel } from "./talk.js";
import { Speech } from "./talk_sound.js";
import { loadWords, number, say } from "./words.js";

/** The panels in the order of the tabs; those from `do` on share a place on a desk. */
const PANELS = /** @type {const} */ ([["talk", talkPanel], ["see", seePanel], ["do", doPanel], ["know", knowPanel], ["settings", settingsPanel]]);
const ASIDE = ["do", "know", "settings"];

/** @typedef {import("./store.js").Store} Store */
/** @typedef {import("./link.js").Link} Link */

/** @param {Store} store */
function topBar(store, /** @type {Link} */ link) {
  const name = h("h1", { dir: "auto" }, "EdgeVox");
  const state = h("span", { class: "chip state", role: "status" });
  const battery = h("span", { class: "chip battery", dir: "ltr", hidden: true });
  store.on("hello", () => {
    name.textContent = store.robot || "EdgeVox";
    document.title = `${store.robot || "EdgeVox"}`;
  });
  let does = "listening";
  const tellState = () => {
    const now = store.link !== "ready" ? store.link : store.stop.engaged ? "stopped"
      : does === "listening" && store.moves ? "moving" : does;
    const text = say(`state_${now}`);
    if (state.textContent !== text) state.textContent = text; // a reader says it at each change
  };
  store.on("talk", (m) => {
    if (m.kind !== "state") return;
    does = m.state;
    tellState();
  });
  store.on("hello", () => (does = "listening"));
  for (const type of ["link", "stop", "live"]) store.on(type, tellState);
  store.on("live", () => {
    const level = store.live.battery?.level;
    battery.hidden = level == null;
    if (level == null) return;
    const text = `${number(100 * level, 0)} %`;
    if (battery.textContent === text) return;
    battery.textContent = text;
    battery.setAttribute("aria-label", `${say("battery")} ${text}`);
    battery.setAttribute("role", "img");
    battery.classList.toggle("low", level < 0.2);
  });
  return h("header", { class: "top" }, name, state, h("span", { class: "grow" }), recordingSign(store), battery, leaseControl(store, link));
}

/** @param {(name: string) => void} choose @param {readonly string[]} names @param {string} kind */
function tabBar(choose, names, kind) {
  const buttons = names.map((name) => h("button", { class: "tab", type: "button", "data-panel": name, onclick: () => choose(name) },
    sign(name), h("span", {}, say(name))));
  return h("nav", { class: kind, "aria-label": say(kind === "tabs" ? "parts" : "side_parts") }, ...buttons);
}

/** @param {Store} store @param {Link} link */
function consolePage(store, link) {
  const speech = new Speech(store, link);
  const panels = PANELS.map(([name, make]) => h("div", { class: `panel ${name}`, "data-panel": name }, make(store, link, speech)));
  const choose = (/** @type {string} */ name) => {
    for (const one of document.querySelectorAll("[data-panel]")) {
      const its = one.getAttribute("data-panel");
      const aside = ASIDE.includes(its ?? "") && ASIDE.includes(name);
      one.classList.toggle("chosen", its === name);
      if (aside) one.classList.toggle("aside-chosen", its === name);
      if (one.matches(".tabs .tab") || (aside && one.matches(".side-switch .tab"))) one.setAttribute("aria-current", String(its === name));
    }
    look(link);
  };
  const [before, aside] = [false, true].map((on) => panels.filter((one) => ASIDE.includes(one.dataset.panel ?? "") === on));
  const side = h("div", { class: "side" }, tabBar(choose, ASIDE, "side-switch"), ...aside);
  const page = h("div", { class: "shell" }, topBar(store, link), noticeBar(store), h("main", { class: "panels" }, ...before, side),
    h("div", { class: "bottom" }, questionCard(store, link), stopBar(store, link)), tabBar(choose, PANELS.map(([name]) => name), "tabs"));
  document.getElementById("page")?.replaceChildren(page, toasts);
  guardPresses();
  choose("do");
  choose(matchMedia("(min-width: 700px) and (min-height: 520.02px)").matches ? "do" : "talk");
  store.on("link", () => look(link));
  document.addEventListener("visibilitychange", () => look(link));
}

/** Ask for what is in sight only. @param {Link} link */
function look(link) {
  if (link.store.link !== "ready") return;
  const what = document.hidden ? [] : ["live", "status", "log"];
  link.send({ type: "look", what }).catch(() => {});
}

async function start() {
  await loadWords();
  if (!paired) {
    const path = "./pair.js"; // not among what every page fetches at once
    const { pairPage } = await import(path);
    return document.getElementById("page")?.replaceChildren(pairPage(() => location.reload()));
  }
  if (store.link === "out") return location.reload();
  consolePage(store, link);
  store.on("link", (state) => state === "out" && location.reload());
  link.begin();
}

await start();
