/** The map: a canvas that is painted when something changed, and what a tap on it offers. */
import { h, redraw, sign } from "./dom.js";
import { tellRefusal, toast, whyNot } from "./notices.js";
import { isolated, number, say } from "./words.js";

/** So far above the sheet that tells of it stands a point that was chosen. */
const ABOVE_SHEET_PX = 12;

/**
 * @param {import("./store.js").Store} store
 * @param {import("./link.js").Link} link
 */
export function mapCard(store, link) {
  const canvas = h("canvas", { class: "map", tabindex: "0", role: "application", "aria-describedby": "map-keys" });
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
    drawLive(g, view, store, store.scene, c);
    const chosen = sheet.chosen();
    if (chosen) drawPin(g, ...view.toScreen(chosen.x, chosen.y), c);
    if (view.aims && document.activeElement === canvas) drawCross(g, view, c);
  };
  const soon = () => {
    if (drawn || document.hidden) return;
    drawn = true;
    requestAnimationFrame(paint);
  };
  const grid = new MapGrid(soon);
  const sheet = tapSheet(store, link, canvas, () => {
    const at = sheet.chosen();
    view.lift = at ? Math.max(view.lift, view.lift + view.toScreen(at.x, at.y)[1] + ABOVE_SHEET_PX - sheet.element.offsetTop) : 0;
    soon();
  });
  moveByHand(canvas, view, soon, (px, py) => store.scene && sheet.offer(...view.toMap(px, py)));
  for (const type of ["focus", "blur"]) canvas.addEventListener(type, soon);
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
  const keys = h("p", { class: "unseen", id: "map-keys" }, say("map_keys"));
  return h("div", { class: "map-card" }, canvas, keys, roomButtons(store, sheet.offer), h("div", { class: "map-tools" },
    button("plus", "zoom_in", () => view.zoom(1.4)), button("minus", "zoom_out", () => view.zoom(0.7)),
    button("all", "whole_map", () => view.fit()), button("here", "to_robot", robot)), sheet.element);
}

/**
 * The rooms and places as buttons, for who cannot tap on the map: in sight while the keyboard is there.
 * @param {import("./store.js").Store} store
 * @param {(x: number, y: number) => void} offer
 */
function roomButtons(store, offer) {
  const list = h("nav", { class: "map-rooms", "aria-label": say("rooms") });
  store.on("scene", () => {
    const { rooms = [], places = [] } = store.scene ?? {};
    const spots = [...rooms.map((one) => ({ ...one, at: one.goal })), ...places.map((one) => ({ ...one, at: [one.x, one.y] }))];
    redraw(list, ...spots.filter((one) => one.at).map((one) => h("button", { class: "small", type: "button",
      onclick: () => offer(.../** @type {[number, number]} */ (one.at)) }, store.called(one))));
  });
  return list;
}

