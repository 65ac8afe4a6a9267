'use strict';
// The page: time that runs, controls, the timeline under the scene, and window.brink for programs.

const byId = id => document.getElementById(id);
const darkness = matchMedia('(prefers-color-scheme: dark)');
const inkOf = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const LANE = 11;  // height of a body's lane [px]
const MOST_LANES = 200;  // of the bodies with most events
const TOLD = 100;  // [ms] between times that are written out, where frames come too late
let about = JSON.parse(byId('about').textContent);

class Player {
  constructor(numbers) {
    this.n = numbers;
    this.motions = new Motions(about, numbers);
    this.picture = new Picture(byId('stage'), this.motions, about, numbers);
    this.t = this.motions.begin;
    this.playing = false;
    this.pace = new Pace(this.picture.cells.bySoftware);
    this.makeControls();
    this.makeTables();
    this.makeTimeline();
    this.listen();
    this.setSpeed(this.naturalSpeed());
    this.seek(this.t);
    byId('loading').hidden = true;
    requestAnimationFrame(now => this.tick(now));
  }

  // -- a run that goes on --
  /** New data: the page stays at its time, or with the run if it was at its end. */
  take(newer, numbers) {
    about = newer;
    const withRun = this.t >= this.end, {picture} = this;
    this.n = numbers;
    this.motions = new Motions(about, numbers);
    Object.assign(picture, {motions: this.motions, about, n: numbers});
    Object.assign(byId('scrub'), {min: this.begin, max: this.end});
    if (!this.moved) picture.fit();
    if (!this.speedChosen) this.setSpeed(this.naturalSpeed());
    this.showFacts();
    if (!byId('quantity').hidden) this.makeChart(Number(byId('quantity').value));
    this.drawLanes();
    this.seek(withRun ? this.end : this.t);
  }
  async follow() {
    if (!about.live) return;
    byId('live').hidden = false;
    const ask = async what => {
      await fetch(what, {method: 'POST', headers: {'X-Brink': 'page'}}).catch(() => null);
      this.waits = what !== 'go';  // after a step, too
      this.showFacts();
    };
    byId('live-pause').onclick = () => ask('pause');
    byId('live-step').onclick = () => ask('step');
    byId('live-go').onclick = () => ask('go');
    this.seek(this.end);
    while (about.live) {
      await new Promise(resolve => setTimeout(resolve, 500));
      // null: nobody answers, or not to the end; undefined: there is nothing new yet
      const answer = await fetch('data').then(a => a.ok ? a.json() : undefined).catch(() => null);
      if (answer === null) { byId('ending').textContent += ' (the run is gone)'; break; }
      if (!answer) continue;
      const {about: newer, numbers} = answer;
      this.take(newer, await inflated(numbers, newer.arrays));
    }
    byId('live').hidden = true;
  }

  get begin() { return this.motions.begin; }
  get end() { return this.motions.end; }

  /** The whole run in a quarter of a minute, if it is shorter or longer than that by much. */
  naturalSpeed() {
    const length = this.end - this.begin;
    return length > 0 && (length < 2 || length > 60) ? length / 15 : 1;
  }

  // -- time --
  /** To the time, or the nearer end of the run; what is no number leads nowhere. */
  seek(t) {
    if (!Number.isFinite(t)) return;
    this.t = Math.min(Math.max(t, this.begin), this.end);
    this.stale = true;
  }
  play() {
    if (this.t >= this.end) this.seek(this.begin);
    this.playing = true;
    this.last = undefined;
    byId('play').textContent = 'Pause';
  }
  pause() {
    this.playing = false;
    byId('play').textContent = 'Play';
    this.stale = true;
  }
  setSpeed(speed) {
    this.speed = speed;
    byId('speed').value = Math.log10(speed);
    byId('speed-told').textContent = `× ${Number(speed.toPrecision(3))}`;
  }
  faster(by) {
    this.speedChosen = true;
    this.setSpeed(Math.min(Math.max(this.speed * by, 1e-6), 1e3));
  }
  /** To the next event (1) or the one before (-1). */
  step(way) {
    this.pause();
    const times = this.n.event_t;
    let k = lastAtOrBefore(times, this.t);
    if (way > 0) ++k;
    else while (k >= 0 && times[k] >= this.t) --k;
    if (k >= 0 && k < times.length) this.toEvent(k);
    else this.seek(way > 0 ? this.end : this.begin);
  }
  toEvent(k) {
    this.pause();
    this.select(this.n.event_body[k]);
    this.seek(this.n.event_t[k]);
  }

