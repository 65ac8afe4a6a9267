'use strict';
// The scene at one time on a canvas: outlines as they are (arcs as arcs), marks over them.

const LAYERS = [
  ['cells', 'Voronoi cells', true], ['bodies', 'bodies', true], ['pass', 'its pass', false],
  ['contacts', 'contacts', true], ['forces', 'lasting forces', false], ['trails', 'trails', false],
  ['velocities', 'velocities', false], ['springs', 'springs', true], ['images', 'periodic images', true],
  ['names', 'names', false],
];

const ITSELF = [[0, 0]];
const CONTACT_INK = '#d03030';
const MOST_CONTACTS = 100;  // more at once would cover what they tell of
const MARK_FROM = 7;  // [px], a smaller body carries no mark of how it has turned

/** A cell's pale colour; on dark paper as much of its hue, and little more light than that has. */
function onPaper(color, paper) {
  if (paper[1] > 0.5) return color;
  const grey = Math.min(...color);
  return color.map((part, k) => Math.min(1, paper[k] + 0.05 + 1.5 * (part - grey)));
}

/** An outline as paths: what is filled, and what is stroked (thickness, crisp edge). Lengths are in `unit` [m]: canvases lose what is
 * far smaller than 1. */
function pathsOf(shape, unit) {
  const fill = new Path2D(), edge = new Path2D();
  let radius = 0;
  for (const loop of shape.loops) {
    let pen = null;
    const path = new Path2D();
    for (const site of loop.sites) {
      radius = Math.max(radius, site.radius);
      if (site.kind === 'point') { path.arc(site.a[0] / unit, site.a[1] / unit, Math.max(site.radius, 0) / unit, 0, 2 * Math.PI); continue; }
      if (!pen || Math.hypot(pen[0] - site.a[0], pen[1] - site.a[1]) > 1e-9 * shape.bounding_radius) path.moveTo(site.a[0] / unit, site.a[1] / unit);
      if (site.kind === 'segment') path.lineTo(site.b[0] / unit, site.b[1] / unit);
      else {
        const [cx, cy] = site.center, from = Math.atan2(site.a[1] - cy, site.a[0] - cx);
        path.arc(cx / unit, cy / unit, site.arc_radius / unit, from, from + site.sweep, site.sweep < 0);
      }
      pen = site.b;
    }
    if (loop.closed && pen) path.closePath();
    edge.addPath(path);
    if (loop.solid || loop.sites.every(s => s.kind === 'point')) fill.addPath(path);
  }
  const point = shape.loops.every(l => l.sites.every(s => s.kind === 'point'));
  const {sites} = shape.loops[0], centred = sites.length === 1 && Math.hypot(...sites[0].a) <= 1e-9 * shape.bounding_radius;
  const disc = point && shape.loops.length === 1 && centred ? radius : 0;
  const bare = point && shape.loops.length === 1 && sites.length === 1 && radius === 0 ? sites[0].a : null;
  return {fill, edge, thickness: point ? 0 : radius, point, disc, bare};
}

class Picture {
  constructor(stage, motions, about, numbers) {
    Object.assign(this, {motions, about, n: numbers});
    this.canvas = stage.querySelector('#scene');
    this.cells = new Cells(stage.querySelector('#cells'), about.shapes);
    // without a graphics card a canvas in memory is ten times as fast
    this.ctx = this.canvas.getContext('2d', {willReadFrequently: this.cells.bySoftware});
    this.discs = this.cells.bySoftware ? new Discs() : null;
    const [x0, y0, x1, y1] = about.extent;
    this.unit = 2 ** Math.round(Math.log2(Math.max(x1 - x0, y1 - y0)));
    this.paths = about.shapes.map(shape => pathsOf(shape, this.unit));
    this.reach = new Reach(about.shapes);
    this.things = new Things();
    this.detail = DETAILS[0];
    this.poses = [];
    this.sitePoses = [];
    this.layers = Object.fromEntries(LAYERS.map(([key, , on]) => [key, on]));
    this.view = {x: 0, y: 0, scale: 1};  // centre [m], pixels a metre
    this.selected = -1;
    this.resize(stage);
    this.fit();
  }

