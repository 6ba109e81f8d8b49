/** How the robot is: health, latencies as small plots, what was refused and why, logs, recordings. */
import { h, section, sign, sparkline } from "./dom.js";
import { question, tellRefusal, toast, whyNot } from "./notices.js";
import { foreign, language, number, say, sayOr } from "./words.js";

const STAGES = /** @type {const} */ (["stt", "llm", "tts", "ttfs", "total"]);
const LEVELS = ["good", "warn", "bad", "stale"];
const MOST_LINES = 200;

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function knowPanel(store, link) {
  const health = healthList();
  const latencies = h("div", { class: "latencies" });
  const line = h("p", { class: "quiet small-text" });
  store.on("status", () => {
    health.show(store.status);
    latencies.replaceChildren(...latencyRows(store.status.latencies ?? []));
    line.textContent = say("line", { ms: number(link.roundtrip, 0) });
  });
  const recording = recordingPart(store, link);
  return h("section", { class: "card know-card scroll", tabindex: "0", "aria-label": say("know") },
    section(say("health"), health.element, line), section(say("latencies"), latencies), recording,
    section(say("refusals"), refusalList(store)), section(say("logs"), logList(store)));
}

/** The health of each part. A line that is there is changed in its place: it may have the keyboard. */
function healthList() {
  const problems = h("div", { class: "stack-small" });
  const element = h("div", { class: "stack-small" }, problems);
  /** @type {Map<string, ReturnType<typeof healthRow>>} */
  const rows = new Map();
  const show = (/** @type {import("./wire.js").Status} */ status) => {
    problems.replaceChildren(...(status.health?.problems ?? []).map((text) => h("p", { class: "notice bad", lang: foreign("en"), dir: "auto" }, text)));
    const told = status.diagnostics ?? [];
    for (const [name, row] of rows) if (!told.some((one) => one.name === name)) {
      row.element.remove();
      rows.delete(name);
    }
    for (const one of told) {
      const row = rows.get(one.name) ?? healthRow(one.name);
      if (!rows.has(one.name)) element.append(row.element);
      rows.set(one.name, row);
      row.show(one);
    }
  };
  return { element, show };
}

/** @param {string} name */
function healthRow(name) {
  const dot = h("span", { class: "dot", role: "img" });
  const words = sayOr(`part_${name}`, "");
  const message = h("span", { class: "quiet", dir: "auto" });
  const values = h("div", { lang: foreign("en"), dir: "auto" });
  const element = h("details", { class: "diagnostic" }, h("summary", {}, dot,
    h("strong", { dir: "auto", lang: words ? null : foreign("en") }, words || name), message), values);
  const show = (/** @type {import("./wire.js").Diagnostic} */ one) => {
    const kind = LEVELS[one.level] ?? "stale";
    dot.className = `dot ${kind}`;
    dot.setAttribute("aria-label", say(`level_${kind}`));
    const told = kind === "good" || !one.message; // why it is not well stands there at once, what is well does not
    message.textContent = told ? say(`level_${kind}`) : one.message ?? "";
    message.lang = (!told && foreign("en")) || language();
    values.replaceChildren(...[[name, one.message ?? ""], ...Object.entries(one.values ?? {})].map(([key, value]) =>
      h("div", { class: "row tight" }, h("span", { class: "quiet fill" }, key), h("span", {}, String(value)))));
  };
  return { element, show };
}

/** @param {import("./wire.js").Latency[]} turns */
function latencyRows(turns) {
  if (!turns.length) return [h("p", { class: "empty" }, say("nothing_yet"))];
  return STAGES.map((stage) => {
    const values = turns.map((turn) => turn[stage] ?? 0);
    const last = values[values.length - 1];
    const most = Math.max(...values, 0.001);
    return h("div", { class: "latency" }, h("span", { class: "quiet" }, say(`latency_${stage}`)), sparkline(values, most),
      h("strong", { dir: "auto" }, `${number(last, 2)} s`));
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

// Recordings: started, stopped, downloaded and deleted by an operator; everybody sees that one runs.

/** @param {number} [bytes] */
const megabytes = (bytes = 0) => number(bytes / 1e6, 1);

/**
 * The sign beside the robot's name, whatever else is in sight: what people say now is kept.
 * @param {import("./store.js").Store} store
 */
export function recordingSign(store) {
  const words = say("records_now");
  const made = h("span", { class: "chip low", role: "img", "aria-label": words, title: words, hidden: true }, "\u25cf REC");
  store.on("hello", () => (made.hidden = !store.recording));
  store.on("recording", () => {
    if (made.hidden === !store.recording) return;
    made.hidden = !store.recording;
    toast(say(store.recording ? "records_now" : "record_ended"), "good");
  });
  return made;
}

/** @param {import("./store.js").Store} store @param {import("./link.js").Link} link */
export function recordingPart(store, link) {
  const button = h("button", { type: "button", onclick: () => {
    button.disabled = true; // until the next status: one press is one recording
    link.send({ type: "record", action: store.status.recording?.running ? "stop" : "start" }).catch(tellRefusal);
  } });
  const size = h("p", { class: "quiet small-text" });
  const full = h("p", { class: "notice bad", role: "status", hidden: true }, say("record_full"));
  const failed = h("p", { class: "notice bad", role: "status", hidden: true });
  const files = h("ul", { class: "files" });
  const offered = h("div", { class: "stack" }, h("p", { class: "quiet small-text" }, say("record_note")), button, size, full, failed, files);
  const missing = h("p", { class: "quiet small-text" });
  const part = section(say("recording"), missing, offered);
  let shown = "";
  const show = () => {
    const { record } = store.capabilities;
    part.hidden = !record;
    offered.hidden = record !== true;
    missing.hidden = record === true;
    missing.textContent = typeof record === "string" ? say(`record_needs_${record}`) : "";
    const now = store.status.recording ?? {};
    const { running, seconds = 0, why = "", files: kept = [] } = now;
    button.textContent = running ? say("record_stop", { seconds: number(seconds, 0) }) : say("record_start");
    button.disabled = !store.may || Boolean(now.full && !running);
    const room = say("record_room", { room: number(Math.max(0, now.room ?? 0) / 1e6, 0) });
    size.textContent = running ? `${say("record_size", { size: megabytes(now.bytes) })} ${room}` : room;
    full.hidden = !now.full;
    failed.hidden = !why;
    failed.textContent = why && say("record_failed", { why });
    const listed = JSON.stringify([kept, store.role, store.may]);
    if (listed === shown) return; // what is redrawn loses the focus
    shown = listed;
    files.replaceChildren(...(store.role === "operator" ? kept : []).map((one) => recordingRow(one, store, link)));
  };
  for (const type of ["hello", "status", "lease", "link"]) store.on(type, show);
  return part;
}

/**
 * @param {import("./wire.js").Recorded} one
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
function recordingRow(one, store, link) {
  const begun = one.begun && new Date(1000 * one.begun).toLocaleString(language(), { dateStyle: "medium", timeStyle: "medium" });
  const words = say("record_delete", { name: one.name });
  const button = h("button", { type: "button", "aria-label": words, disabled: !store.may }, sign("close"));
  const { element, ask } = question(button, () => words, () =>
    link.send({ type: "delete_recording", name: one.name }).catch(tellRefusal));
  button.addEventListener("click", ask);
  return h("li", {}, h("div", { class: "row tight" },
    h("a", { class: "fill", href: `/api/recording/${encodeURIComponent(one.name)}`, download: one.name }, one.name), button), element,
    h("p", { class: "quiet" }, [begun, `${megabytes(one.bytes)} MB`].filter(Boolean).join(" \u00b7 ")));
}