  tick(now) {
    if (this.playing) {
      const passed = this.last === undefined ? 0 : Math.min(0.1, (now - this.last) / 1000);
      let t = this.t + passed * this.speed;
      if (t >= this.end) {
        if (byId('loop').checked) t = this.begin;
        else this.pause();
      }
      this.seek(t);
    }
    this.last = now;
    if (this.stale) {
      const begun = performance.now();
      this.pace.moved(now);
      this.show(now);
      this.pace.drew(performance.now() - begun);
    } else if (this.pace.still(now) && this.pace.last !== undefined) {
      this.pace.forget();
      if (this.picture.detail !== DETAILS[0]) this.show(now);
    }
    requestAnimationFrame(later => this.tick(later));
  }

  show(now) {
    this.stale = false;
    this.picture.detail = this.pace.last === undefined ? DETAILS[0] : this.pace.detail;
    // what happened in the last fifth of a second on the screen
    this.picture.flash = this.playing ? 0.2 * this.speed : 1e-12 * Math.max(1, this.t);
    if (byId('follow').checked && this.picture.selected >= 0) {
      const pose = this.motions.body(this.picture.selected, this.t), [u, v] = this.picture.offsets(pose)[0];
      Object.assign(this.picture.view, {x: pose[0] + u, y: pose[1] + v});
    }
    this.picture.draw(this.t);
    if (this.playing && this.pace.level > 0 && now - (this.told || 0) < TOLD) return;
    this.told = now;
    this.placeCursor();  // looks at the layout, which what follows changes
    if (document.activeElement !== byId('time')) byId('time').value = String(this.t);
    byId('printed-time').textContent = `t = ${this.t} s`;    // the box is not on paper
    byId('scrub').value = this.t;
    if (this.playing && now - (this.tablesShown || 0) < 250) return;
    this.tablesShown = now;
    this.showState();
    this.showEvents();
  }

  // -- controls --
  makeControls() {
    byId('title').textContent = document.title = printable(about.title);
    const layers = byId('layers');
    for (const [key, words] of LAYERS) {
      const label = document.createElement('label'), box = document.createElement('input');
      box.type = 'checkbox';
      box.checked = this.picture.layers[key];
      box.onchange = () => { this.picture.layers[key] = box.checked; this.stale = true; };
      label.append(box, ' ' + words);
      layers.append(label);
    }
    option(byId('who'), '', 'no body');
    about.bodies.forEach((b, k) => option(byId('who'), k, b.name));
    option(byId('kind'), '', 'all kinds');
    for (const kind of about.kinds) option(byId('kind'), kind, kind);
    Object.assign(byId('scrub'), {min: this.begin, max: this.end});
    byId('play').onclick = () => this.playing ? this.pause() : this.play();
    byId('previous').onclick = () => this.step(-1);
    byId('next').onclick = () => this.step(1);
    byId('speed').oninput = e => { this.speedChosen = true; this.setSpeed(10 ** Number(e.target.value)); };
    byId('time').onchange = e => {
      const t = Number(e.target.value);
      if (Number.isFinite(t)) this.seek(t);
      e.target.blur();
    };
    byId('scrub').oninput = e => { this.pause(); this.seek(Number(e.target.value)); };
    byId('who').onchange = e => this.select(e.target.value === '' ? -1 : Number(e.target.value));
    byId('follow').onchange = byId('kind').onchange = byId('of-selected').onchange = () => { this.stale = true; };
    byId('panel-button').onclick = () => this.togglePanel();
    byId('panel').hidden = matchMedia('(max-width: 700px)').matches;  // there the scene needs the room
  }

  togglePanel() {
    byId('panel').hidden = !byId('panel').hidden;
    this.resized();
  }

  select(k) {
    this.picture.selected = k;
    byId('who').value = k < 0 ? '' : k;
    const lane = this.lanes.indexOf(k), box = byId('lane-box');
    if (lane >= 0) box.scrollTop = Math.max(Math.min(box.scrollTop, lane * LANE), (lane + 1) * LANE - box.clientHeight);
    this.stale = true;
  }

