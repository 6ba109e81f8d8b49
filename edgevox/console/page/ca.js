/** How a device learns to trust this robot: its certificate, and what to do with it on each system. */
import { h } from "./dom.js";
import { loadWords, say } from "./words.js";

const SYSTEMS = { "Android": "ca_android", "iPhone, iPad": "ca_ios", "Windows": "ca_windows", "macOS": "ca_mac", "Linux": "ca_linux" };

async function start() {
  await loadWords();
  document.title = say("ca_title");
  const systems = Object.entries(SYSTEMS).map(([name, key]) =>
    h("section", { class: "part" }, h("h2", {}, name), h("p", {}, say(key))));
  document.getElementById("page")?.replaceChildren(h("main", { class: "pair-page" }, h("div", { class: "card pair stack wide-card" },
    h("h1", {}, say("ca_title")), h("p", { class: "quiet" }, say("ca_why")),
    h("a", { class: "button", href: "/ca.crt", download: "" }, say("ca_download")), h("div", {}, ...systems),
    h("p", {}, h("a", { href: "/" }, say("to_robot"))))));
}

start();
