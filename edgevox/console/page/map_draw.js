/** The map as it is painted: what stands still once, what moves with every picture. */

/** @typedef {import("./map_view.js").MapView} MapView */
/** @typedef {import("./wire.js").Shape} Shape */

const NAMES = ["floor", "room", "wall", "furniture", "furniture-line", "lidar", "path", "text", "quiet",
  "accent", "on-accent", "card", "line"];

/** The colours of the style sheet, for a canvas. @returns {Record<string, string>} */
export function colours() {
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
 * @param {import("./map_grid.js").MapGrid} grid
 */
export function drawScene(g, view, scene, c, grid) {
  const [x0, y0, x1, y1] = scene.bounds;
  fillAll(g, view, [{ points: [[x0, y0], [x1, y0], [x1, y1], [x0, y1]] }], c.floor);
  grid.draw(g, view, c);
  fillAll(g, view, scene.rooms?.map((room) => ({ points: room.outline })), c.room, c.line);
  fillAll(g, view, scene.furniture, c.furniture, c["furniture-line"]);
  fillAll(g, view, scene.walls, c.wall, c.wall);
}

/**
 * @param {CanvasRenderingContext2D} g
 * @param {MapView} view
 * @param {import("./wire.js").Live} live
 * @param {import("./wire.js").Scene} scene
 * @param {Record<string, string>} c
 */
export function drawLive(g, view, live, scene, c) {
  fillAll(g, view, live.furniture, c.furniture, c["furniture-line"]);
  drawNames(g, view, scene, c);
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
    label(g, thing.label ?? thing.name, x, y - 14, c.text, c.floor);
  }
  if (live.pose) drawRobot(g, view, live.pose, scene.radius ?? 0.2, c);
}

/** @param {[number, number][]} outline @returns {[number, number]} the middle of the box around it */
function middle(outline) {
  const half = (/** @type {number[]} */ v) => (Math.min(...v) + Math.max(...v)) / 2;
  return [half(outline.map((p) => p[0])), half(outline.map((p) => p[1]))];
}

/** @param {CanvasRenderingContext2D} g @param {MapView} view @param {import("./wire.js").Scene} scene @param {Record<string, string>} c */
function drawNames(g, view, scene, c) {
  g.textAlign = "center";
  g.textBaseline = "middle";
  g.font = "600 13px system-ui, sans-serif";
  for (const room of scene.rooms ?? []) {
    const at = room.outline?.length ? middle(room.outline) : room.goal;
    if (at) label(g, room.label ?? room.name, ...view.toScreen(at[0], at[1]), c.quiet, c.room);
  }
  g.font = "12px system-ui, sans-serif";
  for (const place of scene.places ?? []) {
    const [x, y] = view.toScreen(place.x, place.y);
    g.fillStyle = c.accent;
    g.beginPath();
    g.arc(x, y, 4, 0, 2 * Math.PI);
    g.fill();
    label(g, place.label ?? place.name, x, y - 12, c.text, c.floor);
  }
}

/** @param {CanvasRenderingContext2D} g @param {MapView} view @param {import("./wire.js").Live} live @param {Record<string, string>} c */
function drawPath(g, view, { path, goal, pose }, c) {
  if (path?.length || goal) {
    g.beginPath();
    for (const [x, y] of path ?? (goal && pose ? [[pose.x, pose.y], [goal.x, goal.y]] : [])) g.lineTo(...view.toScreen(x, y));
    g.strokeStyle = c.path;
    g.lineWidth = 3;
    g.lineJoin = "round";
    g.setLineDash(path?.length ? [] : [6, 6]);
    g.stroke();
    g.setLineDash([]);
  }
  if (!goal) return;
  const [x, y] = view.toScreen(goal.x, goal.y);
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