  // -- tables --
  makeTables() {
    this.showFacts();
    fillTable(byId('keys'), [['space', 'play, pause'], [', .', 'event before, next event'], ['← →', 'a hundredth of the run'],
      ['+ −', 'faster, slower'], ['0', 'see all'], ['f', 'follow the selected body'], ['c', 'cells'], ['i', 'panel'],
      ['drag, wheel', 'move, zoom'], ['click', 'select a body']]);
  }

  /** What is said of the run as a whole. */
  showFacts() {
    const ending = about.live && this.waits ? about.termination.replace('running', 'paused') : about.termination;
    byId('ending').textContent = printable(ending);
    Object.assign(byId('notice'), {textContent: printable(about.notice), hidden: !about.notice});
    fillTable(byId('run'), about.facts);
  }

  showState() {
    const table = byId('state'), k = this.picture.selected;
    if (k < 0) { table.replaceChildren(); return; }
    const [x, y, angle, vx, vy, omega] = this.motions.body(k, this.t), body = about.bodies[k];
    fillTable(table, [['mass', `${body.mass} kg`], ['x', `${x} m`], ['y', `${y} m`], ['angle', `${angle} rad`], ['vx', `${vx} m/s`],
      ['vy', `${vy} m/s`], ['omega', `${omega} rad/s`]]);
  }

  /** Events around the present time. */
  showEvents() {
    const {n} = this, kind = byId('kind').value, of = byId('of-selected').checked ? this.picture.selected : -1;
    const wanted = k => (!kind || about.kinds[n.event_kind[k]] === kind) &&
      (of < 0 || n.event_body[k] === of || n.event_other[k] === of);
    const now = lastAtOrBefore(n.event_t, this.t), before = [], after = [], limit = 20000;
    for (let k = now, looked = 0; k >= 0 && before.length < 8 && looked < limit; --k, ++looked) if (wanted(k)) before.unshift(k);
    for (let k = now + 1, looked = 0; k < n.event_t.length && after.length < 12 && looked < limit; ++k, ++looked) if (wanted(k)) after.push(k);
    // rows are kept and filled anew: the browser lays out no more than what has changed
    const shown = before.concat(after), table = byId('events'), {rows} = table;
    while (rows.length > shown.length) table.deleteRow(-1);
    while (rows.length < shown.length) this.insertEventRow(table);
    shown.forEach((k, i) => {
      const row = rows[i], [time, kindCell, who] = row.cells;
      row.event = k;
      setTo(row, 'className', k === before[before.length - 1] ? 'now' : '');
      setTo(time, 'textContent', String(Number(n.event_t[k].toPrecision(9))));
      setTo(time, 'title', String(n.event_t[k]));
      setTo(kindCell, 'textContent', about.kinds[n.event_kind[k]]);
      const names = [nameOf(n.event_body[k]), n.event_other[k] >= 0 ? nameOf(n.event_other[k]) : siteName(n.event_site[k])]
        .filter(s => s).map(printable).join(' on ');
      setTo(who, 'textContent', names);
      setTo(who, 'title', names);
    });
  }

  insertEventRow(table) {
    const row = table.insertRow();
    for (let i = 0; i < 3; ++i) row.insertCell();
    row.onclick = () => this.toEvent(row.event);
  }

  // -- the timeline --
  makeTimeline() {
    const select = byId('quantity');
    if (window.Dygraph && about.curves.length) {
      about.curves.forEach((c, i) => option(select, i, `${c.title} [${c.unit}]`));
      select.onchange = () => this.makeChart(Number(select.value));
      this.makeChart(0);
    } else {
      select.hidden = true;
      byId('chart').classList.add('empty');
    }
    this.drawLanes();
  }

