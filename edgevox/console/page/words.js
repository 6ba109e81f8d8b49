/** What the page says, in the sixteen languages of the robot. */

/** Each language by its own name. */
export const LANGUAGES = {
  ar: "العربية", de: "Deutsch", en: "English", es: "Español", fr: "Français", hi: "हिन्दी",
  id: "Bahasa Indonesia", it: "Italiano", ja: "日本語", nl: "Nederlands", pl: "Polski",
  pt: "Português", ru: "Русский", tr: "Türkçe", vi: "Tiếng Việt", zh: "中文",
};
/** @param {string} one @returns {string} */
export const languageName = (one) => /** @type {Record<string, string>} */ (LANGUAGES)[one] ?? one;
const KEPT = "edgevox-language";

/** @type {Record<string, string>} */
let words = {};
let code = "en";

/** The language of the page, by its code. */
export const language = () => code;

/** A language if it is not the page's, for the attribute `lang`. @param {string} [one] */
export const foreign = (one) => (one && one !== code ? one : null);

function wanted() {
  const kept = localStorage.getItem(KEPT);
  const asked = [kept, ...navigator.languages.map((one) => one.split("-")[0])];
  return asked.find((one) => one && one in LANGUAGES) ?? "en";
}

/** @type {Promise<void> | undefined} */
let loading;

/** The words of the language that this browser wants, once: at once where they came with the document. */
export const loadWords = () => (loading ??= fetchWords());

async function fetchWords() {
  code = wanted();
  const given = document.getElementById("words");
  words = given?.lang === code ? JSON.parse(given.textContent ?? "") : await wordsOf(code);
  document.documentElement.lang = code;
  document.documentElement.dir = code === "ar" ? "rtl" : "ltr";
}

/** The words of a language. @param {string} one @returns {Promise<Record<string, string>>} */
export async function wordsOf(one) {
  const answer = await fetch(new URL(`languages/${one}.json`, import.meta.url));
  if (!answer.ok) throw new TypeError(answer.statusText);
  return answer.json();
}

/** @param {string} chosen */
export function chooseLanguage(chosen) {
  localStorage.setItem(KEPT, chosen);
  location.reload();
}

/**
 * A name or a piece of code as it reads by itself, whatever is written around it.
 * @param {string} text
 */
export const isolated = (text) => (rightToLeft() ? `\u2068${text}\u2069` : text);

/** Whether the page is written from right to left. */
const rightToLeft = () => document.documentElement.dir === "rtl";

/**
 * The words for a key, with their {values}.
 * @param {string} key
 * @param {Record<string, string | number>} [values]
 */
export function say(key, values = {}) {
  return (words[key] ?? key).replace(/\{(\w+)\}/g, (_, name) => isolated(String(values[name] ?? "")));
}

/** The words for a key, or another text where there are none. @param {string} key @param {string} other */
export const sayOr = (key, other) => words[key] ?? other;

/** A number, which is always written from left to right. @param {number} value @param {number} [digits] */
export const number = (value, digits = 1) => {
  const text = value.toLocaleString(code, { maximumFractionDigits: digits, minimumFractionDigits: digits });
  return rightToLeft() ? `\u2066${text}\u2069` : text;
};
