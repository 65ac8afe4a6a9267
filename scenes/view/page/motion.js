'use strict';
// What is known of a run, and where everything is at any time.
//
// A body's motion is known at frames (all bodies at once) and at its own events (with the twist before and after). Between
// two of these it is the cubic with their places and twists: that is the motion itself where accelerations are constant,
// and off by the fourth order of the interval where an integrator drove it.

/** The numbers of the page: inflated, each array with the bytes of its values sorted by significance. */
async function inflated(base64, arrays) {
  const text = atob(base64.trim());
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const numbers = {};
  let at = 0;
  for (const [name, kind, count] of arrays) {
    const size = kind === 'f64' ? 8 : 4, whole = new Uint8Array(count * size);
    for (let b = 0; b < size; ++b)
      for (let i = 0, from = at + b * count; i < count; ++i) whole[i * size + b] = bytes[from + i];
    numbers[name] = kind === 'f64' ? new Float64Array(whole.buffer) : new Int32Array(whole.buffer);
    at += count * size;
  }
  return numbers;
}

/** The last index of sorted times at or before t; -1 if there is none. */
function lastAtOrBefore(times, t, from = 0, to = times.length) {
  let low = from - 1, high = to;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  return low >= from ? low : -1;
}

/** Value and slope of the cubic through (0, a) and (h, b) with slopes va, vb, at s of [0, h]. */
function cubic(a, va, b, vb, h, s) {
  const d = (b - a) / h, c2 = (3 * d - 2 * va - vb) / h, c3 = (va + vb - 2 * d) / (h * h);
  return [a + s * (va + s * (c2 + s * c3)), va + s * (2 * c2 + 3 * s * c3)];
}

const COLUMNS = ['x', 'y', 'angle', 'vx', 'vy', 'omega'];

/** Things that move, known at frames: `values[c]` is a column of frames times things. */
class Frames {
  constructor(times, count, values) {
    Object.assign(this, {times, count, values});
  }
  /** The six numbers of a thing at a frame. */
  at(frame, k) {
    return this.values.map(column => column[frame * this.count + k]);
  }
}

class Motions {
  constructor(about, n) {
    this.bodies = about.bodies;
    this.sites = about.sites;
    this.gravity = about.live ? about.gravity : null;
    this.frames = new Frames(n.frame_t, about.bodies.length, COLUMNS.map(c => n['frame_' + c]));
    const moving = about.sites.map((s, k) => s.moving ? k : -1).filter(k => k >= 0);
    this.movingPlace = new Map(moving.map((k, i) => [k, i]));
    this.siteFrames = new Frames(n.frame_t, moving.length, COLUMNS.map(c => n['site_' + c]));
    this.takeEvents(n);
  }

  get begin() { return this.frames.times.length ? this.frames.times[0] : 0; }
  get end() {
    const last = times => times.length ? times[times.length - 1] : 0;
    return Math.max(last(this.frames.times), this.gravity ? last(this.eventTimes) : 0);
  }

  /** Of every body, in order: when, and the place, twist before and twist after of its events. */
  takeEvents(n) {
    const count = this.bodies.length, events = n.event_t.length;
    const of = new Int32Array(count + 1);
    const sides = [['event_body', 'b_'], ['event_other', 'o_']];
    const known = (side, k) => n[side[0]][k] >= 0 && !Number.isNaN(n[side[1] + 'x'][k]);
    for (let k = 0; k < events; ++k)
      for (const side of sides) if (known(side, k)) ++of[n[side[0]][k] + 1];
    for (let b = 0; b < count; ++b) of[b + 1] += of[b];
    const next = of.slice(), times = new Float64Array(of[count]), rows = new Float64Array(9 * of[count]);
    const names = ['x', 'y', 'angle', 'vx0', 'vy0', 'omega0', 'vx', 'vy', 'omega'];
    for (let k = 0; k < events; ++k)
      for (const side of sides) {
        if (!known(side, k)) continue;
        const i = next[n[side[0]][k]]++;
        times[i] = n.event_t[k];
        names.forEach((name, c) => { rows[9 * i + c] = n[side[1] + name][k]; });
      }
    Object.assign(this, {eventsOf: of, eventTimes: times, eventRows: rows});
  }

  /** [x, y, angle, vx, vy, omega] of body k at time t; where it jumps, of after. */
  body(k, t) {
    const {times} = this.frames, last = times.length - 1;
    const f = Math.max(0, lastAtOrBefore(times, t));
    let left = this.frames.at(f, k), tl = times[f];
    let right = f < last ? this.frames.at(f + 1, k) : null, tr = f < last ? times[f + 1] : Infinity;
    const from = this.eventsOf[k], to = this.eventsOf[k + 1];
    const e = to > from ? lastAtOrBefore(this.eventTimes, t, from, to) : -1;
    const rows = this.eventRows;
    if (e >= from && this.eventTimes[e] >= tl) {
      left = [rows[9 * e], rows[9 * e + 1], rows[9 * e + 2], rows[9 * e + 6], rows[9 * e + 7], rows[9 * e + 8]];
      tl = this.eventTimes[e];
    }
    const g = e >= from ? e + 1 : from;
    if (g < to && this.eventTimes[g] <= tr) {
      right = Array.from(rows.subarray(9 * g, 9 * g + 6));
      tr = this.eventTimes[g];
    }
    // of a run that goes on the next state is not known yet: free flight
    if (!right && this.gravity && t > tl) return falling(left, t - tl, this.gravity);
    return between(left, tl, right, tr, t);
  }

  /** The same of a fixed site. */
  site(k, t) {
    const place = this.movingPlace.get(k);
    if (place === undefined) return [0, 0, 0, 0, 0, 0];
    const {times} = this.siteFrames, f = Math.max(0, lastAtOrBefore(times, t)), more = f + 1 < times.length;
    return between(this.siteFrames.at(f, place), times[f], more ? this.siteFrames.at(f + 1, place) : null,
      more ? times[f + 1] : Infinity, t);
  }
}

function falling([x, y, angle, vx, vy, omega], s, [gx, gy]) {
  return [x + s * (vx + s * gx / 2), y + s * (vy + s * gy / 2), angle + s * omega, vx + s * gx, vy + s * gy, omega];
}

function between(left, tl, right, tr, t) {
  const s = t - tl, h = tr - tl;
  if (!right || !(h > 0) || !(s > 0)) return left;
  const out = new Array(6);
  for (let c = 0; c < 3; ++c) [out[c], out[c + 3]] = cubic(left[c], left[c + 3], right[c], right[c + 3], h, s);
  return out;
}
