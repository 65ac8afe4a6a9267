#include "brink/scheduler/resolve/joint_contacts.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/resolve/tolerances.h"

namespace brink {

namespace {

/// A solid's boundary at one of its vertices.
struct Wedge {
  std::vector<Vec2> edges;    ///< unit directions away from the vertex
  std::vector<Vec2> normals;  ///< of those edges, out of the solid
};

Wedge wedge_at(const Outline& outline, const Vec2& vertex) {
  // Sites join bit for bit, and vertex samples are copies of their ends: to compare for equality finds
  // all that meet there, several corners where a union pinches.
  Wedge w;
  const auto add = [&](const Vec2& travel, double sense) {
    w.edges.push_back(sense * travel);
    w.normals.push_back(-perp(travel));
  };
  for (const Site& site : outline.sites) {
    if (site.kind == SiteKind::point) continue;
    if (site.a == vertex) add(direction_at_start(site), 1.0);
    if (site.b == vertex) add(direction_at_end(site), -1.0);
  }
  return w;
}

/// True if the line across n has the one wedge before it and the other behind.
bool parts(const Vec2& n, const Wedge& front, const Wedge& behind) {
  return std::all_of(front.edges.begin(), front.edges.end(),
                     [&](const Vec2& e) { return n.dot(e) >= -kParallel; }) &&
         std::all_of(behind.edges.begin(), behind.edges.end(),
                     [&](const Vec2& e) { return n.dot(e) <= kParallel; });
}

/// The normal, out of `behind`, that parts the wedges and is nearest to `wanted`; nothing if none does.
std::optional<Vec2> parting_normal(const Wedge& front, const Wedge& behind, const Vec2& wanted) {
  if (front.edges.empty() || behind.edges.empty()) return std::nullopt;
  if (parts(wanted, front, behind)) return wanted;
  // The directions that part the wedges make up an arc of the circle, from one edge's normal to
  // another's. If `wanted` is not on it, the nearest of it is one of its ends.
  std::optional<Vec2> best;
  const auto consider = [&](const Vec2& n) {
    if (parts(n, front, behind) && (!best || n.dot(wanted) > best->dot(wanted))) best = n;
  };
  for (const Vec2& n : behind.normals) consider(n);
  for (const Vec2& n : front.normals) consider(-n);
  return best;
}

/// A vertex of S and the sites of T around it.
class Joint {
 public:
  Joint(const Outline& a, const ExtendedState& state_a, const Outline& b, const ExtendedState& state_b,
        const FeatureContact& f, double tolerance)
      : f_(f),
        tolerance_(tolerance),
        outline_s_(f.sample_on_a ? a : b),
        outline_t_(f.sample_on_a ? b : a),
        base_(state_b.position.cast<double>()),
        s_(outline_s_, (f.sample_on_a ? state_a : state_b).seen_from(base_)),
        t_(outline_t_, (f.sample_on_a ? state_b : state_a).seen_from(base_)),
        sample_(outline_s_.samples[f.sample]),
        path_(sample_path(s_, t_, sample_.p)) {}

  std::vector<FeatureContact> contacts() {
    for (int j = 0; j < static_cast<int>(outline_t_.sites.size()); ++j) look_at(j);
    const bool interior = std::any_of(near_.begin(), near_.end(), [](const Near& n) { return !n.at_end; });
    // The sites of a corner meet at one place: it is looked at once. Of a joint that is touched on the
    // inside of a site, the other site's end, as near as that, says nothing new.
    bool corner_done = false;
    for (const Near& n : near_) {
      if (!n.at_end) {
        add(n.site, normal_at(site(n.site), n.nearest, path_.q), n.gap);
      } else if (sharp(n.site)) {
        if (!std::exchange(corner_done, true)) add_corner(n);
      } else if (!interior) {
        add(n.site, normal_at(site(n.site), n.nearest, path_.q), n.gap);
      }
    }
    return found_;
  }

 private:
  struct Near {
    int site;
    Nearest nearest;
    double gap;
    bool at_end;
  };

  const Site& site(int j) const { return outline_t_.sites[j]; }
  bool sharp(int j) const { return site(j).radius + sample_.radius == 0.0; }

  void look_at(int j) {
    const Nearest n = nearest_on(site(j), path_.q);
    const double gap = side_of(site(j), n, path_.q) * n.distance - site(j).radius - sample_.radius;
    if (j != f_.site && std::abs(gap) > tolerance_) return;
    const auto close = [&](const Vec2& end) { return (path_.q - end).norm() <= tolerance_; };
    // As near to a sharp end as the tolerance, whether the foot is on the end or beside it is rounding.
    const bool corner = sharp(j) && site(j).solid && (close(site(j).a) || close(site(j).b));
    near_.push_back({j, n, gap, corner || n.foot != Foot::interior || site(j).kind == SiteKind::point});
  }

  void add_corner(const Near& n) {
    const Site& edge = site(n.site);
    const Vec2 vertex = (path_.q - edge.a).norm() <= (path_.q - edge.b).norm() ? edge.a : edge.b;
    const Vec2 out = f_.sample_on_a ? f_.normal : Vec2(-f_.normal);
    const Vec2 wanted = t_.frame.direction_to_local(out);
    std::optional<Vec2> normal;
    if (outline_s_.solid && outline_t_.solid && sample_.arc_site < 0)
      normal = parting_normal(turned(wedge_at(outline_s_, sample_.p)), wedge_at(outline_t_, vertex), wanted);
    add(n.site, normal.value_or(wanted), n.gap);
  }

  /// From S's frame to T's.
  Wedge turned(Wedge w) const {
    for (auto* directions : {&w.edges, &w.normals})
      for (Vec2& d : *directions) d = t_.frame.direction_to_local(s_.frame.direction_to_world(d));
    return w;
  }

  void add(int j, const Vec2& normal, double gap) {
    // Time, level and sink are those of the contact that was found.
    FeatureContact c = f_;
    const Vec2 out = t_.frame.direction_to_world(normal);
    c.site = j;
    c.normal = f_.sample_on_a ? out : Vec2(-out);
    c.point = base_ + t_.frame.to_world(path_.q - normal * (gap + sample_.radius));
    c.closing_speed = -normal.dot(path_.rate);
    c.gap = gap;
    found_.push_back(c);
  }

  const FeatureContact& f_;
  double tolerance_;
  const Outline &outline_s_, &outline_t_;
  Vec2 base_;  ///< world, near the pair: frames are seen from there
  Placed s_, t_;
  const Sample& sample_;
  SamplePath path_;
  std::vector<Near> near_;
  std::vector<FeatureContact> found_;
};

}  // namespace

std::vector<FeatureContact> joint_contacts(const Outline& a, const ExtendedState& state_a, const Outline& b,
                                           const ExtendedState& state_b, const FeatureContact& f,
                                           double tolerance) {
  const Outline& outline = f.sample_on_a ? a : b;
  if (outline.samples[f.sample].arc_site >= 0) return {f};
  return Joint(a, state_a, b, state_b, f, tolerance).contacts();
}

}  // namespace brink