  resize(stage) {
    const ratio = window.devicePixelRatio || 1, box = stage.getBoundingClientRect();
    this.ratio = ratio;
    this.canvas.width = Math.max(1, Math.round(box.width * ratio));
    this.canvas.height = Math.max(1, Math.round(box.height * ratio));
    ({backgroundColor: this.paperInk, color: this.ink} = getComputedStyle(this.canvas.parentElement));
    this.paper = (this.paperInk.match(/[\d.]+/g) || [255, 255, 255]).slice(0, 3).map(word => Number(word) / 255);
  }

  /** All that is worth seeing, with a margin. */
  fit() {
    const [x0, y0, x1, y1] = this.about.extent;
    this.view = {x: (x0 + x1) / 2, y: (y0 + y1) / 2,
      scale: 0.94 * Math.min(this.canvas.width / (x1 - x0), this.canvas.height / (y1 - y0))};
  }

  toPixels(x, y) {
    const v = this.view;
    return [this.canvas.width / 2 + (x - v.x) * v.scale, this.canvas.height / 2 - (y - v.y) * v.scale];
  }
  toWorld(px, py) {
    const v = this.view;
    return [v.x + (px - this.canvas.width / 2) / v.scale, v.y - (py - this.canvas.height / 2) / v.scale];
  }

  /** From now on lengths are units of a frame at this pose. */
  enter([x, y, angle]) {
    const s = this.view.scale * this.unit, c = s * Math.cos(angle), d = s * Math.sin(angle), [px, py] = this.toPixels(x, y);
    this.ctx.setTransform(c, -d, -d, -c, px, py);
  }
  leave() { this.ctx.setTransform(1, 0, 0, 1, 0, 0); }

  /** A disc, which looks the same however it has turned: its rim is what a larger one leaves to be seen. */
  disc(radius, [x, y, angle], ink) {
    const {ctx, view, canvas} = this, px = canvas.width / 2 + (x - view.x) * view.scale, py = canvas.height / 2 - (y - view.y) * view.scale;
    const r = radius * view.scale, half = ink.width * this.ratio / 2;
    if (px + r + half < 0 || py + r + half < 0 || px - r - half > canvas.width || py - r - half > canvas.height) return;
    const spoke = ink.spoke && r >= MARK_FROM * this.ratio;
    if (this.discs) {
      this.discs.disc(px, py, Math.max(0, r - half), r + half, ink.fill, ink.line);
      if (spoke) this.discs.line(px, py, px + r * Math.cos(angle), py - r * Math.sin(angle), 2 * half, ink.line);
      return;
    }
    this.leave();
    this.round(px, py, r + half, ink.line);
    this.round(px, py, Math.max(0, r - half), ink.fill);
    if (!spoke) return;
    ctx.strokeStyle = ink.line;
    ctx.lineWidth = 2 * half;
    ctx.beginPath();
    ctx.moveTo(px, py);
    ctx.lineTo(px + r * Math.cos(angle), py - r * Math.sin(angle));
    ctx.stroke();
  }

  /** Surfaces like this one are sooner done as ellipses than as arcs. */
  round(px, py, r, color) {
    const {ctx} = this;
    ctx.fillStyle = color;
    ctx.beginPath();
    ctx.ellipse(px, py, r, r, 0, 0, 2 * Math.PI);
    ctx.fill();
  }

  outline(shape, pose, ink) {
    const {ctx} = this, paths = this.paths[shape], {unit} = this, pixel = 1 / (this.view.scale * unit);
    if (paths.disc > 0 && ink.fill !== 'transparent') { this.disc(paths.disc, pose, ink); return; }
    this.enter(pose);
    ctx.lineJoin = ctx.lineCap = 'round';
    if (this.about.shapes[shape].container) {
      const out = new Path2D();
      out.rect(-1e6 * pixel, -1e6 * pixel, 2e6 * pixel, 2e6 * pixel);
      out.addPath(paths.edge);
      ctx.fillStyle = this.paperInk;  // nobody can be there
      ctx.fill(out, 'evenodd');
    } else {
      if (paths.thickness > 0) {
        ctx.strokeStyle = ink.fill;
        ctx.lineWidth = 2 * paths.thickness / unit;
        ctx.stroke(paths.edge);
      }
      ctx.fillStyle = ink.fill;
      ctx.fill(paths.fill, 'evenodd');
    }
    ctx.strokeStyle = ink.line;
    ctx.lineWidth = Math.max(ink.width * this.ratio * pixel, paths.thickness > 0 ? 2 * paths.thickness / unit : 0);
    if (!(paths.thickness > 0)) ctx.stroke(paths.edge);
    if (paths.bare) { this.leave(); this.round(...this.toPixels(...placed(pose, paths.bare)), 2.5 * this.ratio, ink.line); return; }
    const r = this.about.shapes[shape].bounding_radius / unit;
    if (paths.point && ink.spoke && r >= MARK_FROM * this.ratio * pixel) {
      ctx.beginPath();
      ctx.moveTo(0, 0);
      ctx.lineTo(r, 0);
      ctx.stroke();
    }
  }

