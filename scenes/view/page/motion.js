'use strict';
// What is known of a run, and where everything is at any time.
//
// A body's motion is known at frames (all bodies at once), and at its own events and its knots in islands (with the twist
// before and after). Between two of these it is the cubic with their places and twists: that is the motion itself where
// accelerations are constant, and off by the fourth order of the interval where an integrator drove it.

/**
 * Text that came from a file, fit to be shown: what would break a line, turn the reading direction or not be seen is written
 * as an escape, as the program does (core/base/printable.h).
 */
function printable(text) {
  return text.replace(/[\p{Cc}\p{Zl}\p{Zp}\p{DI}\ufff0-\ufffb]/gu, c => {
    const code = c.codePointAt(0), digits = code.toString(16);
    return {'\n': '\\n', '\t': '\\t', '\r': '\\r'}[c] ??
      (code < 0x80 ? '\\x' + digits.padStart(2, '0') : '\\u' + digits.padStart(4, '0'));
  });
}

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

const COLUMNS = ['x', 'y', 'angle', 'vx', 'vy', 'omega'];

/** What is known of a body where it passes an event or a knot; and the two sides of an event. */
const PASSED = ['x', 'y', 'angle', 'vx0', 'vy0', 'omega0', 'vx', 'vy', 'omega'];
const SIDES = [['event_body', 'b_'], ['event_other', 'o_']];

/** 0 .. total - 1 by owner, each owner's in their order: those of b are rows[first[b]] .. rows[first[b + 1] - 1]. */
function grouped(count, total, ownerOf) {
  const first = new Int32Array(count + 1), owners = new Int32Array(total);
  for (let i = 0; i < total; ++i) if ((owners[i] = ownerOf(i)) >= 0) ++first[owners[i] + 1];
  for (let b = 0; b < count; ++b) first[b + 1] += first[b];
  const next = first.slice(), rows = new Int32Array(first[count]);
  for (let i = 0; i < total; ++i) if (owners[i] >= 0) rows[next[owners[i]]++] = i;
  return {first, rows};
}

/** Things that move, known at frames: `values[c]` is a column of frames times things. */
class Frames {
  constructor(times, count, values) {
    Object.assign(this, {times, count, values});
  }
  /** Puts the six numbers of a thing at a frame into `out`. */
  at(frame, k, out) {
    for (let c = 0, row = frame * this.count + k; c < 6; ++c) out[c] = this.values[c][row];
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
    // of each site that moves, in its own time: rows siteFirst[i] .. siteFirst[i + 1] - 1
    this.siteFirst = n.site_first;
    this.siteStates = new Frames(n.site_t, 1, COLUMNS.map(c => n['site_' + c]));
    this.left = new Float64Array(6);  // the states before and after the time asked for
    this.right = new Float64Array(6);
    this.takeStates(n, about.first_event || 0);
  }

  get begin() { return this.frames.times.length ? this.frames.times[0] : 0; }
  get end() {
    const {times} = this.frames;
    return Math.max(times.length ? times[times.length - 1] : 0, this.gravity ? this.lastPassed : 0);
  }

