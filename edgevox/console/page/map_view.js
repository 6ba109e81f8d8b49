/** Where the map stands on its canvas: metres to pixels and back, moved by fingers, mouse and keys. */

const FURTHEST = 0.01;
const CLOSEST = 400;

export class MapView {
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
    this.width = 0;
    this.height = 0;
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
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale];
  }

  /** @param {number} px @param {number} py @returns {[number, number]} */
  toMap(px, py) {
    return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale];
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
export function moveByHand(canvas, view, changed, tapped) {
  /** @type {Map<number, {x: number, y: number}>} */
  const fingers = new Map();
  let moved = 0;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
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
    keys[event.key]();
    changed();
  });
}