  /** A surface, which is sooner done than lines. */
  arrow(ax, ay, bx, by, color, width) {
    const {ctx} = this, l = Math.hypot(bx - ax, by - ay), ux = (bx - ax) / l, uy = (by - ay) / l;
    if (!(l > 1)) return;
    const long = Math.min(8 * this.ratio, l / 2), wide = 0.4 * long, w = width * this.ratio / 2, nx = bx - long * ux, ny = by - long * uy;
    ctx.fillStyle = color;
    ctx.beginPath();
    ctx.moveTo(ax - w * uy, ay + w * ux);
    ctx.lineTo(nx - w * uy, ny + w * ux);
    ctx.lineTo(nx - wide * uy, ny + wide * ux);
    ctx.lineTo(bx, by);
    ctx.lineTo(nx + wide * uy, ny - wide * ux);
    ctx.lineTo(nx + w * uy, ny - w * ux);
    ctx.lineTo(ax + w * uy, ay - w * ux);
    ctx.fill();
  }

  /** Where the images of a thing are seen; itself first. */
  offsets(pose) {
    const [px, py] = this.about.periods;
    if (!(px > 0 || py > 0)) return ITSELF;
    const xs = px > 0 ? [-px, 0, px] : [0], ys = py > 0 ? [-py, 0, py] : [0];
    // the image in the box, and those beside it
    const inX = px > 0 ? -px * Math.floor(pose[0] / px) : 0, inY = py > 0 ? -py * Math.floor(pose[1] / py) : 0;
    const all = [[inX, inY]];
    if (this.layers.images)
      for (const x of xs) for (const y of ys) if (x || y) all.push([inX + x, inY + y]);
    return all;
  }

  draw(t) {
    const {ctx, about, layers} = this;
    this.leave();
    ctx.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.t = t;
    this.poses.length = about.bodies.length;
    this.sitePoses.length = about.sites.length;
    for (let k = 0; k < this.poses.length; ++k) this.poses[k] = this.motions.body(k, t, this.poses[k]);
    for (let k = 0; k < this.sitePoses.length; ++k) this.sitePoses[k] = this.motions.site(k, t, this.sitePoses[k]);
    const cells = this.cells.works && (layers.cells || layers.pass);
    if (this.cells.works) this.cells.canvas.hidden = !cells;
    if (this.discs) this.discs.clear(this.canvas);
    if (cells) this.drawCells();  // first: others than this thread draw them, while it draws what is above
    // containers first: they cover all that is outside of them
    for (const container of [true, false])
      about.sites.forEach((s, k) => {
        if (about.shapes[s.shape].container !== container) return;
        for (const [x, y] of container ? [[0, 0]] : this.siteOffsets())
          this.outline(s.shape, moved(this.sitePoses[k], x, y), {fill: s.fill, line: s.line, width: 1.4});
      });
    if (layers.springs) this.drawSprings();
    if (layers.trails) this.drawTrails();
    if (layers.bodies) this.drawBodies();
    if (this.discs) {
      this.leave();
      this.discs.onto(ctx);
    }
    if (layers.velocities) this.drawVelocities();
    if (layers.forces) this.drawForces();
    if (layers.contacts) this.drawContacts();
    if (layers.names) this.drawNames();
    this.drawBox();
    this.drawRuler();
    // the browser waits for the cells before it draws what it was told of a canvas in memory, unless that is asked for
    if (cells && this.cells.bySoftware) ctx.getImageData(0, 0, 1, 1);
  }

