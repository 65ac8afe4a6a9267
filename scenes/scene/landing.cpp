/// A fall is computed and not stepped: cast_outline() says how far each copy can go to each ground, and
/// the least of these ways is the fall. What is left is rounding: the fall is done twice, and after
/// each the copies are backed up until no gap is too small.
#include "brink/scenes/scene/landing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/core/query/cast_outline.h"
#include "brink/core/query/outline_gap.h"

namespace brink {

namespace {

// Doublings of one rounding: the last step is 2^59 epsilon, 128 times the place itself.
constexpr int kTries = 60;               // each twice as far as the one before
constexpr double kMostPeriods = 1000.0;  // on the way of what falls across images
constexpr double kNear = 1e-6;           // of a copy's radius: what touches, and what all but does

/// Step by which a place is moved at least: a rounding of its coordinates, or of the shape's where it
/// stands at the origin.
double rounding_at(const Vec2& place, const Outline& outline) {
  return std::numeric_limits<double>::epsilon() *
         std::max(place.lpNorm<Eigen::Infinity>(), 0.25 * outline.bounding_radius);
}

/// A copy and a ground, or an image of one, that may meet.
struct CopyAndGround {
  std::size_t copy = 0;
  Obstacle ground;
};

/// One landing: the copies stay as they are to each other, and only their common position changes.
class Descent {
 public:
  explicit Descent(const LandingAsk& ask) : ask_(ask) {}

  Landing land() {
    Vec2 position = ask_.position;
    // The first fall is told to a rounding of its length, which may be 1e6 sizes; the second one starts
    // beside the ground, where distances are small.
    for (int time = 0; time < 2; ++time) {
      const Landing::Status status = fall(position);
      if (status != Landing::Status::lands) return {status, position};
      back_up(position);
    }
    return {Landing::Status::lands, position};
  }

 private:
  /// Moves `position` by the least way of any copy to any ground, and keeps in `touched_` who touches
  /// there.
  Landing::Status fall(Vec2& position) {
    const std::vector<Pose> copies = ask_.copies(position, kAllCopies);
    double least = std::numeric_limits<double>::infinity();
    std::vector<std::pair<double, CopyAndGround>> found;
    bool overlaps = false;
    for (std::size_t k = 0; k < copies.size(); ++k)
      for_grounds(copies[k].position, [&](const Obstacle& ground) {
        const OutlineHit hit =
            cast_outline(*ask_.outline, copies[k], ask_.direction, *ground.outline, ground.pose);
        overlaps = overlaps || hit.status == OutlineHit::Status::overlaps;
        // What passes has no distance.
        if (hit.status != OutlineHit::Status::touches) return;
        least = std::min(least, hit.distance);
        found.push_back({hit.distance, {k, ground}});
      });
    // One copy that overlaps is a fault, though others would land.
    if (overlaps) return Landing::Status::overlaps;
    if (!std::isfinite(least)) return Landing::Status::never;
    touched_.clear();
    // Those that all but touch as well: after the roundings of the move one of them may have the least gap.
    for (const auto& [distance, pair] : found)
      if (distance <= least + kNear * ask_.outline->bounding_radius) touched_.push_back(pair);
    // The sum rounds: the gap comes out a rounding too large or too small, which back_up() sees to.
    position += least * ask_.direction;
    return Landing::Status::lands;
  }

  /// visit(ground) for what a copy may meet on its way.
  template <class Visit>
  void for_grounds(const Vec2& from, Visit&& visit) const {
    const double own = ask_.outline->bounding_radius;
    for (const Obstacle& ground : ask_.grounds) {
      // Discs first: most copies fall past most grounds, and cast_outline() is dear.
      const double reach = own + ground.outline->bounding_radius;
      const auto look = [&](const Obstacle& there) {
        const Vec2 to = there.pose.position - from;
        // The strip that the copy's disc sweeps, and everything ahead of it. A container is solid
        // outside its disc, so its disc says nothing.
        const bool beside = std::abs(cross(ask_.direction, to)) > reach * (1.0 + kNear);
        const bool behind = ask_.direction.dot(to) < -reach;
        if (there.outline->container || (!beside && !behind)) visit(there);
      };
      if (!ask_.periods.any()) {
        look(ground);
        continue;
      }
      // Periods::overlaps() wants boxes: of the way, and of the ground's disc.
      Box around;
      around.add(ground.pose.position);
      ask_.periods.overlaps(way_of(from, own), around.grown(ground.outline->bounding_radius),
                            [&](const Image& image) {
                              Obstacle there = ground;
                              there.pose.position += ask_.periods.shift(image);
                              look(there);
                            });
    }
  }

