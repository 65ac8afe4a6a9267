'use strict';
// An outline as the method draws it: every site a mesh whose height is the distance to it (a cone about a point, tents over a
// segment, a funnel over an arc).

const OVERLAP = 0.03;  // [rad], of what meets at a vertex: no pixel falls between

const directionOf = ([x, y]) => Math.atan2(y, x);
const turnTo = (from, to) => Math.atan2(Math.sin(to - from), Math.cos(to - from));

/** Direction of travel along a site [rad], at its beginning or end. */
function directionAt(site, point) {
  if (site.kind === 'segment') return directionOf([site.b[0] - site.a[0], site.b[1] - site.a[1]]);
  return directionOf([point[0] - site.center[0], point[1] - site.center[1]]) + Math.sign(site.sweep) * Math.PI / 2;
}

/**
 * Vertices (base point, direction of growth, height, and the direction in which the distance grows on the triangles that end
 * there) and the triangles between them.
 */
class CellMesh {
  /** `cone`: triangles of a whole turn. */
  constructor(shape, cone) {
    Object.assign(this, {cone, vertices: [], triangles: []});
    for (const loop of shape.loops) this.loop(loop);
  }

  vertex(x, y, dx, dy, z, way = 0) { return this.vertices.push(x, y, dx, dy, z, way) / 6 - 1; }
  quad(a, b, c, d) { this.triangles.push(a, b, c, a, c, d); }
  stepsOf(sweep, least) { return Math.max(least, Math.ceil(this.cone * Math.abs(sweep) / (2 * Math.PI))); }

  /** Each site covers what is abreast of it, each vertex the sector between its sites' normals: what is nearest to anything is
   * nearest to what covers it. */
  loop({sites, closed}) {
    const last = sites[sites.length - 1];
    if (sites[0].kind === 'point') { for (const site of sites) this.fan(site.a, 0, 2 * Math.PI, site.radius); return; }
    for (const site of sites) site.kind === 'segment' ? this.tents(site) : this.funnel(site);
    for (let i = 1; i < sites.length; ++i) this.joint(sites[i - 1], sites[i]);
    if (closed) { this.joint(last, sites[0]); return; }
    const half = Math.PI + 2 * OVERLAP;
    this.fan(sites[0].a, directionAt(sites[0], sites[0].a) + Math.PI / 2 - OVERLAP, half, sites[0].radius);
    this.fan(last.b, directionAt(last, last.b) - Math.PI / 2 - OVERLAP, half, last.radius);
  }

  fan([x, y], from, sweep, r) {
    const steps = this.stepsOf(sweep, 1), m = 1 / Math.cos(sweep / steps / 2), top = this.vertex(x, y, 0, 0, -r);
    for (let i = 0; i <= steps; ++i) {
      const a = from + sweep * i / steps, k = this.vertex(x, y, m * Math.cos(a), m * Math.sin(a), -r, a - sweep / steps / 2);
      if (i > 0) this.triangles.push(top, k - 1, k);
    }
  }

  tents({a, b, radius}) {
    const dx = b[0] - a[0], dy = b[1] - a[1], l = Math.hypot(dx, dy) || 1, nx = -dy / l, ny = dx / l;
    const from = this.vertex(...a, 0, 0, -radius), to = this.vertex(...b, 0, 0, -radius);
    for (const s of [1, -1]) {
      const way = Math.atan2(s * ny, s * nx);
      this.quad(from, to, this.vertex(...b, s * nx, s * ny, -radius, way), this.vertex(...a, s * nx, s * ny, -radius, way));
    }
  }

  funnel({a, center: [cx, cy], arc_radius: R, sweep, radius}) {
    const from = directionOf([a[0] - cx, a[1] - cy]), steps = this.stepsOf(sweep, 2);
    for (let i = 0; i <= steps; ++i) {
      const at = from + sweep * i / steps, c = Math.cos(at), s = Math.sin(at);
      const on = this.vertex(cx + R * c, cy + R * s, 0, 0, -radius), out = this.vertex(cx + R * c, cy + R * s, c, s, -radius, at);
      const bottom = this.vertex(cx, cy, 0, 0, R - radius, at + Math.PI);  // inwards to the centre, where it is R away
      if (i === 0) continue;
      this.quad(on - 3, on, out, out - 3);
      this.triangles.push(on - 3, on, bottom);
    }
  }

  joint(before, after) {
    const from = directionAt(before, before.b), turn = turnTo(from, directionAt(after, after.a));
    if (before.radius !== after.radius) { this.fan(after.a, 0, 2 * Math.PI, after.radius); return; }
    const over = Math.sign(turn || 1) * OVERLAP;
    const side = (sign, sweep) => this.fan(after.a, from + sign * Math.PI / 2 - over, sweep + 2 * over, after.radius);
    side(turn > 0 ? -1 : 1, turn);
    if (Math.abs(turn) < OVERLAP) side(turn > 0 ? 1 : -1, turn);
  }
}
