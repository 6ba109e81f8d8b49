/** The conversation: what was heard, what was decided and how sure, what the robot says. */
import { h, keepFocus, showMoving, sign } from "./dom.js";
import { otherHolder } from "./lease.js";
import { tellRefusal, whyNot } from "./notices.js";
import { soundButtons } from "./talk_sound.js";
import { isolated, language, languageName, number, say, sayOr, wordsOf } from "./words.js";

const KEPT_TURNS = 60;
const NEAR_END_PX = 80;
const TOLD_OUTCOMES = ["answered", "asked", "refused", "interrupted", "failed", "not_understood"];

/** One exchange as it stands on the page. */
class Turn {
  constructor() {
    this.heard = h("p", { class: "bubble mine", dir: "auto", hidden: true });
    this.notes = h("p", { class: "notes", dir: "auto", hidden: true });
    this.reasons = h("p", { class: "quiet", dir: "auto" });
    this.why = h("details", { class: "why", hidden: true }, h("summary", {}, say("why")), this.reasons);
    this.answer = h("p", { class: "bubble robots", dir: "auto", hidden: true });
    this.detail = h("p", { class: "detail", dir: "auto", hidden: true });
    this.element = h("div", { class: "turn" }, this.heard, this.notes, this.why, this.answer, this.detail);
    this.whole = "";
    /** Whether it was told what its words were understood as. */
    this.decided = false;
    /** @type {Set<string>} */
    this.noted = new Set();
    /** How its words were understood. @type {Set<string>} */
    this.explained = new Set();
  }

  /** @param {HTMLElement} part @param {string} text */
  fill(part, text) {
    part.textContent = text;
    part.hidden = !text;
  }

  /** @param {string} text */
  note(text) {
    if (text) this.noted.add(text);
    this.fill(this.notes, [...this.noted].join(" \u00b7 "));
  }

  /** @param {string} text */
  explain(text) {
    if (text) this.explained.add(text);
    this.reasons.textContent = [...this.explained].join(" \u00b7 ");
    this.why.hidden = !this.explained.size;
  }

  /** Words that were not heard, and why. @param {"waiting" | "undone"} state @param {string} text */
  unheard(state, text) {
    this.element.dataset.unheard = state;
    this.noted.clear();
    this.note(text);
  }

  /** Whether its words may still be heard. */
  get waits() {
    return this.element.dataset.unheard === "waiting";
  }

  /** Its words are heard now. */
  arrived() {
    delete this.element.dataset.unheard;
    this.noted.clear();
    this.note("");
  }
}

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 * @param {import("./talk_sound.js").Speech} speech
 */
