#include "brink/scheduler/classic/classic_rebound.h"

#include <algorithm>
#include <map>

#include "brink/scheduler/policies/steps.h"

namespace brink {

namespace {

/// Turns of each contact of a moment: a box that lands askew settles in a few.
constexpr std::size_t kTurns = 8;
/// Slower than this, of the fastest approach of the moment, a contact is done.
constexpr double kSettled = 1e-9;

/// As the bodies move at the kernel's present time [m/s].
double closing_now(const KernelView& kernel, const DepthContact& c) {
  const double t = kernel.time();
  const auto velocity = [&](const BodyState& s) { return s.twist.at(c.contact.point - s.pose.position); };
  const Vec2 other = c.pair.with_site() ? velocity(kernel.site_motion(c.pair.other_site).state(t))
                                        : velocity(kernel.state(c.pair.other_body, t));
  return -(velocity(kernel.state(c.pair.body, t)) - other).dot(c.contact.normal);
}

/// Whose particles touch which site of whom.
using Patch = std::tuple<PairKey, bool, int>;
Patch patch_of(const DepthContact& c) { return {c.pair, c.contact.sample_on_a, c.contact.site}; }

/// The approaching contacts of every patch, joined: mean place and normal, least gap, the first one's sample.
std::vector<DepthContact> approaching_patches(const KernelView& kernel,
                                              const std::vector<DepthContact>& contacts, double slowest) {
  struct Sum {
    DepthContact joined;
    int count = 0;
  };
  std::map<Patch, Sum> patches;
  for (const DepthContact& c : contacts) {
    // by the velocities of now: what was seen as approaching may have been turned by the last rebound
    if (!(closing_now(kernel, c) > slowest)) continue;
    Sum& sum = patches[patch_of(c)];
    FeatureContact& joined = sum.joined.contact;
    if (++sum.count == 1) {
      sum.joined = c;
    } else {
      joined.point += c.contact.point;
      joined.normal += c.contact.normal;
      joined.gap = std::min(joined.gap, c.contact.gap);
    }
  }
  std::vector<DepthContact> all;
  for (auto& [patch, sum] : patches) {
    FeatureContact& joined = sum.joined.contact;
    joined.point /= sum.count;
    joined.normal.normalize();
    joined.closing_speed = closing_now(kernel, sum.joined);
    joined.time = kernel.time();
    if (joined.closing_speed > slowest) all.push_back(sum.joined);
  }
  return all;
}

/// Of patches in the order of their keys; an order that names none takes the first. @pre not empty.
const DepthContact& first_by_order(Kernel& kernel, const std::vector<DepthContact>& all) {
  const Order order = kernel.order();
  const auto least = [&](auto key) -> const DepthContact& {
    return *std::min_element(all.begin(), all.end(), [&](const DepthContact& a, const DepthContact& b) {
      return key(a.contact) < key(b.contact);
    });
  };
  if (order == Order::closing_speed) return least([](const FeatureContact& c) { return -c.closing_speed; });
  if (order == Order::depth) return least([](const FeatureContact& c) { return c.gap; });
  return order == Order::random ? all[kernel.draw(all.size())] : all.front();
}

}  // namespace

bool any_approaches(const DepthSight& sight) {
  return std::any_of(sight.contacts.begin(), sight.contacts.end(),
                     [](const DepthContact& c) { return c.contact.closing_speed > 0.0; });
}

bool resolve_all(Kernel& kernel, const std::vector<DepthContact>& contacts) {
  double fastest = 0.0;
  for (const DepthContact& c : contacts) fastest = std::max(fastest, c.contact.closing_speed);
  std::vector<int> changed;
  for (std::size_t turn = 0; turn < kTurns * contacts.size(); ++turn) {
    // Each turn anew: the last rebound may have made others part, or approach.
    const std::vector<DepthContact> all = approaching_patches(kernel, contacts, kSettled * fastest);
    if (all.empty()) return true;
    const DepthContact& next = first_by_order(kernel, all);
    if (!kernel.resolve(next.pair, next.contact, changed)) return false;
  }
  return true;
}

void push_all_apart(Kernel& kernel, const std::vector<DepthOverlap>& overlaps) {
  for (const DepthOverlap& overlap : overlaps)
    push_apart(kernel, overlap.pair, overlap.depth * overlap.normal);
}

}  // namespace brink
