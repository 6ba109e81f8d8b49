/** The map: a canvas that is painted when something changed, and what a tap on it offers. */
import { h, sign } from "./dom.js";
import { colours, drawLive, drawScene } from "./map_draw.js";
import { MapGrid } from "./map_grid.js";
import { MapView, moveByHand } from "./map_view.js";
import { tellRefusal, toast, whyNot } from "./notices.js";
import { number, say } from "./words.js";

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function mapCard(store, link) {
  const canvas = h("canvas", { class: "map", tabindex: "0", role: "img" });
  const view = new MapView(canvas);
  let drawn = false;
  let c = colours();
  const paint = () => {
    drawn = false;
    view.resize();
    const g = canvas.getContext("2d");
    if (!g || !view.width) return;
    g.setTransform(view.dense ?? 1, 0, 0, view.dense ?? 1, 0, 0);
    g.clearRect(0, 0, view.width, view.height);
    if (!store.scene) return;
    drawScene(g, view, store.scene, c, grid);
    drawLive(g, view, store.live, store.scene, c);
  };
  const soon = () => {
    if (drawn || document.hidden) return;
    drawn = true;
    requestAnimationFrame(paint);
  };
  const grid = new MapGrid(soon);
  const sheet = tapSheet(store, link, canvas);
  moveByHand(canvas, view, soon, (px, py) => store.scene && sheet.offer(...view.toMap(px, py)));
  new ResizeObserver(soon).observe(canvas);
  document.addEventListener("visibilitychange", soon);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    c = colours();
    soon();
  });
  store.on("live", soon);
  store.on("scene", () => {
    view.bounds = store.scene?.bounds ?? null;
    if (view.whole) view.fit();
    grid.show(store.scene?.grid);
    soon();
  });
  describeForReaders(store, canvas);
  const button = (/** @type {string} */ name, /** @type {string} */ key, /** @type {() => void} */ action) =>
    h("button", { class: "round on-map", type: "button", "aria-label": say(key), title: say(key),
      onclick: () => { action(); soon(); } }, sign(name));
  const robot = () => {
    const pose = store.live.pose;
    if (pose) Object.assign(view, { x: pose.x, y: pose.y, whole: false, scale: Math.max(view.scale, 90) });
  };
  return h("div", { class: "map-card" }, canvas, h("div", { class: "map-tools" },
    button("plus", "zoom_in", () => view.zoom(1.4)), button("minus", "zoom_out", () => view.zoom(0.7)),
    button("all", "whole_map", () => view.fit()), button("here", "to_robot", robot)), sheet.element);
}

/** Says in words where the robot is, every few seconds and only if it changed. @param {import("./store.js").Store} store @param {HTMLElement} canvas */
function describeForReaders(store, canvas) {
  const tell = () => {
    const { pose, goal } = store.live;
    const parts = [say("map")];
    if (pose) parts.push(say("map_robot_at", { x: number(pose.x), y: number(pose.y) }));
    if (goal) parts.push(say("map_goal_left", { distance: number(goal.distance ?? 0) }));
    const text = parts.join(". ");
    if (canvas.getAttribute("aria-label") !== text) canvas.setAttribute("aria-label", text);
  };
  tell();
  setInterval(tell, 3000);
}

/**
 * What can be done with a point of the map.
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 * @param {HTMLElement} canvas
 */
function tapSheet(store, link, canvas) {
  let at = { x: 0, y: 0 };
  const where = h("strong");
  const name = h("input", { type: "text", maxlength: "60", placeholder: say("place_name"), "aria-label": say("place_name") });
  /** The name that was sent and is not answered for yet. */
  let naming = "";
  const hide = () => (element.hidden = true);
  const leave = () => {
    hide();
    canvas.focus();
  };
  /** Hides it once the robot has answered, unless another point was tapped meanwhile. */
  const hideAfter = () => {
    const asked = at;
    return () => asked === at && hide();
  };
  const go = h("button", { class: "primary", type: "button", onclick: () =>
    link.send({ type: "goto", ...at }).then(hideAfter(), tellRefusal) }, say("go_there"));
  const form = h("form", { class: "row tight" }, name, h("button", { type: "submit" }, say("name_place")));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const text = name.value.trim();
    if (!text) return name.focus();
    naming = text;
    link.send({ type: "name_place", name: text, ...at }).catch((error) => {
      naming = "";
      tellRefusal(error);
    });
  });
  store.on("event", (event) => {
    if (!naming || event.skill !== "remember_place" || namedBy(event) !== naming) return;
    if (event.status === "succeeded") {
      toast(say("place_kept", { name: naming }), "good");
      leave();
    } else if (["rejected", "failed"].includes(event.status)) toast(whyNot("", event.why));
    else return;
    naming = "";
  });
  const element = h("div", { class: "tap-sheet", role: "dialog", "aria-label": say("this_point"), hidden: true },
    h("div", { class: "row tight" }, where, h("span", { class: "fill" }), h("button", { class: "round plain", type: "button",
      "aria-label": say("close"), onclick: leave }, sign("close"))),
    h("div", { class: "row" }, go, form));
  element.addEventListener("keydown", (event) => event.key === "Escape" && leave());
  const offer = (/** @type {number} */ x, /** @type {number} */ y) => {
    at = { x: Math.round(x * 100) / 100, y: Math.round(y * 100) / 100 };
    where.textContent = say("point", { x: number(at.x, 2), y: number(at.y, 2) });
    name.value = "";
    for (const one of [go, name]) one.disabled = !store.may;
    go.hidden = store.capabilities.goto === false;
    form.hidden = store.capabilities.name_place === false;
    naming = "";
    element.hidden = go.hidden && form.hidden;
    (store.may && !go.hidden ? go : name).focus();
  };
  return { element, offer };
}

/** The name that this event of the skill is about; a rejected one tells its arguments as they came. @param {any} event */
function namedBy(event) {
  try {
    return (event.arguments ?? JSON.parse(event.arguments_json)).name;
  } catch {
    return undefined;
  }
}