export function talkPanel(store, link, speech) {
  /** @type {Map<any, Turn>} */
  const turns = new Map();
  /** What was typed here and is not heard yet, the oldest first. @type {Set<Turn>} */
  const unheard = new Set();
  const log = h("div", { class: "scroll conversation", role: "log", "aria-label": say("conversation"), tabindex: "0" },
    firstHint(store));
  const change = endInSight(log);
  /** Words that wait stay below what was heard. */
  const place = (/** @type {Turn} */ turn) => {
    log.querySelector(".empty")?.remove();
    const waits = [...unheard].find((one) => one !== turn && one.waits);
    log.insertBefore(turn.element, waits?.element ?? null);
  };
  /** What was typed here, if it is heard now; what was dropped before it is not heard any more. */
  const typed = (/** @type {string} */ text) => {
    const same = [...unheard].filter((one) => sameWords(one.heard.textContent, text));
    const found = same.find((one) => one.waits) ?? same[0];
    if (found) for (const one of unheard) {
      if (one === found || !one.waits) unheard.delete(one);
      if (one === found) break;
    }
    found?.arrived();
    return found;
  };
  const turnOf = (/** @type {any} */ message) => {
    const key = message.turn || `alone ${Math.random()}`;
    let turn = turns.get(key);
    if (turn) return turn;
    turn = (message.kind === "heard" && typed(message.text)) || new Turn();
    place(turn);
    turns.set(key, turn);
    if (turns.size > KEPT_TURNS) forgetOldest(turns);
    return turn;
  };
  /** What is typed stands there at once, and what was not done says why. */
  const tell = (/** @type {string} */ text, /** @type {HTMLInputElement} */ input) => {
    const turn = new Turn();
    unheard.add(turn);
    change(() => {
      turn.fill(turn.heard, text);
      turn.unheard("waiting", say("said_waiting"));
      log.querySelector(".empty")?.remove();
      log.append(turn.element);
    }, true);
    input.value = "";
    link.send({ type: "text", text }).catch((error) => change(() => {
      unheard.delete(turn);
      turn.unheard("undone", whyNot(error.code, error.why));
      input.value ||= text;
    }));
  };
  const drop = () => change(() => {
    for (const turn of unheard) turn.unheard("undone", say("said_dropped"));
  });
  store.on("talk", (message) => change(() => tellTurn(store, turnOf, message)));
  store.on("event", (event) => change(() => noteEvent(store, turns.get(event.turn), event)));
  store.on("event", (event) => event.kind === "utterance_left" && change(() =>
    [...turns.values()].at(-1)?.note(say("said_left", { robot: isolated(event.robot) }))));
  store.on("event", (event) => event.kind === "safety_preempt" && drop());
  store.on("stop", ({ engaged }) => engaged && drop());
  store.on("hello", ({ talk = [] }) => {
    if (talk.length) for (const turn of turns.values()) turn.element.remove(); // it tells them all
    turns.clear(); // a robot numbers its turns from 1 after a restart
  });
  const card = h("section", { class: "card talk-card" }, log, soundButtons(store, speech), composer(store, link, words(tell)));
  if (location.hash === "#phone") offerFirstSteps(card, store, link, speech);
  return card;
}

/**
 * What a phone needs first stands in the place of the conversation until it is done.
 * @param {HTMLElement} card
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 * @param {import("./talk_sound.js").Speech} speech
 */
async function offerFirstSteps(card, store, link, speech) {
  const path = "./first_steps.js"; // not among what every page fetches at once
  const { firstSteps } = await import(path);
  card.prepend(firstSteps(store, link, speech));
}

/** What can be said, in the language that the robot understands. @param {import("./store.js").Store} store */
function firstHint(store) {
  const own = h("p", {}, say("talk_empty"));
  const robots = h("p", { dir: "auto", hidden: true });
  const show = async () => {
    const spoken = store.controls.language ?? "";
    const same = !spoken || spoken === language();
    own.textContent = same ? say("talk_empty") : say("robot_speaks", { language: languageName(spoken) });
    robots.hidden = same;
    if (same || robots.lang === spoken) return;
    const words = await wordsOf(spoken).catch(() => null);
    if (!words || spoken !== store.controls.language) return;
    robots.lang = spoken;
    robots.textContent = words.talk_empty;
  };
  for (const type of ["hello", "controls"]) store.on(type, show);
  return h("div", { class: "empty stack-small" }, own, robots);
}

/** @param {(text: string, input: HTMLInputElement) => void} tell */
function words(tell) {
  const input = h("input", { type: "text", maxlength: "500", autocomplete: "off", enterkeyhint: "send",
    placeholder: say("type_here"), "aria-label": say("type_here") });
  const form = h("form", { class: "row tight write" }, input,
    h("button", { class: "round primary", type: "submit", "aria-label": say("send") }, sign("send")));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const text = input.value.trim();
    if (text) tell(text, input);
  });
  return form;
}

/**
 * Keeps the end of a list in sight while somebody looks at it, also when the list gets smaller.
 * @param {HTMLElement} log
 * @returns {(act: () => void, always?: boolean) => void} what changes the list
 */
function endInSight(log) {
  let atEnd = true;
  let height = 0;
  const keep = () => {
    height = log.clientHeight;
    if (atEnd) log.scrollTop = log.scrollHeight;
  };
  log.addEventListener("scroll", () => {
    if (log.clientHeight !== height) return; // it got smaller, which its observer is told after this
    atEnd = log.scrollHeight - log.scrollTop - height < NEAR_END_PX;
  });
  new ResizeObserver(keep).observe(log);
  return (act, always = false) => {
    if (always) atEnd = true;
    act();
    keep();
  };
}

