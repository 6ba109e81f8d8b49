/** What the robot can be asked to do: a form for each skill, and what was asked lately. */
import { h, sign } from "./dom.js";
import { onlyWithControl, whyNoControl } from "./lease.js";
import { question, tellRefusal } from "./notices.js";
import { foreign, number, say } from "./words.js";

const RECENT = 6;
/** The skill that has a button of its own: no second stop that lasts less stands beside it. */
const STOP = "stop";

/** @typedef {{name: string, arguments: Record<string, any>}} Call */

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
      sign("again"), h("span", { lang: skillLanguage(store, call.name) }, store.doing(call.name, call.arguments))));
    recentBox.replaceChildren(...buttons);
    if (had) buttons[0].focus(); // what was pressed is the first now
  };
  let shown = "";
  store.on("hello", () => {
    const now = JSON.stringify([store.skills, store.words, store.arguments]);
    if (now === shown) return; // a form that somebody fills in survives a lost line
    shown = now;
    const forms = store.skills.filter(({ name }) => name !== STOP).map((skill) => skillForm(store, skill, run));
    list.replaceChildren(...forms);
    if (!forms.length) list.append(h("p", { class: "empty" }, say("no_skills")));
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
    hint, fields);
}

/** The language of a skill's label, where that is not the page's. @param {import("./store.js").Store} store @param {string} name */
export const skillLanguage = (store, name) => foreign(store.skills.find((one) => one.name === name)?.language);

// A joystick for bodies that take velocities: ten times a second while it is held, one zero when it is let go, nothing
// while the robot does not answer.

const BEAT_MS = 100;
/** So near its middle the stick is let go. */
const DEAD = 0.08;
const MOST_UNANSWERED = 3;
const DEFAULT = { linear: 0.3, angular: 1 };
/** What part of the robot's speed the stick has at most: this browser's choice, in these steps. */
const STEP = 0.25;
const KEPT = "edgevox-stick";
const KEYS = { w: [0, 1], s: [0, -1], a: [-1, 0], d: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };

/** Sends what the stick says, and ends with exactly one zero. */
class Driver {
  /** @param {import("./store.js").Store} store @param {import("./link.js").Link} link */
  constructor(store, link) {
    this.store = store;
    this.link = link;
    /** @type {[number, number]} right and ahead, -1 to 1 */
    this.stick = [0, 0];
    this.unanswered = 0;
    /** @type {ReturnType<typeof setInterval> | undefined} */
    this.beat = undefined;
    /** A stop has ended what is held: nothing is sent until it is let go. */
    this.ended = false;
    const kept = Number(localStorage.getItem(KEPT));
    /** What part of the robot's speed a stick at its edge asks for. */
    this.part = kept >= STEP && kept <= 1 ? kept : 1;
  }

  /** The robot's highest speeds. */
  get limits() {
    const told = this.store.capabilities.drive;
    return { ...DEFAULT, ...(typeof told === "object" ? told : {}) };
  }

  /** Whether it may drive now. */
  get may() {
    return this.store.commands && !this.store.stop.engaged;
  }

  /** @param {number} right @param {number} ahead */
  push(right, ahead) {
    if (Math.hypot(right, ahead) < DEAD) return this.release();
    if (this.ended) return;
    this.stick = [right, ahead];
    if (this.beat !== undefined) return;
    this.send();
    this.beat = setInterval(() => this.send(), BEAT_MS);
  }

  release() {
    if (this.beat === undefined && !this.ended) return;
    this.ended = false;
    clearInterval(this.beat);
    this.beat = undefined;
    this.stick = [0, 0];
    this.write(0, 0);
  }

  send() {
    if (!this.may) return this.release();
    if (this.unanswered >= MOST_UNANSWERED) return;
    const { linear, angular } = this.limits;
    const [right, ahead] = this.stick.map((one) => one * this.part);
    const turn = this.stick[1] < -0.1 ? right : -right; // backwards it steers as a car does
    this.write(ahead * linear, turn * angular);
  }

  /** @param {number} linear @param {number} angular */
  write(linear, angular) {
    this.unanswered += 1;
    const done = () => (this.unanswered -= 1);
    const round = (/** @type {number} */ v) => Math.round(v * 1000) / 1000 + 0;
    this.link.send({ type: "drive", linear: round(linear), angular: round(angular) }).then(done, (error) => {
      done();
      if (this.beat !== undefined) {
        tellRefusal(error);
        this.ended = error.code === "let_go";
      }
      clearInterval(this.beat);
      this.beat = undefined;
    });
  }
}

