#include "brink/scheduler/kernel/frame_pairs.h"

#include <algorithm>
#include <cmath>

#include "brink/core/query/gap_bound.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/kernel/tolerances.h"

namespace brink {

namespace {

/// A list is made for so many frames like the last, as long as that is no more than this part of the world's length: a
/// wider one would hold too many pairs that never come near.
constexpr double kFramesOfAList = 16.0, kReachOfLength = 0.25;
/// A gap is told up to so many ways of the last frame: more would take a look at features further away.
constexpr double kFramesOfALook = 4.0;
/// Rounding of a sum of ways and of a place, as parts of them; ways are told larger by it, gaps smaller.
constexpr double kRoundingOfWay = 1e-12, kRoundingOfPlace = 1e-15;
/// Gaps below this part of the world's length are looked at at every frame at which one of the two has moved.
constexpr double kCloseOfLength = 1e-6;
/// A gap of this part of it is one, whatever a vertex seems to lie on.
constexpr double kSurelyApartOfLength = 1e-5;

/// How far any point of an outline is at most from where it was [m].
double way_between(const Outline& outline, const Pose& p, const Pose& q) {
  const double turned = is_centred_disc(outline) ? 0.0 : std::min(2.0, std::abs(q.angle - p.angle));
  const double way = (q.position - p.position).norm() + outline.bounding_radius * turned;
  return way > 0.0 ? (1.0 + kRoundingOfWay) * way + kRoundingOfPlace * q.position.lpNorm<1>() : 0.0;
}

}  // namespace

FramePairs::FramePairs(const World& world, const Trajectories& trajectories, const ContactSearch& search,
                       const NearPairs& near, RunControl& run)
    : trajectories_(&trajectories), search_(&search), near_(&near), run_(&run), length_(world.length()) {}

void FramePairs::clear() {
  poses_.clear();
  near_pairs_.clear();
  reach_ = -1.0;
}

void FramePairs::each(double t, const Look& look) {
  if (trajectories_->owner_count() == 0) return;
  const double step = go_to(t), reach = kFramesOfAList * step;
  // who is further apart needs no look at the next frames
  const double at_most = std::min(kFramesOfALook * step, kReachOfLength * length_);
  if (reach_ < 0.0 || *std::max_element(way_.begin(), way_.end()) > 0.5 * reach_) {
    const bool begins = step == kForever;
    if (!begins && !(reach <= kReachOfLength * length_)) return each_once(look);
    list(begins ? 0.0 : reach);
  }
  for (Near& near : near_pairs_) {
    const double gone = way(near.pair);
    if (gone <= near.clear_until) continue;
    const double least = margin(near.pair);
    std::optional<double> gap = apart(near.pair, least);
    if (*gap <= least) gap = look(near.pair, *gap - rounding(near.pair), at_most);
    if (!gap) return;
    near.clear_until = gone + std::max(0.0, *gap - least);
  }
}

/// Of what moves too far for a list nothing is kept: pairs are asked as they come, and those that may overlap looked at in order.
void FramePairs::each_once(const Look& look) {
  near_pairs_.clear();
  reach_ = -1.0;
  close_.clear();
  near_->each_among(poses_, [&](const PairKey& pair) {
    const double least = margin(pair), gap = apart(pair, least);
    if (gap <= least) close_.push_back({pair, gap - rounding(pair)});
    return run_->poll();
  });
  if (run_->halt()) return;
  std::sort(close_.begin(), close_.end());
  // nothing is kept for the next frame: no more is asked than whether they are near enough to look below their edges
  const double at_most = kSurelyApartOfLength * length_;
  for (const auto& [pair, at_least] : close_)
    if (!look(pair, at_least, at_most)) return;
}

/// The largest way since the last frame; infinity: nobody knows.
double FramePairs::go_to(double t) {
  const auto owners = static_cast<std::size_t>(trajectories_->owner_count());
  const bool first = poses_.empty();
  poses_.resize(owners);
  way_.resize(owners, 0.0);
  double step = first ? kForever : 0.0;
  for (std::size_t k = 0; k < owners; ++k) {
    const Pose now = trajectories_->motion_of(static_cast<int>(k)).pose(t);
    if (!first) {
      const double way = way_between(search_->outline_of(static_cast<int>(k)), poses_[k], now);
      way_[k] += way;
      step = std::max(step, way);
    }
    poses_[k] = now;
  }
  return step;
}

/// What is known of a pair holds on: what both had gone is taken off it.
void FramePairs::list(double reach) {
  reach_ = reach;
  std::vector<Near> before = std::move(near_pairs_);
  for (Near& near : before) near.clear_until -= way(near.pair);
  std::fill(way_.begin(), way_.end(), 0.0);
  near_pairs_.clear();
  near_->each_among(
      poses_,
      [&](const PairKey& pair) {
        near_pairs_.push_back({pair});
        return run_->poll();
      },
      0.5 * reach_);
  if (run_->halt()) reach_ = -1.0;  // not all of them
  const auto by_pair = [](const Near& a, const Near& b) { return a.pair < b.pair; };
  std::sort(near_pairs_.begin(), near_pairs_.end(), by_pair);
  auto known = before.begin();
  for (Near& near : near_pairs_) {
    known = std::lower_bound(known, before.end(), near, by_pair);
    if (known == before.end()) return;
    if (!(near.pair < known->pair)) near.clear_until = known->clear_until;
  }
}

double FramePairs::way(const PairKey& pair) const {
  return way_[pair.body] + way_[search_->other_owner(pair)];
}

/// A bound below their gap [m].
double FramePairs::apart(const PairKey& pair, double enough) const {
  const int other = search_->other_owner(pair);
  Pose image = poses_[other];
  image.position += search_->shift_of(pair);
  return gap_at_least(search_->outline_of(pair.body), poses_[pair.body], search_->outline_of(other), image,
                      enough);
}

double FramePairs::margin(const PairKey& pair) const {
  return kCloseOfLength * length_ + 4.0 * rounding(pair);
}

/// Of apart(), by the poses [m].
double FramePairs::rounding(const PairKey& pair) const {
  const auto of = [&](int k) {
    return poses_[k].position.lpNorm<1>() +
           (1.0 + std::abs(poses_[k].angle)) * search_->outline_of(k).bounding_radius;
  };
  return 2.0 * kRoundingOfPlace * (of(pair.body) + of(search_->other_owner(pair)));
}

}  // namespace brink
