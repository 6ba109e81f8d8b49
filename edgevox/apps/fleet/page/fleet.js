// Shows the state of each robot, once a second; everything is written as text, never as HTML.
// @ts-check

/**
 * @typedef {{name: string, console: string, state: string, problems: Record<string, string>, age_s: number | null,
 *   version: string | null, image: string | null, stopped: boolean | null, battery: number | null,
 *   disk_free_mib: number | null, recording: boolean | null}} Robot
 */

/** What the page says, in the browser's language if there are words in it; they come with the document. */
const given = /** @type {HTMLElement} */ (document.getElementById("words"));
/** @type {Record<string, string>} */
const words = JSON.parse(given.textContent ?? "");
const language = given.lang;
const NEW_CODE = "edgevox-console pair --viewer";
const EVERY_MS = 1000;
const PAIRING = "#pair=";
const rows = /** @type {HTMLElement} */ (document.getElementById("robots"));
const table = /** @type {HTMLElement} */ (document.getElementById("table"));
const summary = /** @type {HTMLElement} */ (document.getElementById("summary"));
const form = /** @type {HTMLFormElement} */ (document.getElementById("pair"));
const code = /** @type {HTMLInputElement} */ (document.getElementById("code"));

/** The words for a key, with their {values}. @param {string} key @param {Record<string, string>} [values] */
const say = (key, values = {}) => words[key].replace(/\{(\w+)\}/g, (_, name) => values[name] ?? "");

/** @param {number} value @param {number} [digits] */
const number = (value, digits = 0) => value.toLocaleString(language, { maximumFractionDigits: digits, minimumFractionDigits: digits });

function tellWords() {
  document.documentElement.lang = language;
  document.documentElement.dir = language === "ar" ? "rtl" : "ltr";
  document.title = say("robots");
  for (const one of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-say]"))) one.textContent = say(one.dataset.say ?? "");
  const [before, after] = words.pair_how.split("{command}");
  const command = document.createElement("code");
  command.dir = "ltr";
  command.textContent = NEW_CODE;
  document.getElementById("how")?.replaceChildren(before, command, after);
}

/** @param {string} text */
function tell(text) {
  if (summary.textContent !== text) summary.textContent = text; // a screen reader repeats text that is written again
}

/** @param {Robot} robot */
function row(robot) {
  const one = document.createElement("tr");
  one.className = robot.state;
  const name = document.createElement("th");
  name.scope = "row";
  name.dir = "auto";
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
    cell("state", say(`state_${robot.state}`), "state"),
    asItIs(cell("problems", problems.join("; "))),
    cell("motion", told(robot.stopped, (stopped) => say(stopped ? "motion_stopped" : "motion_allowed")), robot.stopped ? "stopped" : ""),
    cell("battery", told(robot.battery, (charge) => `${number(100 * charge)} %`)),
    asItIs(cell("disk", told(robot.disk_free_mib, (free) => `${number(free / 1024, 1)} GiB`))),
    cell("recorder", told(robot.recording, (records) => say(records ? "recorder_on" : "recorder_off"))),
    asItIs(cell("version", told(robot.version, (version) => version + image))),
    cell("last_check", told(robot.age_s, (age) => say("ago", { seconds: number(age) }))),
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

/** What has no words in other languages. @param {HTMLElement} one */
function asItIs(one) {
  one.lang = "en";
  one.dir = "auto";
  return one;
}

/** @param {string} key of its label @param {string} text @param {string} [kind] */
function cell(key, text, kind = "") {
  const one = document.createElement("td");
  one.className = kind;
  one.dataset.label = say(key);
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
  const bad = count("warned");
  const parts = [
    say("ready_count", { ready: number(count("ready", "warned")), all: number(robots.length) }),
    ...(bad ? [say("problems_count", { count: number(bad) })] : []),
    ...(stopped ? [say("stopped_count", { count: number(stopped) })] : []),
  ];
  tell(parts.join(" \u00b7 "));
}

/** Why the last code was refused; empty if it was not. */
let refused = "";

/** Let this browser in, if that is the code. @param {string} told */
async function pair(told) {
  const headers = { "Content-Type": "application/json" };
  const answer = await fetch("/api/pair", { method: "POST", headers, body: JSON.stringify({ code: told }) });
  refused = answer.ok ? "" : answer.status === 403 ? say("pair_wrong") : answer.status === 429 ? say("pair_429") : await answer.text();
  look();
}

function ask() {
  table.hidden = true;
  form.hidden = false;
  tell(refused || say("not_paired"));
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
    tell(say("stale"));
  }
  setTimeout(look, EVERY_MS);
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  pair(code.value);
});

tellWords();
if (location.hash.startsWith(PAIRING)) {
  const once = location.hash.slice(PAIRING.length);
  history.replaceState(null, "", location.pathname); // a code is for once
  pair(once);
} else look();