/** Says in words where the robot is, every few seconds and only if it changed. @param {import("./store.js").Store} store @param {HTMLElement} canvas */
function describeForReaders(store, canvas) {
  const tell = () => {
    const { pose, goal } = store.live;
    const parts = [say("map")];
    if (pose) parts.push(say("map_robot_at", { x: number(pose.x), y: number(pose.y) }));
    if (goal?.distance) parts.push(say("map_goal_left", { distance: number(goal.distance) }));
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
 * @param {() => void} changed the point that is chosen
 */
function tapSheet(store, link, canvas, changed) {
  let at = { x: 0, y: 0 };
  const where = h("strong", { dir: "auto" });
  const name = h("input", { type: "text", maxlength: "60", placeholder: say("place_name"), "aria-label": say("place_name") });
  /** The name that was sent and is not answered for yet. */
  let naming = "";
  const hide = () => {
    element.hidden = true;
    changed();
  };
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
    h("div", { class: "row" }, where, h("div", { class: "row tight" }, go, h("button", { class: "round plain", type: "button",
      "aria-label": say("close"), onclick: leave }, sign("close")))), form);
  element.addEventListener("keydown", (event) => event.key === "Escape" && leave());
  const offer = (/** @type {number} */ x, /** @type {number} */ y) => {
    at = { x: Math.round(x * 100) / 100, y: Math.round(y * 100) / 100 };
    const room = store.scene?.rooms?.find((one) => one.outline && inside(one.outline, at));
    const point = say("point", { x: number(at.x, 2), y: number(at.y, 2) });
    where.textContent = room ? `${isolated(store.called(room))} \u00b7 ${point}` : point;
    name.value = "";
    for (const one of [go, name]) one.disabled = !store.may;
    go.hidden = store.capabilities.goto === false;
    form.hidden = store.capabilities.name_place === false;
    naming = "";
    element.hidden = go.hidden && form.hidden;
    changed();
    (store.may && !go.hidden ? go : name).focus();
  };
  return { element, offer, chosen: () => (element.hidden ? null : at) };
}

/** Whether a point is inside of an outline. @param {[number, number][]} outline @param {{x: number, y: number}} point */
function inside(outline, { x, y }) {
  let is = false;
  outline.forEach(([x1, y1], i) => {
    const [x0, y0] = outline[(i || outline.length) - 1];
    if ((y0 > y) !== (y1 > y) && x < x0 + ((x1 - x0) * (y - y0)) / (y1 - y0)) is = !is;
  });
  return is;
}

/** The name that this event of the skill is about; a rejected one tells its arguments as they came. @param {any} event */
function namedBy(event) {
  try {
    return (event.arguments ?? JSON.parse(event.arguments_json)).name;
  } catch {
    return undefined;
  }
}

// Where the map stands on its canvas: metres to pixels and back, moved by fingers, mouse and keys.

const FURTHEST = 0.01;
const CLOSEST = 400;

class MapView {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    /** Pixels of a metre. */
    this.scale = 50;
    this.x = 0;
    this.y = 0;
    /** @type {[number, number, number, number] | null} */
    this.bounds = null;
    /** Whether the whole map is kept in sight. */
    this.whole = true;
    /** Whether the keys choose a point, which is the middle. */
    this.aims = false;
    this.width = 0;
    this.height = 0;
    /** So many pixels higher it is shown, so that what covers its lower part hides no point that matters. */
    this.lift = 0;
  }

  /** Fit the canvas to its place; true if it changed. */
  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const dense = Math.min(2, window.devicePixelRatio || 1);
    if (width === this.width && height === this.height && this.canvas.width === Math.round(width * dense)) return false;
    this.width = width;
    this.height = height;
    this.canvas.width = Math.round(width * dense);
    this.canvas.height = Math.round(height * dense);
    this.dense = dense;
    if (this.whole) this.fit();
    return true;
  }

  fit() {
    this.whole = true;
    if (!this.bounds || !this.width) return;
    const [x0, y0, x1, y1] = this.bounds;
    const fits = Math.min((this.width - 24) / (x1 - x0), (this.height - 24) / (y1 - y0));
    this.scale = Math.min(CLOSEST, Math.max(FURTHEST, fits));
    this.x = (x0 + x1) / 2;
    this.y = (y0 + y1) / 2;
  }

  /** @param {number} x @param {number} y @returns {[number, number]} metres to pixels of the page */
  toScreen(x, y) {
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - this.lift - (y - this.y) * this.scale];
  }

  /** @param {number} px @param {number} py @returns {[number, number]} */
  toMap(px, py) {
    return [this.x + (px - this.width / 2) / this.scale, this.y - (py + this.lift - this.height / 2) / this.scale];
  }

  /** @param {number} dx @param {number} dy pixels */
  pan(dx, dy) {
    this.whole = false;
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
  }

  /** @param {number} factor @param {number} px @param {number} py what stays where it is */
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.toMap(px, py);
    this.whole = false;
    this.scale = Math.min(CLOSEST, Math.max(FURTHEST, this.scale * factor));
    const [nx, ny] = this.toMap(px, py);
    this.x += x - nx;
    this.y += y - ny;
  }
}

/**
 * Two fingers or a wheel zoom, one finger moves, a tap is a tap.
 * @param {HTMLCanvasElement} canvas
 * @param {MapView} view
 * @param {() => void} changed
 * @param {(x: number, y: number) => void} tapped pixels of the canvas
 */
