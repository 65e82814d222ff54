// @ts-check
/** Tiles of a grid as pictures, in the colours of the page. */

import { TileCache } from "./tile_cache.js";
import { TILE } from "./wire.js";

const SIDES = [TILE / 4, TILE / 2, TILE]; // pixels of the pictures of a tile: where it is small, a small one is drawn, for speed
const LARGEST = 1.2; // times as large as it is may a picture be drawn where there is a larger one

/** @typedef {import("./wire.js").Grid} Grid */

export class MapTiles {
  /** @param {boolean} keep draw the tiles of the grid before until a tile of the new one is there: it changes often */
  constructor(keep = false) {
    this.keep = keep;
    /** @type {MapTiles | null} */
    this.before = null;
    /** @type {Grid | null} */
    this.grid = null;
    /** Pictures: one for each of SIDES, the smallest first. @type {Map<string, {column: number, row: number, cells: Int8Array, pictures: HTMLCanvasElement[]}>} */
    this.tiles = new Map();
    this.palette = new Uint32Array(256);
    /** Changes with what is drawn. */
    this.version = 0;
    this.cache = new TileCache();
  }

  /** @param {Grid} grid */
  setGrid(grid) {
    this.version += 1;
    if (this.grid?.generation !== grid.generation) {
      if (this.keep && this.tiles.size && grid.width) {
        this.before = new MapTiles();
        [this.before.grid, this.before.tiles] = [this.grid, this.tiles];
      } else this.before = null;
      this.tiles = new Map();
    }
    this.grid = grid;
  }

  /** @param {number} column @param {number} row @param {number} generation @param {Int8Array} cells */
  setTile(column, row, generation, cells) {
    if (this.grid?.generation !== generation || cells.length !== TILE * TILE) return;
    this.before = null;
    const pictures = SIDES.map((side) => Object.assign(document.createElement("canvas"), { width: side, height: side }));
    this.paint(pictures, cells);
    this.tiles.set(`${column} ${row}`, { column, row, cells, pictures });
    this.version += 1;
  }

  /** Colours of unknown, free and occupied cells. @param {string} unknown @param {string} free @param {string} wall */
  setColours(unknown, free, wall) {
    const [a, b, c] = [unknown, free, wall].map(readColour);
    for (let value = 0; value <= 100; value++) {
      const share = value / 100;
      this.palette[value] = pack(b.map((part, index) => Math.round(part + share * (c[index] - part))));
    }
    this.palette.fill(pack(a), 101);
    this.repaint();
  }

  /** One colour, the more of it the higher the cost; nothing where it is free or unknown. @param {string} text */
  setCostColour(text) {
    const [red, green, blue] = readColour(text);
    this.palette.fill(0);
    for (let cost = 1; cost <= 100; cost++) {
      const alpha = cost >= 99 ? 200 : Math.round(1.2 * cost);
      this.palette[cost] = (((alpha << 24) | (blue << 16) | (green << 8) | red) >>> 0);
    }
    this.repaint();
  }

  repaint() {
    for (const tile of this.tiles.values()) this.paint(tile.pictures, tile.cells);
    this.version += 1;
  }

  /** @param {HTMLCanvasElement[]} pictures @param {Int8Array} cells */
  paint(pictures, cells) {
    const [context, ...smaller] = pictures.map((each) => /** @type {CanvasRenderingContext2D} */ (each.getContext("2d"))).reverse();
    const image = context.createImageData(TILE, TILE);
    const pixels = new Uint32Array(image.data.buffer);
    const values = new Uint8Array(cells.buffer, cells.byteOffset, cells.length);
    for (let row = 0; row < TILE; row++) {
      const to = (TILE - 1 - row) * TILE;
      for (let column = 0; column < TILE; column++) pixels[to + column] = this.palette[values[row * TILE + column]];
    }
    context.putImageData(image, 0, 0);
    for (const reduced of smaller) {
      const side = reduced.canvas.width;
      reduced.clearRect(0, 0, side, side);
      reduced.imageSmoothingQuality = "high"; // thin walls stay in sight
      reduced.drawImage(context.canvas, 0, 0, side, side);
    }
  }

  /** The corners of the grid in the map frame: left, low, right, high; null without a grid. */
  bounds() {
    const grid = this.grid;
    if (!grid) return null;
    const [c, s] = [Math.cos(grid.yaw), Math.sin(grid.yaw)];
    const xs = [];
    const ys = [];
    for (const column of [grid.column, grid.column + grid.width]) {
      for (const row of [grid.row, grid.row + grid.height]) {
        const [x, y] = [column * grid.resolution, row * grid.resolution];
        xs.push(grid.x + c * x - s * y);
        ys.push(grid.y + s * x + c * y);
      }
    }
    return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
  }

  /** @param {CanvasRenderingContext2D} context @param {import("./view.js").View} view */
  draw(context, view) {
    if (this.before) {
      this.before.draw(context, view);
      return;
    }
    if (!this.grid) return;
    if (view.turned) {
      context.save();
      this.draw(context, view.straighten(context));
      context.restore();
    } else if (view.scale * this.grid.resolution < 1) {
      this.cache.draw(context, view, this.version, (target, seen) => this.drawTiles(target, seen));
    } else {
      this.cache.drop();
      this.drawTiles(context, view);
    }
  }

  /** @param {CanvasRenderingContext2D} context @param {import("./view.js").View} view */
  drawTiles(context, view) {
    const grid = this.grid;
    if (!grid) return;
    const side = TILE * grid.resolution;
    context.imageSmoothingEnabled = view.scale * grid.resolution < 1;
    const drawn = view.scale * side * (devicePixelRatio || 1);
    const level = SIDES.findIndex((each) => each === TILE || drawn <= LARGEST * each);
    for (const tile of this.tiles.values()) {
      const [left, low] = [tile.column * side, tile.row * side];
      if (grid.yaw === 0) {
        const [x0, y1] = view.toScreen(grid.x + left, grid.y + low);
        const [x1, y0] = view.toScreen(grid.x + left + side, grid.y + low + side);
        if (x1 < 0 || y1 < 0 || x0 > view.width || y0 > view.height) continue;
        const [x, y] = [Math.round(x0), Math.round(y0)]; // neighbours share an edge: no seam
        context.drawImage(tile.pictures[level], x, y, Math.round(x1) - x, Math.round(y1) - y);
      } else {
        context.save();
        context.translate(...view.toScreen(grid.x, grid.y));
        context.rotate(-grid.yaw);
        context.scale(view.scale, view.scale);
        context.drawImage(tile.pictures[level], left, -low - side, side * 1.002, side * 1.002);
        context.restore();
      }
    }
  }
}

/** @param {string} text `#rrggbb` */
function readColour(text) {
  const number = parseInt(text.trim().slice(1), 16);
  return [(number >> 16) & 255, (number >> 8) & 255, number & 255];
}

/** @param {number[]} parts red, green, blue */
function pack(parts) {
  return (255 << 24) | (parts[2] << 16) | (parts[1] << 8) | parts[0];
}
