'use strict';
// How finely cells are drawn: as finely as there is time for. What stands still is drawn to every pixel; what moves is coarser
// where frames come too late, and finer again where they come in time.

// By how much the two passes of the cells (cells.js) are coarser than the screen. The picture that they make is scaled up.
const DETAILS = [{paint: 1, mesh: 1}, {paint: 1.5, mesh: 3}, {paint: 2, mesh: 4}, {paint: 3, mesh: 6}];
const LATE = 1.25;  // of what a frame may take
const LOOKS = 8;  // frames looked at before it is made coarser
const PATIENCE = 90;  // frames in time before it is made finer; each time that this was too much, so many times as many
const MORE_PATIENCE = 8, MOST_PATIENCE = 64 * PATIENCE;
const STILL = 150;  // [ms] without a new frame: it stands still

class Pace {
  /** `frame`: what a frame may take [ms]. */
  constructor(frame = 1000 / 60) {
    Object.assign(this, {frame, level: 0, patience: PATIENCE});
    this.forget();
  }

  forget() { Object.assign(this, {last: undefined, late: 0, looked: 0, inTime: 0}); }

  get detail() { return DETAILS[this.level]; }

  /** A frame is drawn at time `now` [ms] of what moves. */
  moved(now) {
    const passed = now - this.last;
    this.last = now;
    if (!(passed < STILL * 10)) return;  // the first one, or of a page that was out of sight
    ++this.looked;
    this.late += passed;
    if (this.looked < LOOKS) return;
    const slow = this.late > LATE * this.frame * this.looked;
    this.inTime = slow ? 0 : this.inTime + this.looked;
    this.late = this.looked = 0;
    if (slow && this.level + 1 < DETAILS.length) {
      if (this.triedAt === this.level) this.patience = Math.min(MORE_PATIENCE * this.patience, MOST_PATIENCE);
      ++this.level;
    } else if (!slow && this.level > 0 && this.inTime >= this.patience) {
      this.triedAt = --this.level;
      this.inTime = 0;
    }
  }

  /** True once nothing has moved for a while: then all is to be drawn to the pixel. */
  still(now) { return this.last === undefined || now - this.last >= STILL; }
}
