#include "brink/scenes/view/site_track.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "brink/integrators/motion.h"
#include "brink/scheduler/kernel/site_motion.h"

namespace brink {
namespace {

/// Of the site's size: how far cubics may be off.
constexpr double kOff = 1e-7;
/// A formula is looked at as often at least [s]: what is quicker would fall between three looks.
constexpr double kPiece = 1.0 / 64.0;
/// Halvings of a piece, at most: a velocity that jumps is wrong for no longer than the last of them.
constexpr int kHalvings = 20;

std::array<double, 6> numbers(const BodyState& s) {
  return {s.pose.position.x(),  s.pose.position.y(),  s.pose.angle,
          s.twist.velocity.x(), s.twist.velocity.y(), s.twist.omega};
}

/// Where the cubics from one state to another are at a part of the time between them, h [s].
Pose between(const BodyState& left, const BodyState& right, double h, double part) {
  const std::array<double, 6> l = numbers(left), r = numbers(right);
  std::array<double, 3> at{};
  for (int c = 0; c < 3; ++c) {
    const double slope = (r[c] - l[c]) / h, s = part * h;
    const double c2 = (3 * slope - 2 * l[c + 3] - r[c + 3]) / h,
                 c3 = (l[c + 3] + r[c + 3] - 2 * slope) / (h * h);
    at[c] = l[c] + s * (l[c + 3] + s * (c2 + s * c3));
  }
  return {{at[0], at[1]}, at[2]};
}

class Tracking {
 public:
  Tracking(const FixedSite& site, std::int64_t most)
      : motion_(site), reach_(site.outline->bounding_radius), most_(most) {}

  SiteTrack from(double begin, double end) {
    if (!reaches(begin)) return cut();
    add(begin, motion_.motion().state(begin));
    // of a long run no more pieces than a quarter of the room there is
    const double piece = motion_.is_prescribed()
                             ? std::max(kPiece, 4.0 * (end - begin) / static_cast<double>(most_))
                             : end - begin;
    for (double t = begin; t < end;) {
      const double next = std::min(end, t + piece);
      if (!(next > t) || !reaches(next)) return cut();
      if (!refine(t, track_.states.back(), next, motion_.motion().state(next), 0)) return cut();
      // in order: nobody asks for an earlier time
      motion_.forget_before(next);
      t = next;
    }
    return std::move(track_);
  }

 private:
  bool reaches(double t) { return motion_.extend(t).status == Extent::Status::reached; }
  SiteTrack cut() {
    track_.whole = false;
    return std::move(track_);
  }
  bool add(double t, const BodyState& state) {
    if (static_cast<std::int64_t>(track_.times.size()) >= most_) return false;
    track_.times.push_back(t);
    track_.states.push_back(state);
    return true;
  }

  /// Adds what it takes behind `left` up to `right`, with that. False: no room.
  bool refine(double tl, BodyState left, double tr, const BodyState& right, int halvings) {
    const double h = tr - tl, off = difference(tl, left, tr, right);
    const double middle = tl + 0.5 * h;
    if (off <= kOff * reach_ || halvings >= kHalvings || !(middle > tl && middle < tr)) {
      track_.off = std::max(track_.off, off);
      return add(tr, right);
    }
    const BodyState halfway = motion_.motion().state(middle);
    return refine(tl, left, middle, halfway, halvings + 1) &&
           refine(middle, halfway, tr, right, halvings + 1);
  }

  double difference(double tl, const BodyState& left, double tr, const BodyState& right) const {
    double most = 0.0;
    for (const double part : {0.25, 0.5, 0.75}) {
      const Pose is = motion_.motion().state(tl + part * (tr - tl)).pose,
                 shown = between(left, right, tr - tl, part);
      most =
          std::max(most, (is.position - shown.position).norm() + reach_ * std::abs(is.angle - shown.angle));
    }
    return most;
  }

  SiteMotion motion_;
  double reach_;
  std::int64_t most_;
  SiteTrack track_;
};

}  // namespace

SiteTrack track_site(const FixedSite& site, double begin, double end, std::int64_t most) {
  return Tracking(site, most).from(begin, end);
}

}  // namespace brink
