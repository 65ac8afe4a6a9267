/// The kernel's passes: who can meet whom, and when.
#include <algorithm>

#include "brink/scheduler/broad_phase/broad_phase.h"
#include "brink/scheduler/kernel/kernel.h"

namespace brink {

const Motion& Kernel::motion_of(int owner) const {
  const int n = body_count();
  return owner < n ? bodies_[owner].motion : sites_[owner - n].motion();
}

std::optional<PairKey> Kernel::pair_of(int a, int b, const Image& image) const {
  const int n = body_count();
  if (a > b) return pair_of(b, a, -image);
  if (a >= n || a == b) return std::nullopt;
  return b < n ? PairKey{a, b, -1, image} : PairKey{a, -1, b - n, image};
}

Mover Kernel::other_mover(const PairKey& pair, const BodyTrack* track) const {
  Mover other = track ? mover(pair.other_body, *track) : site_mover(pair.other_site);
  if (pair.image == Image{}) return other;
  image_motion_ = other.motion->displaced(shift_of(pair));
  other.motion = &image_motion_;
  return other;
}

ExtendedState Kernel::other_state(const PairKey& pair, double t) const {
  const ExtendedState state = motion_of(other_owner(pair)).extended_state(t);
  return pair.image == Image{} ? state : state.shifted(shift_of(pair));
}

/// Pairs whose boxes overlap, ascending.
std::vector<PairKey> Kernel::overlapping(const std::vector<Box>& boxes) const {
  std::vector<PairKey> pairs;
  for (const ImagePair& p : overlapping_pairs(boxes, world_.periods))
    if (const auto pair = pair_of(p.a, p.b, p.image)) pairs.push_back(*pair);
  return pairs;
}

Box Kernel::box_at(int k, double t) const {
  const int n = body_count();
  return k < n || still_boxes_[k - n].empty() ? swept_box(outline_of(k), motion_of(k), t, t)
                                              : still_boxes_[k - n];
}

void Kernel::refresh_boxes(double from, double to, bool all) {
  const int n = body_count();
  if (all) {
    boxes_from_ = from;
    boxes_.resize(owner_count());
    box_versions_.assign(n, 0);
    for (int k = n; k < owner_count(); ++k) {
      const SiteMotion& site = sites_[k - n];
      boxes_[k] = site.moves() ? swept_box(outline_of(k), site.motion(), from, to) : box_at(k, from);
    }
  }
  for (int k = 0; k < n; ++k) {
    if (!all && box_versions_[k] == bodies_[k].version) continue;
    // in front of what is certain, bodies have several motions at a time, which begin when they begin
    const double begin = all ? from : std::max(bodies_[k].motion.begin(), boxes_from_);
    const Box box = swept_box(outline_of(k), bodies_[k].motion, begin, to);
    if (all || ahead_.empty())
      boxes_[k] = box;
    else
      boxes_[k].add(box);
    box_versions_[k] = bodies_[k].version;
  }
}

/// Pairs of a with those images of b whose moving bounds meet its own; with the broad phase off, with b
/// whatever its bounds, but in a plane that repeats there is no end of images.
void Kernel::add_images(int a, int b, std::vector<PairKey>& pairs) const {
  const auto add = [&](const Image& image) {
    if (const auto pair = pair_of(a, b, image)) pairs.push_back(*pair);
  };
  if (!options_.skip_broad_phase && !world_.periods.any())
    add({});
  else
    world_.periods.overlaps(boxes_[a], boxes_[b], add);
}

std::vector<PairKey> Kernel::near_pairs(double from, double to) {
  ++work_.horizons;
  work_.passes += bodies_.size();
  trace_all(TraceKind::pass, from, to);
  refresh_boxes(from, to, true);
  std::vector<PairKey> pairs;
  if (passes_) {
    for (int k = 0; k < body_count() && poll(); ++k) {
      const auto seen = pairs_by_pass(k, from, to);
      pairs.insert(pairs.end(), seen.begin(), seen.end());
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  } else if (options_.skip_broad_phase) {
    pairs = overlapping(boxes_);
  } else {
    for (int a = 0; a < body_count() && poll(); ++a)
      for (int b = a + 1; b < owner_count(); ++b) add_images(a, b, pairs);
  }
  return pairs;
}

std::vector<PairKey> Kernel::near_pairs_of(int body, double from, double to) {
  ++work_.passes;
  const TraceScope scope(run_.trace, {TraceKind::pass, body, -1, from, to});
  if (passes_) return pairs_by_pass(body, from, to);
  refresh_boxes(from, to, false);
  std::vector<PairKey> pairs;
  for (int other = 0; other < owner_count(); ++other) add_images(body, other, pairs);
  return pairs;
}

std::vector<PairKey> Kernel::pairs_by_pass(int body, double from, double to) {
  std::vector<PlacedOutline> scene;
  double travel = 0.0;  // of any point of anything else before `to`
  for (int k = 0; k < owner_count(); ++k) {
    scene.push_back({&outline_of(k), motion_of(k).pose(from), static_cast<std::uint32_t>(k)});
    if (k == body) continue;
    const MotionBounds b = motion_of(k).bounds(from, to);
    const double reach =
        outline_of(k).container ? outline_of(k).bounds.extent().norm() : outline_of(k).bounding_radius;
    travel = std::max(travel, (b.speed() + b.spin() * reach) * (to - from));
  }
  const Box window = swept_box(outline_of(body), motion_of(body), from, to);
  std::vector<PairKey> pairs;
  for (const std::uint32_t owner :
       passes_->near_owners(window, travel + limits_.tolerance, scene, static_cast<std::uint32_t>(body))
           .owners)
    if (const auto pair = pair_of(body, static_cast<int>(owner))) pairs.push_back(*pair);
  return pairs;
}

const DepthSight& Kernel::look(double from, double t) {
  std::vector<OwnerMoment> owners;
  double fastest = 0.0;
  for (int k = 0; k < owner_count(); ++k) {
    const Motion& motion = motion_of(k);
    const double before = std::clamp(from, std::min(motion.begin(), t), t);
    owners.push_back({motion.state(t), motion.state(before)});
    const double reach =
        outline_of(k).container ? outline_of(k).bounds.extent().norm() : outline_of(k).bounding_radius;
    for (const Twist& twist : {owners.back().now.twist, owners.back().before.twist})
      fastest = std::max(fastest, twist.velocity.norm() + std::abs(twist.omega) * reach);
  }
  // two owners come nearer at twice the fastest speed at most; as much again for what accelerates
  return depth_->look(owners, 4.0 * fastest * std::max(t - from, options_.step));
}

std::optional<Certificate> Kernel::search(const PairKey& pair, double from, double to, int most_steps) {
  return search_between(pair, bodies_[pair.body], pair.with_site() ? nullptr : &bodies_[pair.other_body],
                        from, to, most_steps);
}

std::optional<Certificate> Kernel::search_between(const PairKey& pair, const BodyTrack& body,
                                                  const BodyTrack* other, double from, double to,
                                                  int most_steps) {
  const Mover a = mover(pair.body, body), b = other_mover(pair, other);
  // of simultaneous resolves one may be a rounding ahead
  from = std::max({from, a.motion->begin(), b.motion->begin()});
  if (from > to) return std::nullopt;
  const TraceScope scope(run_.trace, {TraceKind::search, pair.body, other_owner(pair), from, to});
  SearchLimits limits = limits_;
  if (most_steps > 0) limits.max_iterations = most_steps;
  const PairAnswer answer = first_contact(a, b, from, to, limits, scratch_, work_);
  if (answer.status == PairAnswer::Status::clear) return std::nullopt;
  Certificate c;
  c.time = answer.until;
  c.pair = pair;
  c.version_body = body.version;
  c.version_other = other ? other->version : 0;
  c.contact = answer.contact;
  ++work_.certificates_issued;
  if (answer.status == PairAnswer::Status::undecided) {
    c.kind = Certificate::Kind::undecided;
    c.why = answer.why;
    ++work_.certificates_undecided;
  } else if (watched_) {
    watched_->insert(c);
  }
  return c;
}

std::vector<Certificate> Kernel::simultaneous(const Certificate& c) {
  std::vector<Certificate> others;
  const Mover a = mover(c.pair.body, *track(c.pair.body, c.version_body));
  const Mover b =
      other_mover(c.pair, c.pair.with_site() ? nullptr : track(c.pair.other_body, c.version_other));
  const auto features = touching_features(a, b, c.time, limits_.touch, limits_, scratch_);
  for (const FeatureContact& f : features) {
    if (f.sample == c.contact.sample && f.sample_on_a == c.contact.sample_on_a) continue;
    if (f.closing_speed <= 1e-12 * c.contact.closing_speed) continue;
    others.push_back(c);
    others.back().contact = f;
  }
  return others;
}

bool Kernel::fresh(const Certificate& c) const {
  return c.version_body == certain(c.pair.body).version &&
         (c.pair.with_site() || c.version_other == certain(c.pair.other_body).version);
}

std::vector<FeatureContact> Kernel::touching(const PairKey& pair, double tolerance) {
  return touching_features(mover(pair.body), other_mover(pair), time_, tolerance, limits_, scratch_);
}

}  // namespace brink