/** Whether the robot heard what was typed; it tells letters in one form. @param {string | null} typed @param {string} heard */
function sameWords(typed, heard) {
  const plain = (/** @type {string} */ text) => text.normalize("NFKC").replace(/[`\u00b4\u2018\u2019\u02bc\u2032]/g, "'").replace(/\s+/g, " ").trim();
  return plain(typed ?? "") === plain(heard);
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

/** @param {import("./store.js").Store} store @param {(message: any) => Turn} turnOf @param {any} message */
function tellTurn(store, turnOf, message) {
  const { kind, text } = message;
  if (!["heard", "token", "response", "refused", "decided", "turn_ended"].includes(kind)) return;
  if (kind === "turn_ended" && !TOLD_OUTCOMES.includes(message.outcome)) return;
  const turn = turnOf(message);
  if (kind === "heard") {
    turn.fill(turn.heard, text);
    if (typeof message.confidence === "number") turn.explain(say("heard_sure", { percent: percent(message.confidence) }));
  }
  else if (kind === "token") turn.fill(turn.answer, (turn.whole += text));
  else if (kind === "response") {
    turn.fill(turn.answer, text);
    turn.fill(turn.detail, message.detail ?? "");
    turn.element.classList.toggle("cut", Boolean(message.cut));
  } else if (kind === "refused") turn.note(say("refused", { why: text }));
  else if (kind === "turn_ended") tellOutcome(turn, message);
  else tellDecision(store, turn, message.calls, message.stage, message.confidence);
}

/** What became of it; that it was answered only where nothing else was decided. @param {Turn} turn @param {any} message */
function tellOutcome(turn, { outcome, stage }) {
  if (outcome !== "answered") turn.note(say(`outcome_${outcome}`));
  else if (!turn.decided) turn.note([say("outcome_answered"), stage && sayOr(`stage_${stage}`, stage)].filter(Boolean).join(" · "));
}

/**
 * What its words were understood as, and behind that how.
 * @param {import("./store.js").Store} store
 * @param {Turn} turn
 * @param {{skill: string, arguments?: Record<string, any>}[]} calls
 * @param {string} stage
 * @param {number} [sure]
 */
function tellDecision(store, turn, calls, stage, sure) {
  turn.decided = true;
  turn.note(calls.map((one) => isolated(store.doing(one.skill, one.arguments))).join(" \u00b7 "));
  for (const one of calls) turn.explain(isolated(`${one.skill}(${Object.values(one.arguments ?? {}).join(", ")})`));
  turn.explain(sayOr(`stage_${stage}`, stage));
  if (typeof sure === "number") turn.explain(say("sure", { percent: percent(sure) }));
}

/** @param {number} part */
const percent = (part) => number(100 * part, 0);

/**
 * What is done though no words of its turn were understood as it, such as after a yes.
 * @param {import("./store.js").Store} store
 * @param {Turn | undefined} turn
 * @param {any} event
 */
function noteEvent(store, turn, event) {
  if (event.kind === "tool_call" && turn && !turn.decided) tellDecision(store, turn, [event], event.source);
}

/**
 * What the robot asks, with yes and no: in sight whatever part is shown.
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function questionCard(store, link) {
  const words = h("p", { class: "fill", dir: "auto" });
  const answer = (/** @type {boolean} */ yes) => () => link.send({ type: "answer", yes }).catch(tellRefusal);
  const card = h("div", { class: "question", role: "alert", hidden: true }, words, h("div", { class: "row tight" },
    h("button", { class: "primary", type: "button", onclick: answer(true) }, say("yes")),
    h("button", { type: "button", onclick: answer(false) }, say("no"))));
  const show = (/** @type {string} */ text, /** @type {boolean} */ open) => {
    showMoving(card, !open);
    words.textContent = open ? text : "";
  };
  const told = (/** @type {string} */ text, /** @type {any} */ m) => (m.goes ? `${text} (${m.expires_s} s)` : text);
  store.on("talk", (m) => m.kind === "asked" && show(told(m.text ?? "", m), m.open !== false));
  store.on("event", (e) => e.kind === "confirmation" && show(told(e.question, e), e.status === "asked"));
  store.on("hello", () => show("", false));
  return card;
}
