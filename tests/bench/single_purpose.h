#pragma once
/// A minimal event loop for equal elastic discs in a box, and nothing else: what the general engine's rate is
/// held against. One event a disc, cells of about a diameter, lazy deletion by counters, a binary heap.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace brink::bench {

class SinglePurposeDiscs {
 public:
  struct Disc {
    double x, y, vx, vy, time;
    double next;      ///< time of its next event
    int partner;      ///< >= 0: disc; -1: cell crossing or wall, by axis
    int axis, sense;  ///< of the crossing
    unsigned count, partner_count;
    int cell_x, cell_y, cell_next, cell_previous;
  };

  SinglePurposeDiscs(double radius, double half) : radius_(radius), half_(half) {
    cells_ = std::max(1, static_cast<int>(2.0 * half / (2.0 * radius * 1.0001)));
    size_ = 2.0 * half / cells_;
    heads_.assign(static_cast<std::size_t>(cells_) * cells_, -1);
  }
  void add(double x, double y, double vx, double vy) {
    discs_.push_back({x, y, vx, vy, 0, 0, -1, 0, 0, 0, 0, 0, 0, -1, -1});
  }

  /// Runs until so many collisions between discs or with walls are done.
  void run(std::uint64_t collisions) {
    if (heap_.empty()) start();
    while (collisions_ < collisions) {
      const int k = heap_[0];
      Disc& d = discs_[k];
      const double now = d.next;
      if (d.partner < 0) {
        advance(d, now);
        cross(k, d);
        predict(k, now);
      } else if (d.partner_count != discs_[d.partner].count) {
        advance(d, now);
        predict(k, now);
      } else {
        collide(d, discs_[d.partner], now);
        const int other = d.partner;
        ++collisions_;
        predict(k, now);
        predict(other, now);
      }
    }
  }
  double energy() const {
    double e = 0.0;
    for (const Disc& d : discs_) e += 0.5 * (d.vx * d.vx + d.vy * d.vy);
    return e;
  }

