#include "brink/scheduler/resolve/joint_contacts.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"
#include "brink/scheduler/first_contact/corners.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/resolve/tolerances.h"
#include "brink/scheduler/resolve/wedge.h"

namespace brink {

namespace {

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
  // a normal of `front` points out of it, so towards `behind`
  for (const Vec2& n : front.normals) consider(-n);
  return best;
}

/// A vertex of S and the sites of T around it.
/// All is looked at in T's frame, seen from b's position: far from the origin no digits are lost.
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
    // The sites of a corner meet at one place: it is looked at once.
    bool corner_done = false;
    for (const Near& n : near_) {
      // A sharp end has no normal of its own, so its contact asks for one that parts. A round end has, and is told
      // unless a neighbour tells the same. What is touched between its ends always counts.
      if (n.at_end && sharp(n.site)) {
        if (!std::exchange(corner_done, true)) add_corner(n);
      } else if (!n.at_end || !is_told(n)) {
        add_touched(n);
      }
    }
    return found_;
  }

 private:
  /// A site of T that is near. at_end: the nearest point is an end of it, or a rounding beside one.
  struct Near {
    int site;
    Nearest nearest;
    double gap;
    bool at_end;
  };

  const Site& site(int j) const { return outline_t_.sites[j]; }
  bool sharp(int j) const { return site(j).radius + sample_.radius == 0.0; }

  /// A wire has no side of its own: the sample is on that on which its body is, where it lies right on the wire,
  /// or has sunk into it a little in an island's steps.
  void add_touched(const Near& n) {
    constexpr double kOnWire = 1e-4;  // of the tolerance: a tenth of a wire's level
    const Site& wire = site(n.site);
    // a solid's corner knows its inside, so it may have sunk as far as the tolerance; of anything else the side is
    // told by where its origin is, and only right on the wire
    const double doubtful = sample_.before >= 0 ? tolerance_ : kOnWire * tolerance_;
    const bool on_wire = !wire.solid && wire.kind != SiteKind::point && sharp(n.site) && !n.at_end &&
                         n.nearest.distance <= doubtful;
    const Vec2 normal = normal_at(wire, n.nearest, path_.q);
    // towards the material of S: the side of the wire on which that is, is the sample's
    const Vec2 inside = detail::way_inside(outline_s_, sample_, s_.frame, t_.frame, path_.q);
    if (on_wire && normal.dot(inside) < 0.0)
      add(n.site, -normal, -n.nearest.distance);
    else
      add(n.site, normal, n.gap);
  }
  /// True if another site that has this end, too, says all of it: one that is touched beside the end, or of two
  /// that are touched right there the first.
  bool is_told(const Near& n) const {
    return std::any_of(near_.begin(), near_.end(), [&](const Near& m) {
      if (&m == &n || (m.at_end && &m > &n)) return false;
      const auto is_end = [&](const Vec2& end) { return (end - n.nearest.point).norm() <= tolerance_; };
      return m.at_end ? is_end(m.nearest.point) : is_end(site(m.site).a) || is_end(site(m.site).b);
    });
  }

  /// Notes site j if it is within the tolerance, and the site that was found whatever is seen of it now.
  void look_at(int j) {
    const Nearest n = nearest_on(site(j), path_.q);
    const double gap = side_of(site(j), n, path_.q) * n.distance - site(j).radius - sample_.radius;
    if (j != f_.site && std::abs(gap) > tolerance_) return;
    const auto close = [&](const Vec2& end) { return (path_.q - end).norm() <= tolerance_; };
    // As near to a sharp end as the tolerance, whether the foot is on the end or beside it is rounding.
    const bool corner = sharp(j) && site(j).solid && (close(site(j).a) || close(site(j).b));
    near_.push_back({j, n, gap, corner || n.foot != Foot::interior || site(j).kind == SiteKind::point});
  }

  /// One contact for all sites that meet there: with the normal that parts the wedges, of which one may be a wire's end, or,
  /// where none does or both are wires, with the one that was found.
  void add_corner(const Near& n) {
    const Site& edge = site(n.site);
    const Vec2 vertex = (path_.q - edge.a).norm() <= (path_.q - edge.b).norm() ? edge.a : edge.b;
    // from T to S, as all normals here
    const Vec2 out = f_.sample_on_a ? f_.normal : Vec2(-f_.normal);
    const Vec2 wanted = t_.frame.direction_to_local(out);
    std::optional<Vec2> normal;
    if ((outline_s_.solid || outline_t_.solid) && sample_.arc_site < 0)
      normal = parting_normal(
          turned(wedge_at(outline_s_, sample_.p),
                 [&](const Vec2& d) { return t_.frame.direction_to_local(s_.frame.direction_to_world(d)); }),
          wedge_at(outline_t_, vertex), wanted);
    // how far the tip is from the line that parts the two, not from a side that it goes along
    if (normal)
      add(n.site, *normal, normal->dot(path_.q - vertex));
    else
      add(n.site, wanted, n.gap);
  }

  /// A contact with site j; the normal is in T's frame, out of T, and the gap along it [m].
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

/// An arc's sample is a centre with a sector, no vertex: it has one way to the other outline.
std::vector<FeatureContact> joint_contacts(const Outline& a, const ExtendedState& state_a, const Outline& b,
                                           const ExtendedState& state_b, const FeatureContact& f,
                                           double tolerance) {
  const Outline& outline = f.sample_on_a ? a : b;
  if (outline.samples[f.sample].arc_site >= 0) return {f};
  return Joint(a, state_a, b, state_b, f, tolerance).contacts();
}

}  // namespace brink
