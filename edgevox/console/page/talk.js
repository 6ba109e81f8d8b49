/** The conversation: what was heard, what was decided and how sure, what the robot says. */
import { h, keepFocus, sign } from "./dom.js";
import { otherHolder } from "./lease.js";
import { tellRefusal } from "./notices.js";
import { soundButtons } from "./talk_sound.js";
import { say, sayOr, number } from "./words.js";

const KEPT_TURNS = 60;
const TOLD_OUTCOMES = ["answered", "asked", "refused", "interrupted", "failed", "not_understood"];

/** One exchange as it stands on the page. */
class Turn {
  constructor() {
    this.heard = h("p", { class: "bubble mine", hidden: true });
    this.notes = h("p", { class: "notes", hidden: true });
    this.answer = h("p", { class: "bubble robots", hidden: true });
    this.detail = h("p", { class: "detail", hidden: true });
    this.element = h("div", { class: "turn" }, this.heard, this.notes, this.answer, this.detail);
    this.whole = "";
    /** Whether it was told what its words were understood as. */
    this.decided = false;
  }

  /** @param {HTMLElement} part @param {string} text */
  fill(part, text) {
    part.textContent = text;
    part.hidden = !text;
  }

  /** @param {string} text */
  note(text) {
    if (text) this.fill(this.notes, [this.notes.textContent, text].filter(Boolean).join(" · "));
  }
}

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function talkPanel(store, link) {
  const turns = new Map();
  const log = h("div", { class: "scroll conversation", role: "log", "aria-label": say("conversation"), tabindex: "0" },
    h("p", { class: "empty" }, say("talk_empty")));
  const input = h("input", { type: "text", maxlength: "500", autocomplete: "off", enterkeyhint: "send",
    placeholder: say("type_here"), "aria-label": say("type_here") });
  const form = h("form", { class: "row tight write" }, input,
    h("button", { class: "round primary", type: "submit", "aria-label": say("send") }, sign("send")));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const text = input.value.trim();
    if (!text) return;
    link.send({ type: "text", text }).then(() => (input.value = ""), tellRefusal);
  });
  const turnOf = (/** @type {any} */ message) => {
    const key = message.turn || `alone ${Math.random()}`;
    if (!turns.has(key)) {
      const made = new Turn();
      turns.set(key, made);
      log.querySelector(".empty")?.remove();
      log.append(made.element);
      if (turns.size > KEPT_TURNS) forgetOldest(turns);
    }
    return turns.get(key);
  };
  store.on("talk", (message) => {
    const bottom = log.scrollHeight - log.scrollTop - log.clientHeight < 80;
    tellTurn(turnOf, message);
    if (bottom) log.scrollTop = log.scrollHeight;
  });
  store.on("event", (event) => event.turn && turns.has(event.turn) && noteEvent(turns.get(event.turn), event));
  return h("section", { class: "card talk-card" }, log, soundButtons(store, link), composer(store, link, form));
}

/**
 * The field for words, or who else has control.
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 * @param {HTMLElement} form
 */
function composer(store, link, form) {
  const viewer = h("p", { class: "hint", hidden: true }, say("viewer"));
  const box = h("div", { class: "composer" }, form, otherHolder(store, link), viewer);
  const show = () => keepFocus(box, () => {
    viewer.hidden = store.role === "operator";
    form.hidden = store.role !== "operator" || Boolean(store.lease.holder && !store.lease.mine);
  });
  for (const type of ["hello", "lease", "link"]) store.on(type, show);
  return box;
}

/** @param {Map<any, Turn>} turns */
function forgetOldest(turns) {
  const [key, oldest] = turns.entries().next().value ?? [];
  oldest?.element.remove();
  turns.delete(key);
}

/** @param {(message: any) => Turn} turnOf @param {any} message */
function tellTurn(turnOf, message) {
  const { kind, text } = message;
  if (!["heard", "token", "response", "refused", "decided", "turn_ended"].includes(kind)) return;
  if (kind === "turn_ended" && !TOLD_OUTCOMES.includes(message.outcome)) return;
  const turn = turnOf(message);
  if (kind === "heard") {
    turn.fill(turn.heard, text);
    if (typeof message.confidence === "number") turn.note(say("heard_sure", { percent: percent(message.confidence) }));
  }
  else if (kind === "token") turn.fill(turn.answer, (turn.whole += text));
  else if (kind === "response") {
    turn.fill(turn.answer, text);
    turn.fill(turn.detail, message.detail ?? "");
    turn.element.classList.toggle("cut", Boolean(message.cut));
  } else if (kind === "refused") turn.note(say("refused", { why: text }));
  else if (kind === "turn_ended") tellOutcome(turn, message);
  else {
    turn.decided = true;
    turn.note(decision(message.stage, message.confidence, message.calls.map(called).join(", ")));
  }
}

/** What became of it; that it was answered only where nothing else was decided. @param {Turn} turn @param {any} message */
function tellOutcome(turn, { outcome, stage }) {
  if (outcome !== "answered") turn.note(say(`outcome_${outcome}`));
  else if (!turn.decided) turn.note([say("outcome_answered"), stage && sayOr(`stage_${stage}`, stage)].filter(Boolean).join(" · "));
}

/** @param {{skill: string, arguments?: Record<string, any>}} call */
const called = (call) => `${call.skill}(${Object.values(call.arguments ?? {}).join(", ")})`;

/** @param {number} part */
const percent = (part) => number(100 * part, 0);

/** @param {string} stage @param {number | undefined} sure @param {string} [text] */
function decision(stage, sure, text = "") {
  const parts = [text, sayOr(`stage_${stage}`, stage)];
  if (typeof sure === "number") parts.push(say("sure", { percent: percent(sure) }));
  return parts.filter(Boolean).join(" · ");
}

/** What is done though no words of its turn were understood as it, such as after a yes. @param {Turn} turn @param {any} event */
function noteEvent(turn, event) {
  if (event.kind !== "tool_call" || turn.decided) return;
  turn.decided = true;
  turn.note(decision(event.source, undefined, called(event)));
}

/**
 * What the robot asks, with yes and no: in sight whatever part is shown.
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function questionCard(store, link) {
  const words = h("p", { class: "fill" });
  const answer = (/** @type {boolean} */ yes) => () => link.send({ type: "answer", yes }).catch(tellRefusal);
  const card = h("div", { class: "question", role: "alert", hidden: true }, words, h("div", { class: "row tight" },
    h("button", { class: "primary", type: "button", onclick: answer(true) }, say("yes")),
    h("button", { type: "button", onclick: answer(false) }, say("no"))));
  const show = (/** @type {string} */ text, /** @type {boolean} */ open) => {
    card.hidden = !open;
    words.textContent = open ? text : "";
  };
  store.on("talk", (m) => m.kind === "asked" && show(m.text ?? "", m.open !== false));
  store.on("event", (e) => e.kind === "confirmation" && show(e.question, e.status === "asked"));
  store.on("hello", () => show("", false));
  return card;
}
