'use strict';
// Discs by the pixel, for browsers without a graphics card: there a thousand ellipses take longer than a frame has time.

const INKS = new Map();  // of a color's name, as a pixel without opacity
function pixelOf(ink) {
  let pixel = INKS.get(ink);
  if (pixel === undefined) {
    const digits = /^#([0-9a-f]{6})$/i.exec(ink), [r, g, b] = digits
      ? [0, 2, 4].map(k => parseInt(digits[1].slice(k, k + 2), 16))
      : (ink.match(/[\d.]+/g) || [0, 0, 0]).map(Number);
    INKS.set(ink, pixel = (b << 16 | g << 8 | r) >>> 0);
  }
  return pixel;
}

class Discs {
  constructor() {
    this.canvas = document.createElement('canvas');
    this.ctx = this.canvas.getContext('2d', {willReadFrequently: true});
  }

  /** Nothing is drawn; as large as another canvas. */
  clear({width, height}) {
    if (!this.image || this.image.width !== width || this.image.height !== height) {
      Object.assign(this.canvas, {width, height});
      this.image = this.ctx.createImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
    } else if (this.low < this.high) this.pixels.fill(0, this.low * width, this.high * width);
    Object.assign(this, {low: height, high: 0});  // rows that have something
  }

  /** What was drawn since, over a canvas as large. */
  onto(ctx) {
    const rows = this.high - this.low;
    if (!(rows > 0)) return;
    this.ctx.putImageData(this.image, 0, 0, 0, this.low, this.image.width, rows);
    ctx.drawImage(this.canvas, 0, this.low, this.image.width, rows, 0, this.low, this.image.width, rows);
  }

  /** A disc of `fill` with a rim of `line` between two radii [px]. */
  disc(x, y, inner, outer, fill, line) {
    const {width, height} = this.image, {pixels} = this, inside = pixelOf(fill), rim = pixelOf(line), reach = outer + 0.5;
    const top = Math.max(0, Math.ceil(y - reach - 0.5)), bottom = Math.min(height - 1, Math.floor(y + reach - 0.5));
    if (top > bottom) return;
    this.low = Math.min(this.low, top);
    this.high = Math.max(this.high, bottom + 1);
    const sure = inner > 0.5 ? inner - 0.5 : 0;
    for (let row = top; row <= bottom; ++row) {
      const dy = row + 0.5 - y, half = Math.sqrt(Math.max(0, reach * reach - dy * dy));
      const from = Math.max(0, Math.ceil(x - half - 0.5)), to = Math.min(width - 1, Math.floor(x + half - 0.5));
      // between these all is fill
      const flat = sure > Math.abs(dy) ? Math.sqrt(sure * sure - dy * dy) : -1;
      const start = flat < 0 ? to + 1 : Math.max(from, Math.ceil(x - flat - 0.5)), end = flat < 0 ? to : Math.min(to, Math.floor(x + flat - 0.5));
      for (let k = from; k <= to; ++k) {
        if (k === start && end >= start) {
          pixels.fill((inside | 0xff000000) >>> 0, row * width + start, row * width + end + 1);
          k = end;
          continue;
        }
        const dx = k + 0.5 - x, d = Math.sqrt(dx * dx + dy * dy), part = inner + 0.5 - d;
        this.over(row * width + k, part <= 0 ? rim : part >= 1 ? inside : mixed(rim, inside, part), covered(outer, d));
      }
    }
  }

  /** A line with round ends, of such a width [px]. */
  line(ax, ay, bx, by, wide, ink) {
    const {width, height} = this.image, half = wide / 2, reach = half + 0.5, color = pixelOf(ink), vx = bx - ax, vy = by - ay, l = vx * vx + vy * vy;
    const top = Math.max(0, Math.ceil(Math.min(ay, by) - reach - 0.5)), bottom = Math.min(height - 1, Math.floor(Math.max(ay, by) + reach - 0.5));
    const from = Math.max(0, Math.ceil(Math.min(ax, bx) - reach - 0.5)), to = Math.min(width - 1, Math.floor(Math.max(ax, bx) + reach - 0.5));
    for (let row = top; row <= bottom; ++row)
      for (let k = from; k <= to; ++k) {
        const x = k + 0.5 - ax, y = row + 0.5 - ay, at = l > 0 ? Math.min(1, Math.max(0, (x * vx + y * vy) / l)) : 0;
        const cover = covered(half, Math.hypot(x - at * vx, y - at * vy));
        if (cover > 0) this.over(row * width + k, color, cover);
      }
  }

  /** A color, as much as covers the pixel, over what is there. */
  over(at, color, cover) {
    if (cover <= 0) return;
    const under = this.pixels[at];
    if (under === 0 || cover >= 1) {
      this.pixels[at] = (color | (255 * cover + 0.5) << 24) >>> 0;
      return;
    }
    const below = (under >>> 24) / 255 * (1 - cover), all = cover + below;
    this.pixels[at] = (mixed(under, color, cover / all) | (255 * all + 0.5) << 24) >>> 0;
  }
}

/** How much of a pixel at a distance from the middle is within a radius: as for a straight edge. */
function covered(radius, d) { return Math.min(1, Math.max(0, radius + 0.5 - d)); }

/** Of a at 0, of b at 1; without opacity. Red and blue are done at once, in 256ths. */
function mixed(a, b, t) {
  const of = t * 256 | 0, rest = 256 - of;
  return ((a & 0xff00ff) * rest + (b & 0xff00ff) * of) >>> 8 & 0xff00ff | ((a & 0xff00) * rest + (b & 0xff00) * of) >>> 8 & 0xff00;
}