  /** Where the images of a mark at a place [m] are seen [px], if it is no larger than `size` [px]. */
  seenAt(x, y, size) {
    const {width, height} = this.canvas, all = [];
    for (const [u, v] of this.offsets([x, y])) {
      const at = this.toPixels(x + u, y + v);
      if (at[0] > -size && at[1] > -size && at[0] < width + size && at[1] < height + size) all.push(at);
    }
    return all;
  }

  /** The image of a place that is nearest to another. */
  beside(x, y, [u, v]) {
    const [px, py] = this.about.periods;
    return [px > 0 ? x + px * Math.round((u - x) / px) : x, py > 0 ? y + py * Math.round((v - y) / py) : y];
  }

  siteOffsets() {
    const [px, py] = this.about.periods, all = [];
    if (!this.layers.images || !(px > 0 || py > 0)) return ITSELF;
    for (const x of px > 0 ? [-px, 0, px] : [0]) for (const y of py > 0 ? [-py, 0, py] : [0]) all.push([x, y]);
    return all;
  }

  /** Of a pass, the selected body is left out. */
  drawCells() {
    const {sites, bodies, shapes, extent} = this.about, {things, canvas: {width, height}} = this;
    const out = this.layers.pass ? this.selected : -1;
    things.count = 0;
    sites.forEach((s, k) => {
      const [x, y, angle] = this.sitePoses[k];
      for (const [u, v] of this.siteOffsets()) things.add(s.shape, k, x + u, y + v, angle);
    });
    const first = things.count;
    bodies.forEach((b, k) => {
      if (k === out) return;
      const [x, y, angle] = this.poses[k];
      for (const [u, v] of this.offsets(this.poses[k])) things.add(b.shape, sites.length + k, x + u, y + v, angle);
    });
    if (this.coloured !== this.about || this.colouredOn !== this.paperInk) {
      Object.assign(this, {coloured: this.about, colouredOn: this.paperInk});
      this.cells.setColors([...sites.map(s => s.cell), ...bodies.map((b, k) => shade(b.cell, k))].map(c => onPaper(c, this.paper)));
      this.closed = sites.some(s => shapes[s.shape].container);
    }
    const wanted = 40 * this.ratio / this.view.scale, decade = 10 ** Math.floor(Math.log10(wanted));
    const ring = [1, 2, 5, 10].map(m => m * decade).find(s => s >= wanted) || wanted;
    this.reach.find(things, first, {view: this.view, width, height, closed: this.closed, extent});
    this.cells.draw(things, this.view, [width, height], {ring, paper: this.paper, fixed: this.about.sites.length}, this.detail);
  }

  drawBodies() {
    const {bodies} = this.about, {selected} = this, pass = this.layers.pass && selected >= 0;
    if (this.inked !== this.about) {
      this.inked = this.about;
      this.inks = bodies.map(b => ({fill: b.fill, line: b.line, width: 1.2, spoke: true}));
    }
    for (let k = 0; k < bodies.length; ++k) {
      const ink = k !== selected ? this.inks[k] : {fill: pass ? 'transparent' : bodies[k].fill, line: '#d03030', width: 2.6, spoke: true};
      for (const [x, y] of this.offsets(this.poses[k])) this.outline(bodies[k].shape, moved(this.poses[k], x, y), ink);
    }
  }

  drawSprings() {
    const {ctx} = this;
    this.leave();
    ctx.strokeStyle = '#7a6a3a';
    ctx.lineWidth = 1.3 * this.ratio;
    for (const s of this.about.springs) {
      const a = placed(this.poses[s.body], s.at), b = s.other === null ? s.other_at : placed(this.poses[s.other], s.other_at);
      const dx = (b[0] - a[0]) * this.view.scale, dy = -(b[1] - a[1]) * this.view.scale, l = Math.hypot(dx, dy);
      const turns = 9, w = Math.min(6 * this.ratio, l / 6);
      if (!(l > 0)) continue;
      for (const [x, y] of this.seenAt(...a, l)) {
        ctx.beginPath();
        ctx.moveTo(x, y);
        for (let i = 1; i < turns; ++i) {
          const at = i / turns, side = i % 2 ? w : -w;
          ctx.lineTo(x + at * dx - side * dy / l, y + at * dy + side * dx / l);
        }
        ctx.lineTo(x + dx, y + dy);
        ctx.stroke();
      }
    }
  }

