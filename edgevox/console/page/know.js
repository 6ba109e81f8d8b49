/** How the robot is: health, latencies as small plots, what was refused and why, logs, recordings. */
import { h, section, sparkline } from "./dom.js";
import { whyNot } from "./notices.js";
import { recordingPart } from "./recordings.js";
import { number, say } from "./words.js";

const STAGES = /** @type {const} */ (["stt", "llm", "tts", "ttfs", "total"]);
const LEVELS = ["good", "warn", "bad", "stale"];
const MOST_LINES = 200;

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function knowPanel(store, link) {
  const health = h("div", { class: "stack-small" });
  const latencies = h("div", { class: "latencies" });
  const line = h("p", { class: "quiet small-text" });
  store.on("status", () => {
    health.replaceChildren(...healthRows(store.status));
    latencies.replaceChildren(...latencyRows(store.status.latencies ?? []));
    line.textContent = say("line", { ms: number(link.roundtrip, 0) });
  });
  const recording = recordingPart(store, link);
  return h("section", { class: "card know-card scroll", tabindex: "0", "aria-label": say("know") },
    section(say("health"), health, line), section(say("latencies"), latencies), recording,
    section(say("refusals"), refusalList(store)), section(say("logs"), logList(store)));
}

/** @param {import("./wire.js").Status} status */
function healthRows(status) {
  const problems = status.health?.problems ?? [];
  const rows = problems.map((text) => h("p", { class: "notice bad" }, text));
  for (const one of status.diagnostics ?? []) {
    const kind = LEVELS[one.level] ?? "stale";
    const values = Object.entries(one.values ?? {}).map(([name, value]) => h("div", { class: "row tight" },
      h("span", { class: "quiet fill" }, name), h("span", {}, String(value))));
    rows.push(/** @type {any} */ (details(one.name, h("summary", {}, h("span", { class: `dot ${kind}`, role: "img", "aria-label": say(`level_${kind}`) }),
      h("strong", {}, one.name), h("span", { class: "quiet" }, one.message ?? "")), values)));
  }
  return rows;
}

/** @type {Set<string>} those that somebody opened stay open when they are drawn anew */
const opened = new Set();

/** @param {string} name @param {HTMLElement} summary @param {Node[]} rest */
function details(name, summary, rest) {
  const made = h("details", { class: "diagnostic", open: opened.has(name) }, summary, ...rest);
  made.addEventListener("toggle", () => (made.open ? opened.add(name) : opened.delete(name)));
  return made;
}

/** @param {import("./wire.js").Latency[]} turns */
function latencyRows(turns) {
  if (!turns.length) return [h("p", { class: "empty" }, say("nothing_yet"))];
  return STAGES.map((stage) => {
    const values = turns.map((turn) => turn[stage] ?? 0);
    const last = values[values.length - 1];
    const most = Math.max(...values, 0.001);
    return h("div", { class: "latency" }, h("span", { class: "quiet" }, say(`latency_${stage}`)), sparkline(values, most),
      h("strong", {}, `${number(last, 2)} s`));
  });
}

/** @param {import("./store.js").Store} store */
function refusalList(store) {
  const list = linesBox();
  store.on("event", (event) => {
    if (!["rejected", "failed"].includes(event.status)) return;
    const why = event.why || (event.error ?? event.reason ?? "");
    addLine(list, `${event.skill ?? event.text ?? ""}: ${why}`, "warn");
  });
  store.on("talk", (m) => m.kind === "refused" && addLine(list, m.text ?? "", "warn"));
  store.on("error", (m) => addLine(list, whyNot(m.reason, m.why), "bad"));
  return list;
}

/** @param {import("./store.js").Store} store */
function logList(store) {
  const list = linesBox();
  let turn = 0;
  store.on("log", (m) => {
    if (m.turn > turn) list.replaceChildren(); // the log of this turn, and of what it set going
    turn = Math.max(turn, m.turn ?? 0);
    addLine(list, [m.event, m.text].filter(Boolean).join("  "),
      m.level === "error" ? "bad" : m.level === "warning" ? "warn" : "");
  });
  store.on("hello", () => (turn = 0)); // another start of the robot counts anew
  return list;
}

function linesBox() {
  return h("ol", { class: "lines" }, h("li", { class: "empty" }, say("nothing_yet")));
}

/** @param {HTMLElement} list @param {string} text @param {string} kind */
function addLine(list, text, kind) {
  list.querySelector(".empty")?.remove();
  list.prepend(h("li", { class: kind }, h("time", { class: "quiet" }, new Date().toLocaleTimeString()), " ", text));
  while (list.children.length > MOST_LINES) list.lastChild?.remove();
}
