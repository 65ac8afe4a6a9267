'use strict';
// How finely cells are drawn: as finely as there is time for. What stands still is drawn to every pixel; what moves is coarser
// where frames come too late, and finer again where they come in time.

// By how much the two passes of the cells (cells.js) are coarser than the screen. The picture that they make is scaled up.
const DETAILS = [[1, 1], [1.5, 3], [2, 4], [3, 6], [4, 6], [5, 7], [6, 8]].map(([paint, mesh]) => ({paint, mesh}));
const BY_SOFTWARE = 4;  // begin with this one without a graphics card
const LATE = 1.25;  // of what frames may take: too much within a look
const LOOK = 8;  // frames
const IN_TIME = 1.01;  // of what frames may take: more is too much within a stretch
const STRETCH = 96;  // frames
const SOON = 24;  // frames in time before it is made finer
const SPARE = 1 / 3;  // of a frame: it is made finer where drawing takes no more than that
const TRIES = 2;  // of finer ones that were too much: then no more, until it stands still
const STILL = 150;  // [ms] without a new frame: it stands still

class Pace {
  /** `bySoftware`: without a graphics card; `frame`: what a frame may take [ms]. */
  constructor(bySoftware, frame = 1000 / 60) {
    Object.assign(this, {frame, level: bySoftware ? BY_SOFTWARE : 0});
    this.forget();
  }

  /** Frames that were seen, and tries that failed. */
  forget() {
    Object.assign(this, {last: undefined, tries: TRIES, triedAt: undefined});
    this.to(this.level);
  }

  get detail() { return DETAILS[this.level]; }

  /** A frame is to be drawn at time `now` [ms] of what moves. */
  moved(now) {
    const passed = now - this.last;
    this.last = now;
    if (!(passed < STILL * 10)) return;  // the first one, or of a page that was out of sight
    for (const of of [this.look, this.stretch]) {
      ++of.frames;
      of.took += passed;
    }
    const over = of => of.took / (of.frames * this.frame);
    if (this.look.frames === LOOK) {
      if (over(this.look) > LATE) return this.coarser();
      this.look = {frames: 0, took: 0};
    }
    const {frames, drawing, took} = this.stretch, inTime = over(this.stretch) <= IN_TIME;
    if (frames >= SOON && inTime && drawing <= SPARE * took && this.level > 0 && this.tries > 0) this.finer();
    else if (frames === STRETCH) inTime ? this.to(this.level) : this.coarser();
  }

  /** That frame took so long to draw [ms]. */
  drew(time) { this.stretch.drawing += time; }

  coarser() {
    if (this.triedAt === this.level) --this.tries;
    this.to(Math.min(this.level + 1, DETAILS.length - 1));
  }

  finer() {
    this.to(this.level - 1);
    this.triedAt = this.level;
  }

  to(level) {
    this.level = level;
    this.look = {frames: 0, took: 0};
    this.stretch = {frames: 0, took: 0, drawing: 0};
  }

  /** True once nothing has moved for a while: then all is to be drawn to the pixel. */
  still(now) { return this.last === undefined || now - this.last >= STILL; }
}
