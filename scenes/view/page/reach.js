'use strict';
// How far cells reach in a view: their meshes need not be larger. By bounding discs on a grid: where a body is so far off that
// another is nearer whatever their outlines, its cell is not.

class Reach {
  constructor() {
    Object.assign(this, {columns: 96, rows: 60});
    this.nearest = new Float64Array(this.columns * this.rows);
    this.seen = new Uint8Array(this.columns * this.rows);
  }

  /**
   * Fills things.reach [m]; things from `first` on are bodies, all others are taken to reach everywhere. `closed`: outside of the
   * extent nothing is seen of cells.
   */
  find(things, first, {radii, view, width, height, closed, extent: [x0, y0, x1, y1]}) {
    const {columns, rows, nearest, seen} = this, n = things.count;
    const dx = width / columns / view.scale, dy = height / rows / view.scale, half = 0.5 * Math.hypot(dx, dy);
    Object.assign(this, {dx, dy, half, left: view.x - width / view.scale / 2, low: view.y - height / view.scale / 2});
    for (let j = 0, c = 0; j < rows; ++j)
      for (let k = 0; k < columns; ++k, ++c) {
        const x = this.left + (k + 0.5) * dx, y = this.low + (j + 0.5) * dy;
        seen[c] = closed && (x < x0 - dx || x > x1 + dx || y < y0 - dy || y > y1 + dy) ? 0 : 1;
      }
    // from anywhere in a cell of the grid to the nearest outline: of bodies no farther than `way`, which grows till all is known
    nearest.fill(Infinity);
    const all = Math.hypot(width, height) / view.scale;
    let way = Math.sqrt(width * height / Math.max(1, n - first)) / view.scale, farthest = Infinity;
    for (; n > first && farthest > way && way < 4 * all; way *= 2) {
      for (let i = first; i < n; ++i) this.approach(things.x[i], things.y[i], radii[things.shape[i]], way);
      farthest = 0;
      for (let c = 0; c < nearest.length; ++c) if (seen[c] && nearest[c] > farthest) farthest = nearest[c];
    }
    for (let i = 0; i < first; ++i) things.reach[i] = farthest;
    for (let i = first; i < n; ++i)
      things.reach[i] = this.reachOf(things.x[i], things.y[i], radii[things.shape[i]], Math.min(way, farthest) + half);
  }

  /** The cells of the grid that hold what is no farther than `most` from a place. */
  around(x, y, most) {
    const {left, low, dx, dy, columns, rows} = this;
    this.first = Math.max(0, Math.floor((x - most - left) / dx));
    this.last = Math.min(columns, Math.ceil((x + most - left) / dx));
    this.bottom = Math.max(0, Math.floor((y - most - low) / dy));
    this.top = Math.min(rows, Math.ceil((y + most - low) / dy));
  }

  approach(x, y, r, way) {
    this.around(x, y, way + r + this.half);
    const {nearest, columns, first, last, top, left, low, dx, dy} = this, more = r + this.half;
    for (let j = this.bottom; j < top; ++j) {
      const v = low + (j + 0.5) * dy - y;
      for (let k = first, c = j * columns + first; k < last; ++k, ++c) {
        const u = left + (k + 0.5) * dx - x, d = Math.sqrt(u * u + v * v) + more;
        if (d < nearest[c]) nearest[c] = d;
      }
    }
  }

  reachOf(x, y, r, way) {
    this.around(x, y, way + r + this.half);
    const {nearest, seen, columns, first, last, top, left, low, dx, dy} = this, less = r + this.half;
    let reach = 0;
    for (let j = this.bottom; j < top; ++j) {
      const v = low + (j + 0.5) * dy - y;
      for (let k = first, c = j * columns + first; k < last; ++k, ++c) {
        if (!seen[c] || nearest[c] <= reach) continue;
        const u = left + (k + 0.5) * dx - x;
        if (Math.sqrt(u * u + v * v) - less <= nearest[c]) reach = nearest[c];
      }
    }
    return reach;
  }
}
