/** A small form made of a skill's JSON schema; the limits in it are the policy's. */
import { question } from "./ask.js";
import { h } from "./dom.js";
import { say } from "./words.js";

/** @typedef {import("./wire.js").Schema} Schema */

/**
 * A schema without its detours: references followed, and what may also be null as what it is else.
 * @param {Schema} schema
 * @param {Schema} whole
 * @returns {Schema}
 */
export function plain(schema, whole) {
  if (schema.$ref) {
    const found = whole.$defs?.[schema.$ref.split("/").pop() ?? ""] ?? {};
    return plain({ ...found, ...schema, $ref: undefined }, whole);
  }
  const parts = (schema.anyOf ?? schema.allOf)?.filter((one) => one.type !== "null");
  return parts?.length ? plain({ ...schema, anyOf: undefined, allOf: undefined, ...parts[0] }, whole) : schema;
}

/**
 * @param {import("./wire.js").Skill} skill
 * @param {(call: import("./do.js").Call) => void} run
 */
export function skillForm(skill, run) {
  const label = skill.label || skill.name.replaceAll("_", " ");
  const needed = new Set(skill.schema.required ?? []);
  const fields = Object.entries(skill.schema.properties ?? {}).map(([name, schema]) =>
    field(name, plain(schema, skill.schema), needed.has(name), Boolean(skill.lasting)));
  const allowed = skill.allowed !== false;
  const button = h("button", { class: "small primary", type: "submit", disabled: !allowed, "aria-label": `${say("run")}: ${label}` }, say("run"));
  const form = h("form", { class: "skill", autocomplete: "off" },
    h("div", { class: "row tight" }, h("h2", { class: "fill" }, label), button),
    skill.description ? h("p", { class: "quiet small-text" }, skill.description) : null,
    fields.length ? h("div", { class: "fields" }, ...fields.map((one) => one.element)) : null,
    allowed ? null : h("p", { class: "small-text warn-text" }, skill.why || say("policy_forbids")));
  const filled = () => Object.fromEntries(
    fields.map((one) => [one.name, one.value()]).filter(([, value]) => value !== undefined));
  const { element, ask } = question(button, () => [label, ...Object.values(filled())].join(" "), () =>
    run({ name: skill.name, label, arguments: filled() }));
  form.append(element);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (skill.lasting) ask();
    else run({ name: skill.name, label, arguments: filled() });
  });
  return form;
}

/** @param {string} name @param {Schema} schema @param {boolean} required @param {boolean} lasting */
function field(name, schema, required, lasting) {
  const words = schema.title || name.replaceAll("_", " ");
  const input = inputFor(schema, required, lasting, words);
  const limits = limitsOf(schema);
  const element = h("label", { class: "field" }, h("span", {}, words, limits ? h("small", { class: "quiet" }, ` ${limits}`) : null), input);
  return { name, element, value: () => read(input.value, schema) };
}

/** @param {Schema} schema */
function limitsOf(schema) {
  const low = schema.minimum ?? schema.exclusiveMinimum;
  const high = schema.maximum ?? schema.exclusiveMaximum;
  if (low === undefined && high === undefined) return "";
  return `${low ?? ""} … ${high ?? ""}`;
}

/** Nothing is chosen before somebody chooses, where what is done stays. @param {Schema} schema @param {boolean} required @param {boolean} lasting @param {string} words */
function inputFor(schema, required, lasting, words) {
  const choices = schema.enum ?? (schema.type === "boolean" ? [true, false] : null);
  if (choices) {
    const options = choices.map((one) => h("option", { value: JSON.stringify(one), selected: one === schema.default }, choiceWords(one)));
    return h("select", { required, "aria-label": words }, required && !lasting ? null : h("option", { value: "" }, "–"), ...options);
  }
  const given = schema.default ?? "";
  if (schema.type === "number" || schema.type === "integer")
    return h("input", { type: "number", inputmode: "decimal", step: schema.type === "integer" ? "1" : "any", required,
      min: schema.minimum ?? schema.exclusiveMinimum, max: schema.maximum ?? schema.exclusiveMaximum, value: given });
  return h("input", { type: "text", required, maxlength: schema.maxLength ?? 200, value: given });
}

/** @param {any} value */
function choiceWords(value) {
  if (typeof value === "boolean") return say(value ? "yes" : "no");
  return String(value).replaceAll("_", " ");
}

/** @param {string} text @param {Schema} schema */
function read(text, schema) {
  if (text === "") return undefined;
  if (schema.enum || schema.type === "boolean") return JSON.parse(text);
  if (schema.type === "integer" || schema.type === "number") return Number(text);
  return text;
}
