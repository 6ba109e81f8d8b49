/** A map of cells, such as a robot makes for itself: a grey picture, shown in the colours of the page. */
import { h } from "./dom.js";

/** @typedef {import("./wire.js").Grid} Grid */

export class MapGrid {
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

  /** @param {CanvasRenderingContext2D} g @param {import("./map_view.js").MapView} view @param {Record<string, string>} c */
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