function moveByHand(canvas, view, changed, tapped) {
  /** @type {Map<number, {x: number, y: number}>} */
  const fingers = new Map();
  let moved = 0;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    view.aims = false;
    if (!fingers.size) moved = 0;
    fingers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    if (fingers.size > 1) moved = 99;
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = fingers.get(event.pointerId);
    if (!last) return;
    const [dx, dy] = [event.offsetX - last.x, event.offsetY - last.y];
    moved += Math.hypot(dx, dy);
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const before = Math.hypot(last.x - other.x, last.y - other.y);
      const after = Math.hypot(event.offsetX - other.x, event.offsetY - other.y);
      view.zoom(after / Math.max(1, before), other.x, other.y);
    } else if (moved > 6) view.pan(dx, dy);
    fingers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    changed();
  });
  canvas.addEventListener("pointerup", (event) => {
    if (fingers.delete(event.pointerId) && !fingers.size && moved <= 6) tapped(event.offsetX, event.offsetY);
  });
  canvas.addEventListener("pointercancel", (event) => fingers.delete(event.pointerId));
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    view.zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY);
    changed();
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    /** @type {Record<string, () => void>} */
    const keys = {
      ArrowLeft: () => view.pan(40, 0), ArrowRight: () => view.pan(-40, 0),
      ArrowUp: () => view.pan(0, 40), ArrowDown: () => view.pan(0, -40),
      "+": () => view.zoom(1.25), "=": () => view.zoom(1.25), "-": () => view.zoom(0.8), 0: () => view.fit(),
      Enter: () => tapped(view.width / 2, view.height / 2),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    view.aims = true;
    keys[event.key]();
    changed();
  });
}

// A map of cells, such as a robot makes for itself: a grey picture, shown in the colours of the page.

/** @typedef {import("./wire.js").Grid} Grid */

class MapGrid {
  /** @param {() => void} changed it is to be painted anew */
  constructor(changed) {
    this.changed = changed;
    /** @type {Grid | undefined} */
    this.wanted = undefined;
    /** What is shown: the one before it, until the wanted one is decoded. @type {{at: Grid, image: HTMLImageElement} | null} */
    this.shown = null;
    /** The same in colours. @type {{image: HTMLImageElement, c: Record<string, string>, canvas: HTMLCanvasElement} | null} */
    this.coloured = null;
  }

  /** @param {Grid | undefined} grid */
  show(grid) {
    this.wanted = grid;
    if (!grid) this.shown = null;
    if (!grid) return;
    const image = new Image();
    image.onload = () => {
      if (this.wanted !== grid) return;
      this.shown = { at: grid, image };
      this.changed();
    };
    image.src = `data:image/png;base64,${grid.png}`;
  }

  /** @param {CanvasRenderingContext2D} g @param {MapView} view @param {Record<string, string>} c */
  draw(g, view, c) {
    if (!this.shown) return;
    const { at, image } = this.shown;
    if (this.coloured?.image !== image || this.coloured.c !== c) this.coloured = { image, c, canvas: colour(image, c) };
    const cell = at.resolution * view.scale;
    g.save();
    g.translate(...view.toScreen(at.x, at.y));
    g.rotate(-at.yaw);
    g.imageSmoothingEnabled = cell < 1;
    g.drawImage(this.coloured.canvas, 0, -image.naturalHeight * cell, image.naturalWidth * cell, image.naturalHeight * cell);
    g.restore();
  }
}

/** Black is unknown and left out, grey is free, white a wall. @param {HTMLImageElement} image @param {Record<string, string>} c */
function colour(image, c) {
  const canvas = h("canvas", { width: image.naturalWidth, height: image.naturalHeight });
  const g = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const pixels = (/** @type {number} */ wide, /** @type {number} */ high) => g.getImageData(0, 0, wide, high);
  const [free, wall] = [c.room, c.wall].map((name) => {
    g.fillStyle = name;
    g.fillRect(0, 0, 1, 1);
    return new Uint32Array(pixels(1, 1).data.buffer)[0];
  });
  g.drawImage(image, 0, 0);
  const all = pixels(canvas.width, canvas.height);
  const cells = new Uint32Array(all.data.buffer);
  cells.forEach((cell, i) => {
    const grey = (cell >>> 8) & 255;
    cells[i] = grey > 191 ? wall : grey > 63 ? free : 0;
  });
  g.putImageData(all, 0, 0);
  return canvas;
}

