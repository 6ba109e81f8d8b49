// Shows the state of each robot, once a second; everything is written as text, never as HTML.
// @ts-check

/** @typedef {{name: string, console: string, state: string, problems: Record<string, string>, age_s: number | null}} Robot */

/** @type {Record<string, string>} */
const WORDS = { unknown: "not checked yet", ready: "ready", unwell: "not ready", gone: "not responding" };
const EVERY_MS = 1000;
const rows = /** @type {HTMLElement} */ (document.getElementById("robots"));
const summary = /** @type {HTMLElement} */ (document.getElementById("summary"));

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
  const age = robot.age_s === null ? "" : `${Math.round(robot.age_s)} s ago`;
  one.append(name, cell(WORDS[robot.state] ?? robot.state, "state"), cell(problems.join("; ")), cell(age));
  return one;
}

/** @param {string} text @param {string} [kind] */
function cell(text, kind = "") {
  const one = document.createElement("td");
  one.className = kind;
  one.textContent = text;
  return one;
}

/** @param {Robot[]} robots */
function show(robots) {
  const focused = rows.contains(document.activeElement) ? document.activeElement?.textContent : null;
  rows.replaceChildren(...robots.map(row));
  if (focused !== null) [...rows.querySelectorAll("a")].find((one) => one.textContent === focused)?.focus();
  const well = robots.filter((one) => one.state === "ready").length;
  say(`${well} of ${robots.length} robots ready`);
}

async function look() {
  try {
    const answer = await fetch("/robots", { signal: AbortSignal.timeout(EVERY_MS) });
    show((await answer.json()).robots);
    document.body.className = "";
  } catch {
    document.body.className = "stale";
    say("Server not responding. This view is out of date.");
  }
  setTimeout(look, EVERY_MS);
}

look();