 private:
  static void advance(Disc& d, double t) {
    d.x += d.vx * (t - d.time);
    d.y += d.vy * (t - d.time);
    d.time = t;
  }
  void start() {
    place_.resize(discs_.size());
    for (int k = 0; k < static_cast<int>(discs_.size()); ++k) {
      Disc& d = discs_[k];
      d.cell_x = std::clamp(static_cast<int>((d.x + half_) / size_), 0, cells_ - 1);
      d.cell_y = std::clamp(static_cast<int>((d.y + half_) / size_), 0, cells_ - 1);
      link(k);
      place_[k] = k;
      heap_.push_back(k);
      d.next = 0.0;
    }
    for (int k = 0; k < static_cast<int>(discs_.size()); ++k) predict(k, 0.0);
  }
  int& head(int x, int y) { return heads_[static_cast<std::size_t>(y) * cells_ + x]; }
  void link(int k) {
    Disc& d = discs_[k];
    int& h = head(d.cell_x, d.cell_y);
    d.cell_next = h;
    d.cell_previous = -1;
    if (h >= 0) discs_[h].cell_previous = k;
    h = k;
  }
  void unlink(int k) {
    const Disc& d = discs_[k];
    if (d.cell_next >= 0) discs_[d.cell_next].cell_previous = d.cell_previous;
    (d.cell_previous >= 0 ? discs_[d.cell_previous].cell_next : head(d.cell_x, d.cell_y)) = d.cell_next;
  }
  void cross(int k, Disc& d) {
    int& cell = d.axis == 0 ? d.cell_x : d.cell_y;
    const int to = cell + d.sense;
    if (wall_) {
      (d.axis == 0 ? d.vx : d.vy) *= -1.0;
      ++d.count;
      ++collisions_;
      return;
    }
    unlink(k);
    cell = to;
    link(k);
  }
  void collide(Disc& a, Disc& b, double now) {
    advance(a, now);
    advance(b, now);
    const double dx = a.x - b.x, dy = a.y - b.y;
    const double f = (dx * (a.vx - b.vx) + dy * (a.vy - b.vy)) / (dx * dx + dy * dy);
    a.vx -= f * dx;
    a.vy -= f * dy;
    b.vx += f * dx;
    b.vy += f * dy;
    ++a.count;
    ++b.count;
  }
  double edge_time(const Disc& d, int axis, int& sense, bool& wall) const {
    const double v = axis == 0 ? d.vx : d.vy, p = axis == 0 ? d.x : d.y;
    const int cell = axis == 0 ? d.cell_x : d.cell_y;
    sense = v > 0.0 ? 1 : -1;
    wall = cell + sense < 0 || cell + sense >= cells_;
    if (v == 0.0) return std::numeric_limits<double>::infinity();
    const double edge = wall ? sense * (half_ - radius_) : -half_ + (cell + (sense > 0)) * size_;
    return std::max(0.0, (edge - p) / v);
  }
  void predict(int k, double now) {
    Disc& d = discs_[k];
    int sense_x, sense_y;
    bool wall_x, wall_y;
    const double tx = edge_time(d, 0, sense_x, wall_x), ty = edge_time(d, 1, sense_y, wall_y);
    d.partner = -1;
    d.axis = tx <= ty ? 0 : 1;
    d.sense = d.axis == 0 ? sense_x : sense_y;
    const bool wall = d.axis == 0 ? wall_x : wall_y;
    double best = std::min(tx, ty);
    for (int y = std::max(0, d.cell_y - 1); y <= std::min(cells_ - 1, d.cell_y + 1); ++y)
      for (int x = std::max(0, d.cell_x - 1); x <= std::min(cells_ - 1, d.cell_x + 1); ++x)
        for (int j = head(x, y); j >= 0; j = discs_[j].cell_next) {
          if (j == k) continue;
          const Disc& o = discs_[j];
          const double s = now - o.time;
          const double dx = d.x - (o.x + s * o.vx), dy = d.y - (o.y + s * o.vy);
          const double wx = d.vx - o.vx, wy = d.vy - o.vy, b = dx * wx + dy * wy;
          if (b >= 0.0) continue;
          const double v2 = wx * wx + wy * wy, c = dx * dx + dy * dy - 4.0 * radius_ * radius_;
          const double q = b * b - v2 * c;
          if (q < 0.0) continue;
          const double t = std::max(0.0, c / (std::sqrt(q) - b));
          if (t < best) {
            best = t;
            d.partner = j;
            d.partner_count = o.count;
          }
        }
    d.next = now + best;
    walls_.resize(discs_.size());
    walls_[k] = wall;
    sift(k);
  }
  bool before(int a, int b) const { return discs_[a].next < discs_[b].next; }
  void sift(int k) {
    std::size_t i = place_[k];
    while (i > 0 && before(k, heap_[(i - 1) / 2])) {
      put(i, heap_[(i - 1) / 2]);
      i = (i - 1) / 2;
    }
    for (;;) {
      std::size_t c = 2 * i + 1;
      if (c >= heap_.size()) break;
      if (c + 1 < heap_.size() && before(heap_[c + 1], heap_[c])) ++c;
      if (!before(heap_[c], k)) break;
      put(i, heap_[c]);
      i = c;
    }
    put(i, k);
    wall_ = walls_[heap_[0]];
  }
  void put(std::size_t i, int k) {
    heap_[i] = k;
    place_[k] = static_cast<int>(i);
  }

  double radius_, half_, size_ = 1.0;
  int cells_ = 1;
  bool wall_ = false;
  std::uint64_t collisions_ = 0;
  std::vector<Disc> discs_;
  std::vector<int> heads_, heap_, place_;
  std::vector<char> walls_;
};

}  // namespace brink::bench