/** @param {import("./store.js").Store} store @param {import("./link.js").Link} link */
export function joystick(store, link) {
  const driver = new Driver(store, link);
  const knob = h("div", { class: "knob" });
  const pad = h("div", { class: "stick", tabindex: "0", role: "application", "aria-label": say("joystick"),
    "aria-describedby": "stick-hint" }, knob);
  const { element: speed, show: showSpeed } = topSpeed(driver);
  const box = h("div", { class: "joystick", hidden: true }, pad,
    h("div", { class: "stick-side" }, speed, h("p", { class: "quiet small-text", id: "stick-hint" }, say("joystick_hint"))));
  const show = (/** @type {number} */ right, /** @type {number} */ ahead) => {
    knob.style.transform = `translate(${right * 42}px, ${-ahead * 42}px)`;
  };
  const push = (/** @type {number} */ right, /** @type {number} */ ahead) => {
    if (store.free && !store.stop.engaged) link.send({ type: "lease", action: "take" }).catch(tellRefusal);
    if (!driver.may) return drop(); // and does not drive once it may
    show(right, ahead);
    driver.push(right, ahead);
  };
  const release = () => {
    show(0, 0);
    driver.release();
  };
  const held = [byPointer(pad, push, release), byKeys(pad, push, release)];
  /** What is held counts no more: it drives again when it is pressed again. */
  const drop = () => {
    for (const forget of held) forget();
    release();
  };
  window.addEventListener("blur", drop);
  window.addEventListener("pagehide", drop);
  document.addEventListener("visibilitychange", () => document.hidden && drop());
  const arrange = () => {
    box.hidden = !store.capabilities.drive;
    box.classList.toggle("disabled", !store.may);
    pad.setAttribute("aria-disabled", String(!store.may));
    showSpeed();
    if (!driver.may) drop();
  };
  for (const type of ["hello", "lease", "link", "stop"]) store.on(type, arrange);
  return box;
}

/** How fast a stick at its edge drives, which this browser remembers. @param {Driver} driver */
function topSpeed(driver) {
  const output = h("output", { dir: "auto" });
  const input = h("input", { type: "range", min: STEP, max: "1", step: STEP, value: driver.part, "aria-label": say("top_speed") });
  const show = () => {
    output.textContent = `${number(driver.part * driver.limits.linear, 2)} m/s`;
    input.setAttribute("aria-valuetext", output.textContent);
  };
  input.addEventListener("input", () => {
    driver.part = Number(input.value);
    localStorage.setItem(KEPT, input.value);
    show();
  });
  return { element: h("label", { class: "speed small-text" }, h("span", { class: "quiet" }, say("top_speed")), output, input), show };
}

/** @typedef {(right: number, ahead: number) => void} Push */

/** @param {HTMLElement} pad @param {Push} push @param {() => void} release @returns {() => void} forgets what is held */
function byPointer(pad, push, release) {
  let held = -1;
  /** Where the pad was when it was pressed: what moves it meanwhile is no steering. */
  let pressed = new DOMRect();
  const at = (/** @type {PointerEvent} */ event) => {
    const { left, top, width, height } = pressed;
    const x = (2 * (event.clientX - left)) / width - 1;
    const y = 1 - (2 * (event.clientY - top)) / height;
    const far = Math.max(1, Math.hypot(x, y));
    push(x / far, y / far);
  };
  pad.addEventListener("pointerdown", (event) => {
    if (held !== -1 || event.button !== 0) return;
    held = event.pointerId;
    pressed = pad.getBoundingClientRect();
    pad.setPointerCapture(held);
    at(event);
  });
  pad.addEventListener("pointermove", (event) => {
    if (event.pointerId !== held) return;
    if (event.buttons & 1) at(event);
    else end(event); // let go under another button that is still down
  });
  const end = (/** @type {PointerEvent} */ event) => {
    if (event.pointerId !== held) return;
    held = -1;
    release();
  };
  for (const type of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"])) pad.addEventListener(type, end);
  pad.addEventListener("contextmenu", (event) => event.preventDefault()); // it would take what lets go
  return () => (held = -1);
}

/** @param {HTMLElement} pad @param {Push} push @param {() => void} release @returns {() => void} forgets what is held */
function byKeys(pad, push, release) {
  /** @type {Map<string, number[]>} by the key's place: with Shift it has another name when it is let go */
  const down = new Map();
  const letGo = () => {
    down.clear();
    release();
  };
  const steer = () => {
    const sum = [...down.values()].reduce((a, b) => [a[0] + b[0], a[1] + b[1]], [0, 0]);
    if (down.size) push(sum[0], sum[1]);
    else release();
  };
  pad.addEventListener("keydown", (event) => {
    if (!(event.key in KEYS)) return letGo(); // a Meta key, for one, keeps it secret that others are let go
    event.preventDefault();
    if (event.repeat) return;
    down.set(event.code, KEYS[/** @type {keyof typeof KEYS} */ (event.key)]);
    steer();
  });
  pad.addEventListener("keyup", (event) => down.delete(event.code) && steer());
  pad.addEventListener("blur", letGo);
  return () => down.clear();
}

// A small form made of a skill's JSON schema; the limits in it are the policy's.

/** @typedef {import("./wire.js").Schema} Schema */

/**
 * A schema without its detours: references followed, and what may also be null as what it is else.
 * @param {Schema} schema
 * @param {Schema} whole
 * @returns {Schema}
 */
function plain(schema, whole) {
  if (schema.$ref) {
    const found = whole.$defs?.[schema.$ref.split("/").pop() ?? ""] ?? {};
    return plain({ ...found, ...schema, $ref: undefined }, whole);
  }
  const parts = (schema.anyOf ?? schema.allOf)?.filter((one) => one.type !== "null");
  return parts?.length ? plain({ ...schema, anyOf: undefined, allOf: undefined, ...parts[0] }, whole) : schema;
}

/**
 * @param {import("./store.js").Store} store
 * @param {import("./wire.js").Skill} skill
 * @param {(call: import("./do.js").Call) => void} run
 */
function skillForm(store, skill, run) {
  const label = skill.label || skill.name.replaceAll("_", " ");
  const needed = new Set(skill.schema.required ?? []);
  const fields = Object.entries(skill.schema.properties ?? {}).map(([name, schema]) =>
    field(store, name, plain(schema, skill.schema), needed.has(name), Boolean(skill.lasting)));
  const allowed = skill.allowed !== false;
  const button = h("button", { class: "small primary", type: "submit", disabled: !allowed, "aria-label": `${say("run")}: ${label}` }, say("run"));
  const form = h("form", { class: "skill", autocomplete: "off" },
    h("div", { class: "row tight" }, h("h2", { class: "fill", lang: foreign(skill.language), dir: "auto" }, label), button),
    skill.description ? h("p", { class: "quiet small-text", lang: foreign(skill.language), dir: "auto" }, skill.description) : null,
    ...fieldBoxes(fields),
    allowed ? null : h("p", { class: "small-text warn-text", dir: "auto" }, skill.why || say("policy_forbids")));
  const filled = () => Object.fromEntries(
    fields.map((one) => [one.name, one.value()]).filter(([, value]) => value !== undefined));
  const { element, ask } = question(button, () => store.doing(skill.name, filled()), () =>
    run({ name: skill.name, arguments: filled() }));
  form.append(element);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (skill.lasting) ask();
    else run({ name: skill.name, arguments: filled() });
  });
  return form;
}