  makeChart(which) {
    const curve = about.curves[which], {n} = this, rows = [];
    for (let i = 0; i < n.curve_t.length; ++i) rows.push([n.curve_t[i], ...curve.columns.map(c => n[c][i])]);
    if (this.chart) this.chart.destroy();
    if (!rows.length) return;
    const dashes = [null, [7, 3], [2, 3], [9, 3, 2, 3]];
    this.chart = new Dygraph(byId('chart'), rows, {
      labels: ['t [s]', ...curve.names], legend: 'always', dateWindow: [this.begin, this.end],
      colors: darkness.matches ? ['#56b4e9', '#e69f00', '#00c08b', '#e0a0c4'] : ['#0072b2', '#d55e00', '#009e73', '#cc79a7'],
      digitsAfterDecimal: 6, sigFigs: 6, stepPlot: curve.steps, labelsDiv: byId('legend'),
      series: Object.fromEntries(curve.names.map((name, i) => [name, {strokePattern: dashes[i % 4], strokeWidth: 1.5}])),
      axes: {y: {axisLabelWidth: 64, axisLabelFormatter: short, pixelsPerLabel: 22}, x: {axisLabelFormatter: short}},
      valueRange: roomy(rows), rightGap: 0, interactionModel: {},
    });
  }

  /** A row a body (of those with most events), a tick an event. */
  drawLanes() {
    const {n} = this, canvas = byId('lanes'), ratio = window.devicePixelRatio || 1, counts = new Map();
    for (let k = 0; k < n.event_t.length; ++k)
      for (const b of [n.event_body[k], n.event_other[k]]) if (b >= 0) counts.set(b, (counts.get(b) || 0) + 1);
    for (const b of n.trace_body || []) counts.set(b, (counts.get(b) || 0) + 1e-6);
    this.lanes = [...counts].sort((a, b) => b[1] - a[1]).slice(0, MOST_LANES).map(([b]) => b).sort((a, b) => a - b);
    const height = LANE, rows = this.lanes.length;
    canvas.style.height = `${rows * height}px`;
    canvas.hidden = rows === 0;
    if (!rows) return;
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = rows * height * ratio;
    const ctx = canvas.getContext('2d'), at = this.acrossOf(canvas);
    const place = new Map(this.lanes.map((b, i) => [b, i]));
    ctx.font = `${9 * ratio}px sans-serif`;
    this.lanes.forEach((b, i) => {
      ctx.fillStyle = inkOf('--faint');
      ctx.fillText(printable(about.bodies[b].name), 2, (i + 0.82) * height * ratio, 62 * ratio);
      ctx.fillStyle = inkOf('--line');
      ctx.fillRect(at.left * ratio, (i + 1) * height * ratio - 1, canvas.width, 1);
    });
    this.drawTrace(ctx, at, place, height, ratio);
    for (let k = 0; k < n.event_t.length; ++k)
      for (const b of [n.event_body[k], n.event_other[k]]) {
        const i = place.get(b);
        if (i === undefined) continue;
        ctx.fillStyle = about.kinds[n.event_kind[k]] === 'collision' ? about.bodies[b].fill : '#d03030';
        ctx.fillRect((at.left + at.width * this.part(n.event_t[k])) * ratio, (i * height + 1) * ratio, Math.max(1, ratio), (height - 2) * ratio);
      }
  }

  /** What the scheduler did, where there is a trace: spans of simulated time under the events. */
  drawTrace(ctx, at, place, height, ratio) {
    const {n} = this;
    if (!n.trace_body) return;
    const inks = {advance: '#c4ccd6', pass: '#6f93c4', search: '#a9bddb', 'back up': '#e69f00', 'roll back': '#d55e00'};
    byId('lanes').title = 'events over what the scheduler did: grey advances, blue passes and searches, orange backups, red rollbacks';
    for (let k = 0; k < n.trace_body.length; ++k) {
      const i = place.get(n.trace_body[k]), kind = about.trace_kinds[n.trace_kind[k]];
      if (i === undefined) continue;
      const a = Math.min(n.trace_from[k], n.trace_to[k]), b = Math.min(this.end, Math.max(n.trace_from[k], n.trace_to[k]));
      const left = at.left + at.width * this.part(a), wide = at.width * (this.part(b) - this.part(a));
      const back = kind === 'back up' || kind === 'roll back', top = kind === 'advance' ? 5 : back ? 1 : 3;
      ctx.fillStyle = inks[kind] || '#a9bddb';
      ctx.fillRect(left * ratio, (i * height + top) * ratio, Math.max(ratio, wide * ratio), (back ? 3 : 2) * ratio);
    }
  }

