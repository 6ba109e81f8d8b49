/** Elements made of plain calls: no markup is ever read from a string. */

const SVG = "http://www.w3.org/2000/svg";

/**
 * An element. What begins with `on` is a listener, a boolean is an attribute that is there or not.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, any>} [attributes]
 * @param {...(Node | string | null | undefined | false)} children
 * @returns {HTMLElementTagNameMap[T]}
 */
export function h(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value != null) made.setAttribute(name, String(value));
  }
  for (const child of children) if (child !== null && child !== undefined && child !== false) made.append(child);
  return made;
}

/** What takes the keyboard. */
const TAKES_KEYS = "button:not(:disabled), input:not(:disabled), select:not(:disabled), [tabindex]";

/**
 * Change what a box shows. If that hides what has the keyboard, what now stands in its place gets it. A box that is
 * hidden itself leaves that to the box around it.
 * @param {HTMLElement} box
 * @param {() => void} change
 */
export function keepFocus(box, change) {
  const had = document.activeElement;
  const inside = had instanceof HTMLElement && box.contains(had);
  change();
  if (!inside || box.hidden || (had.isConnected && had.getClientRects().length)) return;
  const all = /** @type {HTMLElement[]} */ ([...box.querySelectorAll(TAKES_KEYS)]);
  all.find((one) => one.getClientRects().length)?.focus();
}

const UNREAD_MS = 500;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let settles;

/**
 * Show or hide what moves the controls around it. What is pressed right after that was aimed at what stood there before:
 * until `data-moved` is gone, `guardPresses` lets nothing but Stop take it.
 * @param {HTMLElement} element
 * @param {boolean} hidden
 */
export function showMoving(element, hidden) {
  if (element.hidden === hidden) return;
  element.hidden = hidden;
  document.documentElement.dataset.moved = "";
  clearTimeout(settles);
  settles = setTimeout(() => delete document.documentElement.dataset.moved, UNREAD_MS);
}

/** Nothing takes a press that was aimed at what has just moved away. */
export function guardPresses() {
  let astray = false;
  /** @param {MouseEvent} event */
  const guard = (event) => {
    if (event.type === "pointerdown")
      astray = "moved" in document.documentElement.dataset && !(event.target instanceof Element && event.target.closest(".stop"));
    if (!astray || (event.type === "click" && event.detail === 0)) return; // a key presses what has the focus
    event.preventDefault();
    event.stopPropagation();
  };
  for (const type of /** @type {const} */ (["pointerdown", "click"])) document.addEventListener(type, guard, { capture: true });
}

/**
 * Replace the contents of a box. Keyboard focus stays on the control at the same position.
 * @param {HTMLElement} box
 * @param {...Node} children
 */
export function redraw(box, ...children) {
  const controls = () => /** @type {HTMLElement[]} */ ([...box.querySelectorAll(TAKES_KEYS)]);
  const at = controls().findIndex((one) => one === document.activeElement);
  box.replaceChildren(...children);
  if (at >= 0) controls()[at]?.focus();
}

/** A part of a panel, under its title. @param {string} title @param {...Node} rest */
export function section(title, ...rest) {
  return h("section", { class: "part" }, h("h2", {}, title), ...rest);
}

/**
 * One of the outlined signs of icons/signs.svg; a reader is told nothing of it.
 * @param {string} name
 */
export function sign(name) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("class", "sign");
  svg.setAttribute("aria-hidden", "true");
  const use = document.createElementNS(SVG, "use");
  use.setAttribute("href", `${new URL("icons/signs.svg", import.meta.url)}#${name}`);
  svg.append(use);
  return svg;
}

/**
 * A line through values, for a small plot; `view` is its size without a unit.
 * @param {number[]} values
 * @param {number} most
 */
export function sparkline(values, most) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 100 28");
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("class", "sparkline");
  svg.setAttribute("aria-hidden", "true");
  const line = document.createElementNS(SVG, "polyline");
  const step = 100 / Math.max(1, values.length - 1);
  const at = (/** @type {number} */ v, /** @type {number} */ i) =>
    `${(i * step).toFixed(1)},${(26 - (24 * v) / (most || 1)).toFixed(1)}`;
  line.setAttribute("points", values.map(at).join(" "));
  svg.append(line);
  return svg;
}

/** @param {EventTarget | null} target whether a space would be one of somebody's words: none begins with it */
export function spaceIsWords(target) {
  return target instanceof HTMLInputElement && target.type === "text" && target.value !== "";
}