  /** Where bodies have been in the last part of the run. */
  drawTrails() {
    const {ctx, motions, view: {scale}} = this, looks = 120, span = (motions.end - motions.begin) / 8;
    const some = this.selected >= 0 ? [this.selected] : this.about.bodies.map((b, k) => k).slice(0, 200);
    this.leave();
    ctx.lineWidth = 1.2 * this.ratio;
    ctx.globalAlpha = 0.6;
    for (const k of some) {
      const trail = [], [x, y] = this.poses[k];
      let size = 0;
      for (let i = 0; i <= looks; ++i) {
        const s = this.t - span * (1 - i / looks);
        if (s < motions.begin) continue;
        const was = motions.body(k, s), to = [(was[0] - x) * scale, (y - was[1]) * scale];
        trail.push(to);
        size = Math.max(size, Math.hypot(...to));
      }
      ctx.strokeStyle = this.about.bodies[k].line;
      for (const [px, py] of this.seenAt(x, y, size)) {
        ctx.beginPath();
        for (const [dx, dy] of trail) ctx.lineTo(px + dx, py + dy);
        ctx.stroke();
      }
    }
    ctx.globalAlpha = 1;
  }

  drawVelocities() {
    this.leave();
    const most = this.poses.reduce((far, p) => Math.max(far, Math.hypot(p[3], p[4])), 1e-300), long = 60 * this.ratio, scale = long / most;
    for (const p of this.poses)
      for (const [x, y] of this.seenAt(p[0], p[1], long)) this.arrow(x, y, x + scale * p[3], y - scale * p[4], '#1f7a4d', 1.6);
  }

  /** Contacts that last now: from centres to contacts, as wide as the force. */
  drawForces() {
    const {ctx, n, view: {scale}} = this, now = [];
    for (let i = 0; i < n.contact_from.length; ++i)
      if (n.contact_from[i] <= this.t && this.t <= n.contact_to[i]) now.push(i);
    const most = now.reduce((far, i) => Math.max(far, n.contact_force[i]), 1e-300);
    this.leave();
    ctx.strokeStyle = '#a01f5f';
    for (const i of now) {
      ctx.lineWidth = Math.max(0.3, 8 * this.ratio * n.contact_force[i] / most);
      for (const k of [n.contact_body[i], n.contact_other[i]]) {
        if (k < 0) continue;
        const [x, y] = this.poses[k], at = this.beside(n.contact_x[i], n.contact_y[i], this.poses[k]);
        const dx = (at[0] - x) * scale, dy = (y - at[1]) * scale;
        for (const [px, py] of this.seenAt(x, y, Math.hypot(dx, dy))) {
          ctx.beginPath();
          ctx.moveTo(px, py);
          ctx.lineTo(px + dx, py + dy);
          ctx.stroke();
        }
      }
    }
  }

  /** Collisions of a moment ago: where, the normal, and its impulse. Where there are many, the last of them. */
  drawContacts() {
    const {ctx, n, ratio} = this, last = lastAtOrBefore(n.event_t, this.t), now = [];
    let most = 0, back = this.flash;
    for (let k = last; k >= 0 && n.event_t[k] > this.t - this.flash && now.length < MOST_CONTACTS; --k)
      if (!Number.isNaN(n.event_px[k])) { now.push(k); most = Math.max(most, n.event_in[k]); }
    if (now.length === MOST_CONTACTS) back = Math.max(this.t - n.event_t[now[MOST_CONTACTS - 1]], 1e-300);
    this.leave();
    for (const k of now.reverse()) {
      ctx.globalAlpha = 0.25 + 0.75 * (back > 0 ? 1 - (this.t - n.event_t[k]) / back : 1);
      const l = (12 + 36 * (most > 0 ? n.event_in[k] / most : 0)) * ratio;
      for (const [x, y] of this.seenAt(n.event_px[k], n.event_py[k], l)) {
        this.round(x, y, 3.5 * ratio, CONTACT_INK);
        this.arrow(x, y, x + l * n.event_nx[k], y - l * n.event_ny[k], CONTACT_INK, 1.6);
      }
    }
    ctx.globalAlpha = 1;
  }