// The map as it is painted: what stands still once, what moves with every picture.

/** @typedef {import("./wire.js").Shape} Shape */

const NAMES = ["floor", "room", "wall", "furniture", "furniture-line", "lidar", "path", "text", "quiet",
  "accent", "on-accent", "card", "line"];

/** The colours of the style sheet, for a canvas. @returns {Record<string, string>} */
function colours() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** @param {CanvasRenderingContext2D} g @param {MapView} view @param {Shape} shape */
function trace(g, view, { points, circle }) {
  g.beginPath();
  if (circle) {
    const [x, y] = view.toScreen(circle[0], circle[1]);
    g.arc(x, y, circle[2] * view.scale, 0, 2 * Math.PI);
  } else for (const [x, y] of points ?? []) g.lineTo(...view.toScreen(x, y));
  g.closePath();
}

/** @param {CanvasRenderingContext2D} g @param {MapView} view @param {Shape[] | undefined} shapes */
function fillAll(g, view, shapes, fill = "", line = "") {
  for (const shape of shapes ?? []) {
    trace(g, view, shape);
    if (fill) { g.fillStyle = fill; g.fill(); }
    if (line) { g.strokeStyle = line; g.lineWidth = 1; g.stroke(); }
  }
}

/** @param {CanvasRenderingContext2D} g @param {string} text @param {number} x @param {number} y @param {string} colour @param {string} halo */
function label(g, text, x, y, colour, halo) {
  g.lineWidth = 3;
  g.strokeStyle = halo;
  g.strokeText(text, x, y);
  g.fillStyle = colour;
  g.fillText(text, x, y);
}

/**
 * @param {CanvasRenderingContext2D} g
 * @param {MapView} view
 * @param {import("./wire.js").Scene} scene
 * @param {Record<string, string>} c
 * @param {MapGrid} grid
 */
function drawScene(g, view, scene, c, grid) {
  const [x0, y0, x1, y1] = scene.bounds;
  fillAll(g, view, [{ points: [[x0, y0], [x1, y0], [x1, y1], [x0, y1]] }], c.floor);
  grid.draw(g, view, c);
  fillAll(g, view, scene.rooms?.map((room) => ({ points: room.outline })), c.room, c.line);
  fillAll(g, view, scene.furniture, c.furniture, c["furniture-line"]);
  fillAll(g, view, scene.walls, c.wall, c.wall);
}

/** The point that is chosen. @param {CanvasRenderingContext2D} g @param {number} x @param {number} y @param {Record<string, string>} c */
function drawPin(g, x, y, c) {
  g.beginPath();
  g.moveTo(x, y);
  g.lineTo(x - 9, y - 17);
  g.arc(x, y - 21, 10, Math.PI - 0.4, 0.4);
  g.closePath();
  g.fillStyle = c.text;
  g.strokeStyle = c.card;
  g.lineWidth = 2;
  g.fill();
  g.stroke();
  g.beginPath();
  g.arc(x, y - 21, 3.5, 0, 2 * Math.PI);
  g.fillStyle = c.card;
  g.fill();
}

/** Where Enter chooses a point. @param {CanvasRenderingContext2D} g @param {MapView} view @param {Record<string, string>} c */
function drawCross(g, { width, height }, c) {
  for (const [colour, wide] of /** @type {[string, number][]} */ ([[c.card, 5], [c.text, 2]])) {
    g.beginPath();
    g.moveTo(width / 2 - 14, height / 2);
    g.lineTo(width / 2 + 14, height / 2);
    g.moveTo(width / 2, height / 2 - 14);
    g.lineTo(width / 2, height / 2 + 14);
    g.strokeStyle = colour;
    g.lineWidth = wide;
    g.stroke();
  }
}

/**
 * @param {CanvasRenderingContext2D} g
 * @param {MapView} view
 * @param {import("./store.js").Store} store
 * @param {import("./wire.js").Scene} scene
 * @param {Record<string, string>} c
 */
