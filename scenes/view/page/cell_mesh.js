'use strict';
// An outline as the method draws it: every site a mesh whose height is the distance to it (a cone about a point, tents over a
// segment, a funnel over an arc).

const VERTEX = 7;  // numbers of a vertex
const OVERLAP = 0.03;  // [rad], of what meets at a vertex: no pixel falls between

const directionOf = ([x, y]) => Math.atan2(y, x);
const turnTo = (from, to) => Math.atan2(Math.sin(to - from), Math.cos(to - from));

/** Direction of travel along a site [rad], at its beginning or end. */
function directionAt(site, point) {
  if (site.kind === 'segment') return directionOf([site.b[0] - site.a[0], site.b[1] - site.a[1]]);
  return directionOf([point[0] - site.center[0], point[1] - site.center[1]]) + Math.sign(site.sweep) * Math.PI / 2;
}

const SECTOR = Math.PI / 3;  // of a fan, at most: a wider one is farther from round, and has more pixels than it needs

/**
 * Vertices and the triangles between them. What a pixel is told is q, the way to it from the nearest place of the site (of an arc
 * from its centre), which is linear on a triangle: its distance is | |q| - arc_radius | - radius, without an error.
 *
 * A vertex is a base point, whence it lies off by `grow` times the farthest distance asked for and the two radii, but no more
 * than `most`; that is its q, too.
 */
class CellMesh {
  constructor(shape) {
    Object.assign(this, {vertices: [], triangles: []});
    for (const loop of shape.loops) {
      // from inside of a solid it is no farther than that to its outline
      this.inner = loop.closed && loop.solid && !shape.container ? shape.bounding_radius : Infinity;
      this.loop(loop);
    }
  }

  vertex([x, y], gx, gy, {radius, arc_radius = 0}, most = Infinity) {
    return this.vertices.push(x, y, gx, gy, radius, arc_radius, Math.min(most + radius, 1e30)) / VERTEX - 1;
  }

  /** Each site covers what is abreast of it, each vertex the sector between its sites' normals: what is nearest to anything is
   * nearest to what covers it. */
  loop({sites, closed}) {
    const last = sites[sites.length - 1];
    if (sites[0].kind === 'point') { for (const site of sites) this.fan(site.a, 0, 2 * Math.PI, {radius: site.radius}); return; }
    for (const site of sites) site.kind === 'segment' ? this.tents(site) : this.funnel(site);
    for (let i = 1; i < sites.length; ++i) this.joint(sites[i - 1], sites[i]);
    if (closed) { this.joint(last, sites[0]); return; }
    const half = Math.PI + 2 * OVERLAP;
    this.fan(sites[0].a, directionAt(sites[0], sites[0].a) + Math.PI / 2 - OVERLAP, half, {radius: sites[0].radius});
    this.fan(last.b, directionAt(last, last.b) - Math.PI / 2 - OVERLAP, half, {radius: last.radius});
  }

  /** Of a whole turn one triangle about the centre does: what it has more than a fan takes less time than a fan's triangles. */
  fan(center, from, sweep, radii) {
    if (Math.abs(sweep) >= 2 * Math.PI) { this.around(center, radii); return; }
    const steps = Math.max(1, Math.ceil(Math.abs(sweep) / SECTOR)), m = 1 / Math.cos(sweep / steps / 2);
    const top = this.vertex(center, 0, 0, radii);
    for (let i = 0; i <= steps; ++i) {
      const a = from + sweep * i / steps, k = this.vertex(center, m * Math.cos(a), m * Math.sin(a), radii);
      if (i > 0) this.triangles.push(top, k - 1, k);
    }
  }

  /** Equal sides that touch the circle. */
  around(center, radii) {
    const [k] = [0, 1, 2].map(i => 2 * Math.PI * i / 3).map(a => this.vertex(center, 2 * Math.cos(a), 2 * Math.sin(a), radii));
    this.triangles.push(k, k + 1, k + 2);
  }

  /** Both sides at once: q grows from one to the other, through zero. */
  tents(site) {
    const {a, b} = site, dx = b[0] - a[0], dy = b[1] - a[1], l = Math.hypot(dx, dy) || 1, nx = -dy / l, ny = dx / l;
    const corners = [[a, 1], [b, 1], [b, -1], [a, -1]];  // the solid is on the left
    const [k] = corners.map(([at, s]) => this.vertex(at, s * nx, s * ny, site, s > 0 ? this.inner : Infinity));
    this.triangles.push(k, k + 1, k + 2, k, k + 2, k + 3);
  }

  /** A fan about the arc's centre covers what is nearer to the centre, too. */
  funnel({a, center, sweep, radius, arc_radius}) {
    this.fan(center, directionOf([a[0] - center[0], a[1] - center[1]]), sweep, {radius, arc_radius});
  }

  joint(before, after) {
    const from = directionAt(before, before.b), turn = turnTo(from, directionAt(after, after.a));
    if (before.radius !== after.radius) { this.fan(after.a, 0, 2 * Math.PI, {radius: after.radius}); return; }
    const over = Math.sign(turn || 1) * OVERLAP;
    const side = (sign, sweep) => this.fan(after.a, from + sign * Math.PI / 2 - over, sweep + 2 * over, {radius: after.radius});
    side(turn > 0 ? -1 : 1, turn);
    if (Math.abs(turn) < OVERLAP) side(turn > 0 ? 1 : -1, turn);
  }
}
