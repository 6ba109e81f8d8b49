// Shows the state of each robot, once a second; everything is written as text, never as HTML.
// @ts-check

/**
 * @typedef {{name: string, console: string, state: string, problems: Record<string, string>, age_s: number | null,
 *   version: string | null, image: string | null, stopped: boolean | null, battery: number | null,
 *   disk_free_mib: number | null, recording: boolean | null}} Robot
 */

/** @type {Record<string, string>} */
const WORDS = { unknown: "not checked yet", ready: "ready", warned: "ready, with problems", unwell: "not ready", gone: "not responding" };
const EVERY_MS = 1000;
const PAIRING = "#pair=";
const rows = /** @type {HTMLElement} */ (document.getElementById("robots"));
const table = /** @type {HTMLElement} */ (document.getElementById("table"));
const summary = /** @type {HTMLElement} */ (document.getElementById("summary"));
const form = /** @type {HTMLFormElement} */ (document.getElementById("pair"));
const code = /** @type {HTMLInputElement} */ (document.getElementById("code"));

/** @param {string} text */
function say(text) {
  if (summary.textContent !== text) summary.textContent = text; // a screen reader repeats text that is written again
}

/** @param {Robot} robot */
function row(robot) {
  const one = document.createElement("tr");
  one.className = robot.state;
  const name = document.createElement("th");
  name.scope = "row";
  if (robot.console) {
    const link = document.createElement("a");
    link.href = robot.console;
    link.target = "_blank";
    link.rel = "noopener noreferrer";
    link.textContent = robot.name;
    name.append(link);
  } else name.textContent = robot.name;
  const problems = Object.entries(robot.problems).map(([check, said]) => `${check}: ${said}`);
  const image = robot.image && !robot.image.endsWith(robot.version ?? " ") ? ` (${short(robot.image)})` : "";
  one.append(
    name,
    cell("State", WORDS[robot.state] ?? robot.state, "state"),
    cell("Problems", problems.join("; ")),
    cell("Motion", told(robot.stopped, (stopped) => stopped ? "stopped" : "allowed"), robot.stopped ? "stopped" : ""),
    cell("Battery", told(robot.battery, (charge) => `${Math.round(100 * charge)} %`)),
    cell("Disk free", told(robot.disk_free_mib, (free) => `${(free / 1024).toFixed(1)} GiB`)),
    cell("Recorder", told(robot.recording, (records) => records ? "recording" : "off")),
    cell("Version", told(robot.version, (version) => version + image)),
    cell("Last check", told(robot.age_s, (age) => `${Math.round(age)} s ago`)),
  );
  return one;
}

/** What is known in words. @template T @param {T | null} value @param {(value: T) => string} words */
function told(value, words) {
  return value === null ? "" : words(value);
}

/** The beginning of a hash, and other names whole. @param {string} image */
function short(image) {
  return image.startsWith("sha256:") ? image.slice(7, 19) : image;
}

/** @param {string} label @param {string} text @param {string} [kind] */
function cell(label, text, kind = "") {
  const one = document.createElement("td");
  one.className = kind;
  one.dataset.label = label;
  one.textContent = text;
  return one;
}

/** @param {Robot[]} robots */
function show(robots) {
  const focused = rows.contains(document.activeElement) ? document.activeElement?.textContent : null;
  rows.replaceChildren(...robots.map(row));
  if (focused !== null) [...rows.querySelectorAll("a")].find((one) => one.textContent === focused)?.focus();
  const count = (/** @type {string[]} */ ...states) => robots.filter((one) => states.includes(one.state)).length;
  const stopped = robots.filter((one) => one.stopped).length;
  say([
    `${count("ready", "warned")} of ${robots.length} robots ready`,
    ...(count("warned") ? [`${count("warned")} with problems`] : []),
    ...(stopped ? [`${stopped} stopped`] : []),
  ].join(", "));
}

/** Why the last code was refused; empty if it was not. */
let refused = "";

/** Let this browser in, if that is the code. @param {string} told */
async function pair(told) {
  const headers = { "Content-Type": "application/json" };
  const answer = await fetch("/api/pair", { method: "POST", headers, body: JSON.stringify({ code: told }) });
  refused = answer.ok ? "" : answer.status === 403 ? "This is not the code, or it was used before." : await answer.text();
  look();
}

function ask() {
  table.hidden = true;
  form.hidden = false;
  say(refused || "This browser is not paired.");
}

async function look() {
  try {
    const answer = await fetch("/robots", { signal: AbortSignal.timeout(EVERY_MS) });
    if (answer.status === 401) return ask();
    show((await answer.json()).robots);
    form.hidden = true;
    table.hidden = false;
    document.body.className = "";
  } catch {
    document.body.className = "stale";
    say("Server not responding. This view is out of date.");
  }
  setTimeout(look, EVERY_MS);
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  pair(code.value);
});

if (location.hash.startsWith(PAIRING)) {
  const given = location.hash.slice(PAIRING.length);
  history.replaceState(null, "", location.pathname); // a code is for once
  pair(given);
} else look();
