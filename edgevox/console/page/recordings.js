/** Recordings: begun, ended, taken home and deleted by who commands; that one runs, everybody sees. */
import { h, section, sign } from "./dom.js";
import { question, tellRefusal, toast } from "./notices.js";
import { language, number, say } from "./words.js";

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
    if (listed === shown) return; // what is drawn anew loses the keyboard
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
