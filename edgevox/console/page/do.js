/** What the robot can be asked to do: a form for each skill, and what was asked lately. */
import { h, sign } from "./dom.js";
import { joystick } from "./joystick.js";
import { onlyWithControl, whyNoControl } from "./lease.js";
import { tellRefusal } from "./notices.js";
import { skillForm } from "./skill_form.js";
import { say } from "./words.js";

const RECENT = 6;

/** @typedef {{name: string, label: string, arguments: Record<string, any>}} Call */

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function doPanel(store, link) {
  /** @type {Call[]} */
  let recent = [];
  const recentBox = h("div", { class: "row recent" });
  const list = h("div", { class: "stack" });
  const run = (/** @type {Call} */ call) =>
    link.send({ type: "skill", name: call.name, arguments: call.arguments }).then(() => {
      const same = JSON.stringify(call);
      if (store.skills.find((one) => one.name === call.name)?.lasting) return; // one tap would not ask
      recent = [call, ...recent.filter((one) => JSON.stringify(one) !== same)].slice(0, RECENT);
      showRecent();
    }, tellRefusal);
  const showRecent = () => {
    const had = recentBox.contains(document.activeElement);
    const buttons = recent.map((call) => h("button", { class: "small", type: "button", title: say("again"), onclick: () => run(call) },
      sign("again"), [call.label, ...Object.values(call.arguments)].join(" ")));
    recentBox.replaceChildren(...buttons);
    if (had) buttons[0].focus(); // what was pressed is the first now
  };
  let shown = "";
  store.on("hello", () => {
    const now = JSON.stringify(store.skills);
    if (now === shown) return; // a form that somebody fills in survives a lost line
    shown = now;
    list.replaceChildren(...store.skills.map((skill) => skillForm(skill, run)));
    if (!store.skills.length) list.append(h("p", { class: "empty" }, say("no_skills")));
  });
  const fields = h("fieldset", { class: "bare stack", "aria-label": say("skills") }, recentBox, list);
  onlyWithControl(store, fields);
  const hint = h("p", { class: "hint", hidden: true });
  const tellHint = () => {
    hint.textContent = whyNoControl(store);
    hint.hidden = !hint.textContent || store.link !== "ready";
  };
  for (const type of ["hello", "lease", "link"]) store.on(type, tellHint);
  return h("section", { class: "card do-card scroll stack", tabindex: "0", "aria-label": say("do") },
    hint, joystick(store, link), fields);
}