  part(t) { return this.end > this.begin ? (t - this.begin) / (this.end - this.begin) : 0; }

  /** Where the times of the run lie across an element of the timeline [CSS pixels]. */
  acrossOf(element) {
    const left = 70, width = Math.max(1, element.clientWidth - left);
    return {left, width};
  }

  placeCursor() {
    const box = byId('timeline'), lanes = byId('lanes').hidden ? byId('scrub') : byId('lanes');
    const {left, width} = this.acrossOf(lanes);
    byId('cursor').style.left = `${lanes.offsetLeft + left + width * this.part(this.t)}px`;
    box.classList.toggle('playing', this.playing);
  }

  timeAt(element, clientX) {
    const box = element.getBoundingClientRect(), {left, width} = this.acrossOf(element);
    return this.begin + (this.end - this.begin) * (clientX - box.left - left) / width;
  }

  // -- pointer and keys --
  listen() {
    const {canvas} = this.picture, pointers = new Map();
    let drag = null;
    const where = e => [e.offsetX * this.picture.ratio, e.offsetY * this.picture.ratio];
    canvas.addEventListener('pointerdown', e => {
      canvas.setPointerCapture(e.pointerId);
      pointers.set(e.pointerId, where(e));
      drag = {moved: false};
    });
    canvas.addEventListener('pointermove', e => {
      if (!pointers.has(e.pointerId)) return;
      const [px, py] = pointers.get(e.pointerId), [qx, qy] = where(e), view = this.picture.view;
      if (pointers.size === 1) {
        if (Math.hypot(qx - px, qy - py) < 3 && !drag.moved) return;
        drag.moved = true;
        byId('follow').checked = false;
        this.moved = true;
        view.x -= (qx - px) / view.scale;
        view.y += (qy - py) / view.scale;
      } else {  // two fingers
        const other = [...pointers].find(([id]) => id !== e.pointerId)[1];
        this.zoom(Math.hypot(qx - other[0], qy - other[1]) / Math.hypot(px - other[0], py - other[1]), ...other);
        drag.moved = true;
      }
      pointers.set(e.pointerId, [qx, qy]);
      this.stale = true;
    });
    canvas.addEventListener('pointerup', e => {
      pointers.delete(e.pointerId);
      if (drag && !drag.moved) this.select(this.picture.bodyAt(...where(e)));
    });
    canvas.addEventListener('pointercancel', e => pointers.delete(e.pointerId));
    canvas.addEventListener('wheel', e => {
      e.preventDefault();
      this.zoom(1.0015 ** -e.deltaY, ...where(e));
    }, {passive: false});
    byId('lanes').addEventListener('click', e => this.clickLane(e));
    byId('chart').addEventListener('click', e => { this.pause(); this.seek(this.timeAt(byId('chart'), e.clientX)); });
    window.addEventListener('keydown', e => this.key(e));
    new ResizeObserver(() => this.resized()).observe(byId('stage'));
    darkness.addEventListener('change', () => this.recoloured());
    // paper is light, and knows nothing of the next frame
    window.addEventListener('beforeprint', () => { this.recoloured(); this.show(performance.now()); });
    window.addEventListener('afterprint', () => this.recoloured());
  }

  clickLane(e) {
    const b = this.lanes[Math.floor(e.offsetY / LANE)], t = this.timeAt(byId('lanes'), e.clientX), {n} = this;
    if (b === undefined) return;  // on the line below the last
    let best = -1;
    for (let k = 0; k < n.event_t.length; ++k)
      if ((n.event_body[k] === b || n.event_other[k] === b) && (best < 0 || Math.abs(n.event_t[k] - t) < Math.abs(n.event_t[best] - t))) best = k;
    // a body of which the trace alone tells has no event: the time itself is gone to
    if (best >= 0) this.toEvent(best);
    else { this.pause(); this.seek(t); }
    this.select(b);
  }

  zoom(by, px, py) {
    const view = this.picture.view, before = this.picture.toWorld(px, py);
    this.moved = true;
    view.scale *= Math.min(Math.max(by, 0.2), 5);
    const after = this.picture.toWorld(px, py);
    view.x += before[0] - after[0];
    view.y += before[1] - after[1];
    this.stale = true;
  }

