#include "brink/scheduler/kernel/near_pairs.h"

#include <fmt/core.h>

#include <algorithm>

#include "brink/core/base/error.h"
#include "brink/scheduler/broad_phase/broad_phase.h"
#include "brink/scheduler/broad_phase/tolerances.h"

namespace brink {

namespace {

constexpr double kMostPairs = 1e7;  ///< that are kept at once: 400 MB

/// The box of a still site where it stands; empty if it moves, or is everywhere.
Box still_box(const FixedSite& site, bool moves) {
  if (moves || site.outline->container) return {};
  // grown by what turning and shifting it may round
  const Box box = transformed(*site.outline, site.pose).bounds;
  return box.grown(kBoxMargin * (box.low.norm() + box.high.norm()));
}

}  // namespace

void check_all_pairs(const World& world, const SolverOptions& options) {
  const auto bodies = static_cast<double>(world.bodies.size()),
             sites = static_cast<double>(world.sites.size());
  const double pairs = bodies * (0.5 * bodies + sites);
  if (options.broad_phase || pairs <= kMostPairs) return;
  throw BadInput(
      fmt::format("solver: broad_phase = false, and {} bodies and {} sites make {:.3g} pairs; allowed "
                  "without a broad phase: up to {:.0e}",
                  bodies, sites, pairs, kMostPairs));
}

NearPairs::NearPairs(const World& world, const SolverOptions& options, const Trajectories& trajectories,
                     const ContactSearch& search, RunControl& run)
    : world_(&world),
      trajectories_(&trajectories),
      search_(&search),
      run_(&run),
      by_bounds_(options.broad_phase) {
  for (int s = 0; s < trajectories.site_count(); ++s)
    still_boxes_.push_back(still_box(world.sites[s], trajectories.site(s).moves()));
  if (options.detector == "pass") passes_ = std::make_unique<PassRenderer>(options.field, &run.work());
}

Box NearPairs::box_at(int owner, double t) const {
  const int n = trajectories_->body_count();
  return owner < n || still_boxes_[owner - n].empty()
             ? swept_box(search_->outline_of(owner), trajectories_->motion_of(owner), t, t)
             : still_boxes_[owner - n];
}

/// Moving bounds of every owner over [from, to], and the versions of the motions that they are of.
void NearPairs::box_all(double from, double to) {
  const int n = trajectories_->body_count();
  boxes_from_ = from;
  boxes_.resize(trajectories_->owner_count());
  versions_.assign(n, 0);
  for (int k = n; k < trajectories_->owner_count(); ++k) {
    const SiteMotion& site = trajectories_->site(k - n);
    // where a site stands still its box is that of every time
    boxes_[k] = site.moves() ? swept_box(search_->outline_of(k), site.motion(), from, to) : box_at(k, from);
  }
  for (int k = 0; k < n; ++k) {
    boxes_[k] = swept_box(search_->outline_of(k), trajectories_->body(k).motion, from, to);
    versions_[k] = trajectories_->body(k).version;
  }
}

/// Bounds again up to the same end, for bodies alone that are on other motions than theirs were made of.
void NearPairs::box_changed(double to, bool several_motions) {
  for (int k = 0; k < trajectories_->body_count(); ++k) {
    const BodyTrack& b = trajectories_->body(k);
    // the motion of which the box was made, for the whole horizon
    if (versions_[k] == b.version) continue;
    // in front of what is certain, bodies have several motions at a time, which begin when they begin
    const Box box = swept_box(search_->outline_of(k), b.motion, std::max(b.motion.begin(), boxes_from_), to);
    if (several_motions)
      // the motions before may come to be again: their boxes stay
      boxes_[k].add(box);
    else
      boxes_[k] = box;
    versions_[k] = b.version;
  }
}

/// Pairs of a with those images of b whose moving bounds meet its own; with the broad phase off, with b
/// whatever its bounds, but in a plane that repeats there is no end of images.
void NearPairs::add_images(int a, int b, std::vector<PairKey>& pairs) const {
  const auto add = [&](const Image& image) {
    if (!run_->poll()) return false;
    if (const auto pair = search_->pair_of(a, b, image)) pairs.push_back(*pair);
    return true;
  };
  if (!by_bounds_ && !world_->periods.any())
    add({});
  else
    // without a period that is one image, or none
    world_->periods.overlaps(boxes_[a], boxes_[b], add);
}

/// Moving bounds are made anew in any case: of() goes on from them.
std::vector<PairKey> NearPairs::all(double from, double to) {
  box_all(from, to);
  std::vector<PairKey> pairs;
  if (passes_) {
    // a pair of two bodies is seen from both, or from one of them alone
    for (int k = 0; k < trajectories_->body_count() && run_->poll(); ++k) {
      const auto seen = by_pass(k, from, to);
      pairs.insert(pairs.end(), seen.begin(), seen.end());
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  } else if (by_bounds_) {
    // ascending by owners and images, whatever the order in which boxes were met
    std::vector<ImagePair> overlapping;
    each_overlapping(boxes_, world_->periods, [&](const ImagePair& p) {
      overlapping.push_back(p);
      return run_->poll();
    });
    std::sort(overlapping.begin(), overlapping.end());
    for (const ImagePair& p : overlapping)
      if (const auto pair = search_->pair_of(p.a, p.b, p.image)) pairs.push_back(*pair);
  } else {
    for (int a = 0; a < trajectories_->body_count() && run_->poll(); ++a)
      for (int b = a + 1; b < trajectories_->owner_count(); ++b) add_images(a, b, pairs);
  }
  return pairs;
}

std::vector<PairKey> NearPairs::of(int body, double from, double to, bool several_motions) {
  if (passes_) return by_pass(body, from, to);
  box_changed(to, several_motions);
  std::vector<PairKey> pairs;
  // a look at every owner's box; pair_of() leaves out the body itself
  for (int other = 0; other < trajectories_->owner_count(); ++other) add_images(body, other, pairs);
  return pairs;
}

/// A window that holds the body's way over [from, to] is drawn at one moment, `from`. Whoever is as near to it as
/// anybody may come by `to` is one of a pair, so the answer holds for the whole time. Cost: a picture.
std::vector<PairKey> NearPairs::by_pass(int body, double from, double to) {
  std::vector<PlacedOutline> scene;
  double travel = 0.0;  // of any point of anything else before `to`
  for (int k = 0; k < trajectories_->owner_count(); ++k) {
    const Outline& outline = search_->outline_of(k);
    const Motion& motion = trajectories_->motion_of(k);
    scene.push_back({&outline, motion.pose(from), static_cast<std::uint32_t>(k)});
    if (k == body) continue;
    const MotionBounds b = motion.bounds(from, to);
    // a container's solid part is everywhere outside: what is drawn of it are its sites
    const Box& box = outline.bounds;
    const double reach =
        outline.container ? box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).norm() : outline.bounding_radius;
    // no point of it goes farther: (|v| + |omega| r) times the time
    travel = std::max(travel, (b.speed() + b.spin() * reach) * (to - from));
  }
  // where the body may be at any time of [from, to]
  const Box window = swept_box(search_->outline_of(body), trajectories_->body(body).motion, from, to);
  // others are drawn where they are at `from`; the window holds the body's own way to `to`
  const double near = travel + search_->limits().tolerance;
  std::vector<PairKey> pairs;
  for (const std::uint32_t owner :
       passes_->near_owners(window, near, scene, static_cast<std::uint32_t>(body)).owners)
    if (const auto pair = search_->pair_of(body, static_cast<int>(owner))) pairs.push_back(*pair);
  return pairs;
}

void NearPairs::each_at(double t, const std::function<bool(const PairKey&)>& visit) const {
  std::vector<Pose> poses;
  poses.reserve(trajectories_->owner_count());
  for (int k = 0; k < trajectories_->owner_count(); ++k) poses.push_back(trajectories_->motion_of(k).pose(t));
  each_among(poses, visit);
}

/// Boxes of that moment, made for this call: nothing of a horizon is needed.
void NearPairs::each_among(const std::vector<Pose>& poses, const std::function<bool(const PairKey&)>& visit,
                           double grown) const {
  const int n = trajectories_->body_count();
  std::vector<Box> now;
  now.reserve(poses.size());
  for (int k = 0; k < trajectories_->owner_count(); ++k)
    now.push_back((k < n || still_boxes_[k - n].empty()
                       ? standing_box(search_->outline_of(k), poses[k].position)
                       : still_boxes_[k - n])
                      .grown(grown));
  each_overlapping(now, world_->periods, [&](const ImagePair& p) {
    const auto pair = search_->pair_of(p.a, p.b, p.image);
    return !pair || visit(*pair);
  });
}

}  // namespace brink