/** The fields; those that may stay empty are folded where others may not. @param {ReturnType<typeof field>[]} fields */
function fieldBoxes(fields) {
  const needed = fields.some((one) => one.required);
  const [first, folded] = [false, true].map((on) => fields.filter((one) => on === (needed && one.spare)).map((one) => one.element));
  return [first.length ? h("div", { class: "fields" }, ...first) : null,
    folded.length ? h("details", { class: "options" }, h("summary", {}, say("options")), h("div", { class: "fields" }, ...folded)) : null];
}

/** @param {import("./store.js").Store} store @param {string} name @param {Schema} schema @param {boolean} required @param {boolean} lasting */
function field(store, name, schema, required, lasting) {
  const own = store.arguments[name];
  const words = own || schema.title || name.replaceAll("_", " ");
  const input = inputFor(store, schema, required, lasting, words);
  const limits = limitsOf(schema);
  const element = h("label", { class: "field" }, h("span", {}, h("span", { lang: own ? null : foreign("en") }, words), limits ? h("small", { class: "quiet" }, ` ${limits}`) : null), input);
  const spare = !required && schema.default == null;
  return { name, element, required, spare, value: () => read(input.value, schema) };
}

/** @param {Schema} schema */
function limitsOf(schema) {
  const low = schema.minimum ?? schema.exclusiveMinimum;
  const high = schema.maximum ?? schema.exclusiveMaximum;
  if (low === undefined && high === undefined) return "";
  return `${low ?? ""} … ${high ?? ""}`;
}

/** Nothing is chosen before somebody chooses, where what is done stays. @param {import("./store.js").Store} store @param {Schema} schema @param {boolean} required @param {boolean} lasting @param {string} words */
function inputFor(store, schema, required, lasting, words) {
  const choices = schema.enum ?? (schema.type === "boolean" ? [true, false] : null);
  if (choices) {
    const options = choices.map((one) => h("option", { value: JSON.stringify(one), selected: one === schema.default }, choiceWords(store, one)));
    return h("select", { required, "aria-label": words }, required && !lasting ? null : h("option", { value: "" }, "–"), ...options);
  }
  const given = schema.default ?? "";
  if (schema.type === "number" || schema.type === "integer")
    return h("input", { type: "number", inputmode: "decimal", step: schema.type === "integer" ? "1" : "any", required,
      min: schema.minimum ?? schema.exclusiveMinimum, max: schema.maximum ?? schema.exclusiveMaximum, value: given });
  return h("input", { type: "text", required, maxlength: schema.maxLength ?? 200, value: given });
}

/** @param {import("./store.js").Store} store @param {any} value */
function choiceWords(store, value) {
  if (typeof value === "boolean") return say(value ? "yes" : "no");
  return store.called({ name: String(value) });
}

/** @param {string} text @param {Schema} schema */
function read(text, schema) {
  if (text === "") return undefined;
  if (schema.enum || schema.type === "boolean") return JSON.parse(text);
  if (schema.type === "integer" || schema.type === "number") return Number(text);
  return text;
}