  key(e) {
    if (['INPUT', 'SELECT'].includes(e.target.tagName) && e.target.type !== 'range' && e.target.type !== 'checkbox') return;
    const hundredth = (this.end - this.begin) / 100;
    const act = {
      ' ': () => this.playing ? this.pause() : this.play(), ',': () => this.step(-1), '.': () => this.step(1),
      ArrowLeft: () => this.seek(this.t - hundredth), ArrowRight: () => this.seek(this.t + hundredth),
      '+': () => this.faster(1.5), '-': () => this.faster(1 / 1.5),
      '0': () => { this.moved = false; this.picture.fit(); this.stale = true; }, i: () => this.togglePanel(),
      f: () => { byId('follow').checked = !byId('follow').checked; this.stale = true; },
      c: () => { const box = byId('layers').querySelector('input'); box.checked = !box.checked; box.onchange(); },
    }[e.key];
    if (!act || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    act();
  }

  /** Inks of the page have changed. */
  recoloured() {
    if (this.chart) this.makeChart(Number(byId('quantity').value));
    this.resized();
  }

  resized() {
    const {view, canvas} = this.picture, before = canvas.width;
    this.picture.resize(byId('stage'));
    if (this.moved) view.scale *= canvas.width / before || 1;
    else this.picture.fit();
    if (this.chart) this.chart.resize();
    this.drawLanes();
    this.stale = true;
  }
}

function short(x) { return String(Number(x.toPrecision(4))); }

/** The range of a chart's values; of what hardly changes, a thousandth of it. */
function roomy(rows) {
  let low = Infinity, high = -Infinity;
  for (const row of rows)
    for (const y of row.slice(1)) [low, high] = [Math.min(low, y), Math.max(high, y)];
  const room = Math.max(0.05 * (high - low), 1e-3 * Math.max(Math.abs(low), Math.abs(high))) || 1e-12;
  return [low - room, high + room];
}

/** Sets a property of an element if it has another value. */
function setTo(element, name, value) {
  if (element[name] !== value) element[name] = value;
}

/** A row for each name and value. */
function fillTable(table, pairs) {
  table.replaceChildren();
  for (const [name, value] of pairs) {
    const row = table.insertRow(), head = document.createElement('th');
    head.textContent = name;
    row.append(head);
    row.insertCell().textContent = printable(String(value));
  }
}

function option(select, value, words) {
  const made = document.createElement('option');
  made.value = value;
  made.textContent = printable(words);
  select.append(made);
}
function nameOf(k) { return k >= 0 ? about.bodies[k].name : ''; }
function siteName(k) { return k >= 0 ? about.sites[k].name : ''; }

/** For programs: see the contract's replay page. */
window.brink = {
  events: [],
  ready: inflated(byId('numbers').textContent, about.arrays).then(numbers => {
    const player = new Player(numbers);
    let told, toldOf;  // events, and the numbers that they are of
    const events = () => {
      const {n} = player;
      if (toldOf === n) return told;
      toldOf = n;
      return told = Array.from(n.event_t, (t, k) => ({t, kind: about.kinds[n.event_kind[k]], body: nameOf(n.event_body[k]),
        other: n.event_other[k] >= 0 ? nameOf(n.event_other[k]) : siteName(n.event_site[k])}));
    };
    const named = (k, t) => {
      const [x, y, angle, vx, vy, omega] = player.motions.body(k, t);
      return {name: about.bodies[k].name, x, y, angle, vx, vy, omega};
    };
    player.follow();
    Object.defineProperty(window.brink, 'duration', {get: () => player.end});
    Object.defineProperty(window.brink, 'events', {get: events});
    Object.assign(window.brink, {
      state: t => about.bodies.map((b, k) => named(k, t)),
      sites: t => about.sites.map((site, k) => {
        const [x, y, angle, vx, vy, omega] = player.motions.site(k, t);
        return {name: site.name, x, y, angle, vx, vy, omega};
      }),
      seek: t => player.seek(t), play: () => player.play(), pause: () => player.pause(),
      step: way => player.step(way), select: name => player.select(about.bodies.findIndex(b => b.name === name)),
      time: () => player.t, player,
    });
    return window.brink;
  }),
};