  /** Of every body, in order: when, and the place, twist before and twist after of its events and knots. */
  takeStates(n, firstEvent) {
    const count = this.bodies.length;
    const known = (k, who, x) => who[k] >= 0 && !Number.isNaN(x[k]);
    const ofEvents = grouped(count, 2 * n.event_t.length, i => {
      const k = i >> 1, side = SIDES[i & 1];
      return known(k, n[side[0]], n[side[1] + 'x']) ? n[side[0]][k] : -1;
    });
    const ofKnots = grouped(count, n.knot_t.length, k => n.knot_body[k]);
    const all = ofEvents.rows.length + ofKnots.rows.length;
    const of = new Int32Array(count + 1), times = new Float64Array(all), rows = new Float64Array(9 * all);
    const columns = prefix => PASSED.map(name => n[prefix + name]);
    const sides = SIDES.map(side => columns(side[1])), knots = columns('knot_');
    let at = 0;
    const put = (t, from, k) => {
      times[at] = t;
      for (let c = 0; c < 9; ++c) rows[9 * at + c] = from[c][k];
      ++at;
    };
    for (let b = 0; b < count; ++b) {
      let e = ofEvents.first[b], k = ofKnots.first[b], before = -1;
      const events = ofEvents.first[b + 1], end = ofKnots.first[b + 1];
      while (e < events || k < end) {
        const event = e < events ? ofEvents.rows[e] >> 1 : -1, knot = k < end ? ofKnots.rows[k] : -1;
        const knotFirst = event < 0 || (knot >= 0 && (n.knot_t[knot] < n.event_t[event] ||
          (n.knot_t[knot] === n.event_t[event] && n.knot_events[knot] <= event + firstEvent)));
        if (!knotFirst) {
          put(n.event_t[event], sides[ofEvents.rows[e++] & 1], event);
          continue;
        }
        put(n.knot_t[knot], knots, knot);
        // NaN: as the knot before left it
        for (let c = 3; c < 6; ++c)
          if (Number.isNaN(rows[9 * (at - 1) + c])) rows[9 * (at - 1) + c] = knots[c + 3][before];
        before = knot;
        ++k;
      }
      of[b + 1] = at;
    }
    const lastPassed = times.reduce((a, b) => Math.max(a, b), 0);
    Object.assign(this, {eventsOf: of, eventTimes: times, eventRows: rows, lastPassed});
  }

  /** [x, y, angle, vx, vy, omega] of body k at time t; where it jumps, of after. Into `out`, which it gives back. */
  body(k, t, out = new Array(6)) {
    const {frames, eventRows: rows, eventTimes, left, right} = this, {times} = frames, last = times.length - 1;
    const f = Math.max(0, lastAtOrBefore(times, t)), from = this.eventsOf[k], to = this.eventsOf[k + 1];
    let tl = times[f], tr = Infinity;
    const e = to > from ? lastAtOrBefore(eventTimes, t, from, to) : -1;
    if (e >= from && eventTimes[e] >= tl) {
      tl = eventTimes[e];
      for (let c = 0; c < 3; ++c) { left[c] = rows[9 * e + c]; left[c + 3] = rows[9 * e + c + 6]; }
    } else frames.at(f, k, left);
    const g = e >= from ? e + 1 : from;
    if (f < last) tr = times[f + 1];
    if (g < to && eventTimes[g] <= tr) {
      tr = eventTimes[g];
      for (let c = 0; c < 6; ++c) right[c] = rows[9 * g + c];
    } else if (f < last) frames.at(f + 1, k, right);
    // of a run that goes on the next state is not known yet: free flight
    if (tr === Infinity && this.gravity && t > tl) return falling(left, t - tl, this.gravity, out);
    return between(left, tl, right, tr, t, out);
  }

  /** The same of a fixed site. */
  site(k, t, out = new Array(6)) {
    const place = this.movingPlace.get(k), {siteStates, siteFirst, left, right} = this, {times} = siteStates;
    if (place === undefined) return out.fill(0);
    const from = siteFirst[place], to = siteFirst[place + 1];
    if (from === to) return out.fill(0);
    const f = Math.max(from, lastAtOrBefore(times, t, from, to)), more = f + 1 < to;
    siteStates.at(f, 0, left);
    if (more) siteStates.at(f + 1, 0, right);
    return between(left, times[f], right, more ? times[f + 1] : Infinity, t, out);
  }
}

function falling(from, s, gravity, out) {
  for (let c = 0; c < 3; ++c) {
    const g = c < 2 ? gravity[c] : 0;
    out[c] = from[c] + s * (from[c + 3] + s * g / 2);
    out[c + 3] = from[c + 3] + s * g;
  }
  return out;
}

/** The cubics from `left` at time tl to `right` at tr, and their slopes; where there is no such time, `left`. */
function between(left, tl, right, tr, t, out) {
  const s = t - tl, h = tr - tl, known = h > 0 && h < Infinity && s > 0;
  for (let c = 0; c < 3; ++c) {
    const a = left[c], va = left[c + 3];
    out[c] = a;
    out[c + 3] = va;
    if (!known) continue;
    const d = (right[c] - a) / h, c2 = (3 * d - 2 * va - right[c + 3]) / h, c3 = (va + right[c + 3] - 2 * d) / (h * h);
    out[c] = a + s * (va + s * (c2 + s * c3));
    out[c + 3] = va + s * (2 * c2 + 3 * s * c3);
  }
  return out;
}
