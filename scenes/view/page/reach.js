'use strict';
// How far cells reach in a view: their meshes need not be larger. On a grid, by discs about outlines and discs within them: where a
// body is so far off that another is nearer whatever their outlines, its cell is not.

const SQUARES = 15000;  // of the grid, at most
const FINE = 2;  // squares along the room of a body

/** Places along a site; none where it is a point. */
function alongSite({kind, a, b, center, sweep}) {
  if (kind !== 'arc') return kind === 'segment' ? [a, b] : [];
  const x = a[0] - center[0], y = a[1] - center[1], all = [a];
  for (let i = 1; i < 8; ++i) {
    const c = Math.cos(sweep * i / 8), s = Math.sin(sweep * i / 8);
    all.push([center[0] + c * x - s * y, center[1] + s * x + c * y]);
  }
  return [...all, b];
}

/** The distance of a site, without thickness, to the origin. */
function toOrigin({kind, a, b, center, arc_radius, sweep}) {
  const ends = Math.min(Math.hypot(...a), b ? Math.hypot(...b) : Infinity);
  if (kind === 'point') return Math.hypot(...a);
  if (kind === 'segment') {
    const x = b[0] - a[0], y = b[1] - a[1], l = x * x + y * y, at = -(a[0] * x + a[1] * y) / l;
    return at > 0 && at < 1 ? Math.abs(a[0] * y - a[1] * x) / Math.sqrt(l) : ends;
  }
  const far = Math.hypot(...center);
  const turn = turnTo(directionOf([a[0] - center[0], a[1] - center[1]]), directionOf([-center[0], -center[1]])) * Math.sign(sweep);
  const on = (turn + 2 * Math.PI) % (2 * Math.PI) <= Math.abs(sweep);
  return on || far === 0 ? Math.min(ends, Math.abs(far - arc_radius)) : ends;
}

/**
 * Of a shape, [outer, inner]: a place at d from its origin is at least d - outer, and at most max(d - inner, outer - d) from it.
 * Where the origin is inside, a disc about it of radius `inner` is; where it is not, `inner` may be below zero.
 */
function discsOf({loops, container, bounding_radius: outer}) {
  let turns = 0;
  const sites = loops.flatMap(loop => loop.sites), away = sites.map(toOrigin);
  for (const loop of loops)
    for (const site of loop.closed && loop.solid ? loop.sites : []) {
      const line = alongSite(site).map(directionOf);
      for (let i = 1; i < line.length; ++i) turns += turnTo(line[i - 1], line[i]);
    }
  const smallest = of => of.reduce((a, b) => Math.min(a, b), Infinity);
  const inside = !container && turns > Math.PI;
  return [outer, inside ? smallest(away) + smallest(sites.map(s => s.radius)) : -smallest(away.map((d, k) => d - sites[k].radius))];
}

class Reach {
  constructor(shapes) {
    const discs = shapes.map(discsOf);
    Object.assign(this, {outer: discs.map(d => d[0]), inner: discs.map(d => d[1]), columns: 0, rows: 0});
  }

  /**
   * Fills things.reach [m]; things from `first` on are bodies, all others are taken to reach everywhere. `closed`: outside of the
   * extent nothing is seen of cells.
   */
  find(things, first, {view, width, height, closed, extent}) {
    const n = things.count, {outer, inner} = this;
    this.lay(n - first, view, width, height, closed ? extent : [-Infinity, -Infinity, Infinity, Infinity]);
    // Others in between: each finds less that is nearer to it than to those before.
    let step = Math.max(1, Math.floor(0.618 * (n - first)));
    while (common(step, n - first) > 1) ++step;
    for (let i = first, k = 0; i < n; ++i, k = (k + step) % (n - first))
      this.approach(things.x[first + k], things.y[first + k], outer[things.shape[first + k]], inner[things.shape[first + k]]);
    const {nearest} = this;
    let farthest = n > first ? 0 : Infinity;
    for (let j = this.bottom; j < this.top; ++j)
      for (let k = this.left, c = j * this.columns + k; k < this.right; ++k, ++c) if (nearest[c] > farthest) farthest = nearest[c];
    for (let i = 0; i < first; ++i) things.reach[i] = farthest;
    for (let i = first; i < n; ++i)
      things.reach[i] = this.reachOf(things.x[i], things.y[i], outer[things.shape[i]], farthest);
  }