function drawLive(g, view, store, scene, c) {
  const { live } = store;
  fillAll(g, view, live.furniture, c.furniture, c["furniture-line"]);
  drawNames(g, view, store, scene, c);
  g.fillStyle = c.lidar;
  const lidar = live.lidar ?? [];
  for (let i = 0; i + 1 < lidar.length; i += 2) {
    const [x, y] = view.toScreen(lidar[i], lidar[i + 1]);
    g.fillRect(x - 1, y - 1, 2, 2);
  }
  drawPath(g, view, live, c);
  for (const thing of live.things ?? []) {
    const [x, y] = view.toScreen(thing.x, thing.y);
    g.fillStyle = c.accent;
    g.fillRect(x - 5, y - 5, 10, 10);
    label(g, store.called(thing), x, y - 14, c.text, c.floor);
  }
  if (live.pose) drawRobot(g, view, live.pose, scene.radius ?? 0.2, c);
}

/** @param {[number, number][]} outline @returns {[number, number]} the middle of the box around it */
function middle(outline) {
  const half = (/** @type {number[]} */ v) => (Math.min(...v) + Math.max(...v)) / 2;
  return [half(outline.map((p) => p[0])), half(outline.map((p) => p[1]))];
}

/** @param {CanvasRenderingContext2D} g @param {MapView} view @param {import("./store.js").Store} store @param {import("./wire.js").Scene} scene @param {Record<string, string>} c */
function drawNames(g, view, store, scene, c) {
  g.textAlign = "center";
  g.textBaseline = "middle";
  g.font = "600 13px system-ui, sans-serif";
  for (const room of scene.rooms ?? []) {
    const at = room.outline?.length ? middle(room.outline) : room.goal;
    if (at) label(g, store.called(room), ...view.toScreen(at[0], at[1]), c.quiet, c.room);
  }
  g.font = "12px system-ui, sans-serif";
  for (const place of scene.places ?? []) {
    const [x, y] = view.toScreen(place.x, place.y);
    g.fillStyle = c.accent;
    g.beginPath();
    g.arc(x, y, 4, 0, 2 * Math.PI);
    g.fill();
    label(g, store.called(place), x, y - 12, c.text, c.floor);
  }
}

/** @param {CanvasRenderingContext2D} g @param {MapView} view @param {import("./wire.js").Live} live @param {Record<string, string>} c */
function drawPath(g, view, { path, goal, pose }, c) {
  /** @type {[number, number] | null} */
  const end = goal?.x == null || goal.y == null ? null : [goal.x, goal.y];
  if (path?.length || end) {
    g.beginPath();
    for (const [x, y] of path ?? (end && pose ? [[pose.x, pose.y], end] : [])) g.lineTo(...view.toScreen(x, y));
    g.strokeStyle = c.path;
    g.lineWidth = 3;
    g.lineJoin = "round";
    g.setLineDash(path?.length ? [] : [6, 6]);
    g.stroke();
    g.setLineDash([]);
  }
  if (!end) return;
  const [x, y] = view.toScreen(...end);
  g.strokeStyle = c.path;
  g.lineWidth = 3;
  for (const size of [4, 10]) {
    g.beginPath();
    g.arc(x, y, size, 0, 2 * Math.PI);
    g.stroke();
  }
}

/** @param {CanvasRenderingContext2D} g @param {MapView} view @param {{x: number, y: number, yaw: number}} pose @param {number} radius @param {Record<string, string>} c */
function drawRobot(g, view, pose, radius, c) {
  const [x, y] = view.toScreen(pose.x, pose.y);
  const size = Math.max(9, radius * view.scale);
  g.save();
  g.translate(x, y);
  g.rotate(-pose.yaw);
  g.beginPath();
  g.arc(0, 0, size, 0, 2 * Math.PI);
  g.fillStyle = c.accent;
  g.strokeStyle = c.card;
  g.lineWidth = 2.5;
  g.fill();
  g.stroke();
  g.beginPath();
  g.moveTo(size * 0.62, 0);
  g.lineTo(-size * 0.35, size * 0.45);
  g.lineTo(-size * 0.1, 0);
  g.lineTo(-size * 0.35, -size * 0.45);
  g.closePath();
  g.fillStyle = c["on-accent"];
  g.fill();
  g.restore();
}