  /// A box about the way, as far as images are looked at.
  /// It holds the way of the copy's whole disc.
  Box way_of(const Vec2& from, double radius) const {
    // No coordinate of a scene is larger (kLargest, toml/codec.h). In a plane that repeats the way is
    // cut at kMostPeriods, since every image along it is looked at.
    Vec2 way = 1e15 * ask_.direction;
    for (int axis = 0; axis < 2; ++axis)
      if (const double size = ask_.periods.size[axis]; size > 0.0 && ask_.direction[axis] != 0.0)
        way = std::min(way.norm(), kMostPeriods * size) * ask_.direction;
    Box box;
    box.add(from);
    box.add(from + way);
    return box.grown(radius);
  }

  /// Beyond what it should be.
  /// The least gap of those that touch, less gap_of_touching() [m]; below 0 somebody is too near.
  double least_gap(const Vec2& position) const {
    // a place depends on those of the copies before it alone
    std::size_t last = 0;
    for (const CopyAndGround& m : touched_) last = std::max(last, m.copy);
    const std::vector<Pose> copies = ask_.copies(position, last + 1);
    double least = std::numeric_limits<double>::infinity();
    for (const CopyAndGround& m : touched_)
      least =
          std::min(least, outline_gap(*ask_.outline, copies[m.copy], *m.ground.outline, m.ground.pose).gap -
                              gap_of_touching({ask_.outline, copies[m.copy]}, m.ground, ask_.thin));
    return least;
  }

  /// Backs up along the way, by a rounding first and then by ever more, until no gap is too small.
  void back_up(Vec2& position) const {
    // Doubled from the first place and not from the last, so that the way back is one step and no sum.
    double step = rounding_at(position, *ask_.outline);
    const Vec2 from = position;
    for (int time = 0; time < kTries && least_gap(position) < 0.0; ++time, step *= 2.0)
      position = from - step * ask_.direction;
  }

  const LandingAsk& ask_;
  // Of the last fall; least_gap() asks these alone, not all grounds.
  std::vector<CopyAndGround> touched_;
};

/// Coordinates of what is turned have roundings of their own, of which another way of asking knows others.
constexpr double kTurnedRounding = 2.0 * std::numeric_limits<double>::epsilon();

bool is_upright(const Pose& pose) { return pose.angle == 0.0; }

/// A wire on which nobody could tell one side from the other.
bool is_thin(const Outline& outline) { return !outline.solid && outline.sites[0].radius == 0.0; }

/// It has a corner without rounding, or an end of a wire without thickness.
bool is_sharp(const Outline& outline) {
  return std::any_of(outline.samples.begin(), outline.samples.end(),
                     [](const Sample& sample) { return sample.radius == 0.0; });
}

}  // namespace

double gap_of_touching(const Obstacle& a, const Obstacle& b, double thin) {
  // Either way round: corners of one on the wire of the other.
  const bool on_wire =
      (is_thin(*a.outline) && is_sharp(*b.outline)) || (is_thin(*b.outline) && is_sharp(*a.outline));
  if (on_wire) return thin;
  if (is_upright(a.pose) && is_upright(b.pose)) return 0.0;
  // Only the part of b that is near a has roundings that matter: a floor may be 1e6 m long.
  const double apart = (a.pose.position - b.pose.position).norm() + a.outline->bounding_radius;
  return kTurnedRounding * (a.outline->bounding_radius + std::min(apart, b.outline->bounding_radius));
}

const CopyGaps::Gap& CopyGaps::between(const Pose& pose, const Pose& other) {
  const Vec2 way = other.position - pose.position;
  const auto [at, is_new] = known_.try_emplace({way.x(), way.y()});
  if (is_new) {
    // about the origin: the places themselves would not be of the offset alone
    const OutlineGap is = outline_gap(outline_, {Vec2::Zero(), pose.angle}, outline_, {way, pose.angle});
    at->second = {is.gap, is.normal};
  }
  return at->second;
}

void push_apart(const Outline& outline, Pose& pose, const std::vector<Touched>& touched, double thin,
                CopyGaps& gaps) {
  // First along what the caller takes for the way out, which keeps rows straight; where that does not
  // help, along the normals of the gaps.
  const Pose written = pose;
  for (const bool along_normals :
       {false, true}) {  // shapes that hook into each other have to give way otherwise
    pose = written;
    double step = rounding_at(pose.position, outline);
    for (int time = 0; time < kTries; ++time) {
      // Always out of the deepest; that may lead into another by a rounding, so the least step grows.
      // @post of the loop: no gap is below what it should be, or kTries steps have not been enough;
      // then the place is left where they led.
      double worst = 0.0;
      Vec2 away = Vec2::Zero();
      for (const Touched& t : touched) {
        const CopyGaps::Gap& is = gaps.between(pose, t.other.pose);
        const double beyond = is.gap - gap_of_touching({&outline, pose}, t.other, thin);
        if (beyond >= worst) continue;
        worst = beyond;
        away = along_normals ? is.normal : t.away;
      }
      if (worst >= 0.0) return;
      pose.position += std::max(step, -worst) * away;
      if (time % 4 == 3) step *= 2.0;
    }
  }
}

Landing land(const LandingAsk& ask) { return Descent(ask).land(); }

}  // namespace brink