  /** The grid over a view, for so many bodies: how far it is at most from anywhere in a square to what is nearest. */
  lay(bodies, view, width, height, [x0, y0, x1, y1]) {
    const squares = Math.min(SQUARES, Math.max(600, FINE * FINE * bodies)), side = Math.sqrt(width * height / squares);
    const columns = Math.ceil(width / side), rows = Math.ceil(height / side), d = side / view.scale;
    const x = view.x - width / view.scale / 2, y = view.y - height / view.scale / 2, n = columns * rows;
    if (!this.nearest || this.nearest.length < n) this.nearest = new Float64Array(n);
    this.nearest.fill(Infinity, 0, n);
    const within = (from, low, most) => Math.min(most, Math.max(0, Math.floor((from - low) / d)));
    Object.assign(this, {columns, rows, d, x, y, half: d * Math.SQRT1_2,
      // what is seen of it; a row more on each side, for what lies on a border
      left: within(x0 - d, x, columns), right: within(x1 + 2 * d, x, columns), bottom: within(y0 - d, y, rows), top: within(y1 + 2 * d, y, rows)});
    if (!Number.isFinite(x0)) Object.assign(this, {left: 0, right: columns, bottom: 0, top: rows});
  }

  // Where a body is nearer than others by such bounds is a star about its place: of squares in rings about it none is in it once a
  // whole ring is not.

  /** What is nearest may be this body. */
  approach(x, y, outer, inner) {
    const {nearest, columns, left, right, bottom, top, d, half} = this;
    const column = Math.floor((x - this.x) / d), row = Math.floor((y - this.y) / d);
    const sure = outer / d + 2, far = Math.max(column - left, right - column, row - bottom, top - row);
    const outside = column < left || column >= right || row < bottom || row >= top;
    for (let ring = 0, any = true; ring <= far && (any || outside || ring < sure); ++ring) {
      any = false;
      const from = Math.max(left, column - ring), to = Math.min(right - 1, column + ring);
      for (let j = Math.max(bottom, row - ring); j <= Math.min(top - 1, row + ring); ++j) {
        const v = this.y + (j + 0.5) * d - y, edge = j === row - ring || j === row + ring;
        for (let k = edge ? from : column - ring; k <= to; k += edge ? 1 : 2 * ring) {
          if (k < from) continue;
          const u = this.x + (k + 0.5) * d - x, l = Math.sqrt(u * u + v * v), h = Math.max(l - inner, outer - l) + half;
          if (h >= nearest[j * columns + k]) continue;
          nearest[j * columns + k] = h;
          any = true;
        }
      }
    }
  }

  /** The farthest from this body that a place may be which is its own; not beyond `most`. */
  reachOf(x, y, outer, most) {
    const {nearest, columns, left, right, bottom, top, d, half} = this;
    const column = Math.floor((x - this.x) / d), row = Math.floor((y - this.y) / d), less = outer + half;
    const far = Math.min(Math.max(column - left, right - column, row - bottom, top - row), Math.ceil((most + less + half) / d));
    const outside = column < left || column >= right || row < bottom || row >= top;
    let reach = 0;
    for (let ring = 0, any = true; ring <= far && (any || outside); ++ring) {
      any = false;
      const from = Math.max(left, column - ring), to = Math.min(right - 1, column + ring);
      for (let j = Math.max(bottom, row - ring); j <= Math.min(top - 1, row + ring); ++j) {
        const v = this.y + (j + 0.5) * d - y, edge = j === row - ring || j === row + ring;
        for (let k = edge ? from : column - ring; k <= to; k += edge ? 1 : 2 * ring) {
          if (k < from) continue;
          const u = this.x + (k + 0.5) * d - x, near = nearest[j * columns + k];
          if (Math.sqrt(u * u + v * v) - less > near) continue;
          any = true;
          if (near > reach) reach = near;
        }
      }
    }
    return reach;
  }
}

/** The greatest common divisor. */
function common(a, b) { return b === 0 ? a : common(b, a % b); }