  /** Those that fit beside each other: the selected body's, then those of the largest. */
  drawNames() {
    const {ctx, about: {bodies, shapes}} = this, taken = [], high = 13 * this.ratio;
    const size = k => k === this.selected ? Infinity : shapes[bodies[k].shape].bounding_radius;
    this.leave();
    ctx.font = `${11 * this.ratio}px sans-serif`;
    ctx.textAlign = 'center';
    ctx.fillStyle = '#000';
    ctx.strokeStyle = 'rgba(255,255,255,.8)';
    ctx.lineWidth = 3 * this.ratio;
    for (const k of bodies.map((b, i) => i).sort((a, b) => size(b) - size(a) || a - b)) {
      const name = printable(bodies[k].name), half = ctx.measureText(name).width / 2;
      for (const [x, y] of this.seenAt(this.poses[k][0], this.poses[k][1], 0)) {
        if (taken.some(t => Math.abs(t.y - y) < high && Math.abs(t.x - x) < t.half + half)) continue;
        taken.push({x, y, half});
        ctx.strokeText(name, x, y);
        ctx.fillText(name, x, y);
      }
    }
  }

  drawBox() {
    const [px, py] = this.about.periods, {ctx} = this;
    if (!(px > 0 || py > 0)) return;
    const [x0, y0, x1, y1] = this.about.extent;
    const a = this.toPixels(px > 0 ? 0 : x0, py > 0 ? 0 : y0), b = this.toPixels(px > 0 ? px : x1, py > 0 ? py : y1);
    this.leave();
    ctx.setLineDash([6 * this.ratio, 4 * this.ratio]);
    ctx.strokeStyle = '#6c7078';
    ctx.lineWidth = this.ratio;
    ctx.strokeRect(a[0], a[1], b[0] - a[0], b[1] - a[1]);
    ctx.setLineDash([]);
  }

  drawRuler() {
    const {ctx, canvas} = this, most = 140 * this.ratio / this.view.scale, decade = 10 ** Math.floor(Math.log10(most));
    const length = [5, 2, 1].map(m => m * decade).find(l => l <= most), w = length * this.view.scale;
    const x = 14 * this.ratio, y = canvas.height - 14 * this.ratio;
    this.leave();
    ctx.font = `${11 * this.ratio}px sans-serif`;
    ctx.textAlign = 'left';
    for (const [color, width] of [[this.paperInk, 3], [this.ink, 1.5]]) {
      ctx.strokeStyle = color;
      ctx.lineWidth = width * this.ratio;
      ctx.strokeRect(x, y, w, 0);
      if (width > 2) ctx.strokeText(`${Number(length.toPrecision(3))} m`, x, y - 6 * this.ratio);
    }
    ctx.fillStyle = this.ink;
    ctx.fillText(`${Number(length.toPrecision(3))} m`, x, y - 6 * this.ratio);
  }

  /** The body at a place of the picture; -1: none. The nearest centre of those whose discs hold it. */
  bodyAt(px, py) {
    const [x, y] = this.toWorld(px, py);
    let found = -1, least = Infinity;
    this.poses.forEach((p, k) => {
      for (const [dx, dy] of this.offsets(p)) {
        const d = Math.hypot(p[0] + dx - x, p[1] + dy - y);
        if (d <= this.about.shapes[this.about.bodies[k].shape].bounding_radius && d < least) [least, found] = [d, k];
      }
    });
    return found;
  }
}

/** Neighbours of one hue, told apart. */
function shade(color, k) { return color.map(c => c * (1 - 0.03 * (k % 3))); }
function moved(pose, x, y) { return x === 0 && y === 0 ? pose : [pose[0] + x, pose[1] + y, pose[2]]; }
function placed([x, y, angle], [u, v]) {
  return [x + u * Math.cos(angle) - v * Math.sin(angle), y + u * Math.sin(angle) + v * Math.cos(angle)];
}
