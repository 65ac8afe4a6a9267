/// A search is branch and bound: nodes whose box is farther than the fourth best site are left out. What is
/// nearest is the distance to the core less the radius, so a node's bound is the distance to its box less the
/// largest radius below.
#include "brink/core/fields/site_tree.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "brink/core/shapes/distance.h"

namespace brink {

namespace {
constexpr std::uint32_t kLeaf = 4;
}

/// Of an arc it may be larger than core_bounds(), which is exact: here it only has to hold the core.
Box core_box(const Site& site) {
  Box box;
  box.add(site.a);
  box.add(site.b);
  if (site.kind == SiteKind::arc) {
    // A quarter turn or less lies in the triangle of its ends and the point where its end tangents meet.
    const Vec2 middle = (site.a - site.center) + (site.b - site.center);
    const double length = middle.norm();
    if (length > 0.0)
      box.add(site.center + middle * (site.arc_radius / (std::cos(0.5 * site.sweep) * length)));
  }
  return box;
}

SiteTree::SiteTree(const Outline& outline) {
  std::vector<Box> boxes;
  boxes.reserve(outline.sites.size());
  double largest = 0.0;
  for (const Site& site : outline.sites) {
    boxes.push_back(core_box(site));
    largest =
        std::max({largest, boxes.back().low.cwiseAbs().maxCoeff(), boxes.back().high.cwiseAbs().maxCoeff()});
  }
  // some roundings of the largest coordinate: what coordinates of boxes and sites may be off by
  rounding_ = 0x1.0p-49 * largest;
  order_.resize(outline.sites.size());
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.reserve(outline.sites.size() + 1);
  nodes_.emplace_back();
  if (!order_.empty()) build(outline, 0, 0, static_cast<std::uint32_t>(order_.size()), boxes);
}

/// Makes the node over `count` places of order_ from `first` on, and the tree below it. Children lie side by
/// side, after their parent.
void SiteTree::build(const Outline& outline, std::uint32_t node, std::uint32_t first, std::uint32_t count,
                     const std::vector<Box>& boxes) {
  Node made;
  Box centers;
  for (std::uint32_t i = first; i < first + count; ++i) {
    made.box.add(boxes[order_[i]]);
    centers.add(boxes[order_[i]].center());
    made.radius = std::max(made.radius, outline.sites[order_[i]].radius);
  }
  if (count <= kLeaf) {
    made.first = first;
    made.count = count;
    nodes_[node] = made;
    return;
  }
  // of the centres, by which the halves are told apart
  const int axis = centers.extent().x() >= centers.extent().y() ? 0 : 1;
  const std::uint32_t half = count / 2;
  const auto begin = order_.begin() + first;
  // Halves by number, not by place: the depth is log2 of the number of sites whatever their arrangement.
  // Ties go by index, so that the tree does not depend on the library's selection.
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    const double x = boxes[a].center()[axis], y = boxes[b].center()[axis];
    return x != y ? x < y : a < b;
  });
  made.first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node] = made;
  // Only after `made` is stored, and by index: references into nodes_ do not outlive this line.
  nodes_.resize(nodes_.size() + 2);
  build(outline, made.first, first, half, boxes);
  build(outline, made.first + 1, first + half, count - half, boxes);
}

/// Less than the computed distance less radius of every site below: the rounding of both sides is taken off.
double SiteTree::lower_bound(const Node& node, const Vec2& q) const {
  // 0 along an axis in whose range of the box q lies
  const Vec2 away = (node.box.low - q).cwiseMax(q - node.box.high).cwiseMax(Vec2::Zero());
  const double distance = away.norm();
  return distance * (1.0 - 0x1.0p-46) - node.radius - rounding_;
}

/// The best kListed + 1 sites so far, in order.
struct SiteTree::Search {
  struct Found {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t site = 0xffffffffU;
    bool operator<(const Found& other) const {
      return distance != other.distance ? distance < other.distance : site < other.site;
    }
  };
  std::array<Found, kListed + 1> best;

  double limit() const { return best.back().distance; }
  void offer(const Found& found) {
    // insertion into four sorted entries; kListed + 1, as the last of them bounds all others
    if (!(found < best.back())) return;
    std::size_t i = best.size() - 1;
    for (; i > 0 && found < best[i - 1]; --i) best[i] = best[i - 1];
    best[i] = found;
  }
};

/// Depth first, nearer child first. The order of visits changes the cost alone: found sites are kept by distance
/// and index.
double SiteTree::nearest(const Outline& outline, const Vec2& q, std::vector<std::uint32_t>& sites) const {
  Search search;
  struct Open {
    std::uint32_t node;
    double bound;
  };
  std::array<Open, 64> stack{};  // depth: log2 of the number of sites, one sibling a level
  std::size_t open = 0;
  stack[open++] = {0, lower_bound(nodes_[0], q)};
  while (open > 0) {
    const Open top = stack[--open];
    // not >=: a site as far as the last entry, with a lower index, takes its place
    if (top.bound > search.limit()) continue;
    const Node& node = nodes_[top.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Site& site = outline.sites[order_[i]];
        search.offer({nearest_on(site, q).distance - site.radius, order_[i]});
      }
      continue;
    }
    if (node.first == 0) continue;  // an outline without sites
    Open near{node.first, lower_bound(nodes_[node.first], q)};
    Open far{node.first + 1, lower_bound(nodes_[node.first + 1], q)};
    if (far.bound < near.bound) std::swap(near, far);
    // the nearer child on top: the sooner the limit falls, the more is left out
    stack[open++] = far;
    stack[open++] = near;
  }
  sites.clear();
  for (int i = 0; i < kListed && search.best[static_cast<std::size_t>(i)].site != 0xffffffffU; ++i) {
    sites.push_back(search.best[static_cast<std::size_t>(i)].site);
  }
  // infinite while fewer than kListed + 1 sites exist
  // Rounding of a listed distance is about the last place; the caller's bound must hold for exact distances.
  return search.limit() * (1.0 - 0x1.0p-46) - rounding_;
}

}  // namespace brink
