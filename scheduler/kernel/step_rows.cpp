#include "brink/scheduler/kernel/step_rows.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "brink/core/base/limits.h"
#include "brink/scheduler/islands/driven_surface.h"
#include "brink/scheduler/kernel/feature_approach.h"

namespace brink {

std::vector<Vec3> forces_of(const IslandMembers& members, const std::vector<Acceleration>& accelerations) {
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < accelerations.size(); ++i) {
    const Body& b = members.body(static_cast<int>(i));
    const Acceleration& a = accelerations[i];
    all.emplace_back(b.mass * a.linear.x(), b.mass * a.linear.y(), b.inertia * a.angular);
  }
  return all;
}

double largest_change(const IslandMembers& members, const std::vector<Vec3>& forces,
                      const std::vector<Vec3>& others) {
  double most = 0.0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const Body& b = members.body(static_cast<int>(i));
    const Vec3 change = forces[i] - others[i];
    most = std::max(most, change.head<2>().norm() / b.mass +
                              std::abs(change[2]) / b.inertia * members.bounding_radius(static_cast<int>(i)));
  }
  return most;
}

IslandStep StepRows::members_alone() const {
  IslandStep problem;
  for (std::size_t i = 0; i < members_->count(); ++i) {
    const int member = static_cast<int>(i);
    const Body& b = members_->body(member);
    problem.velocity.push_back(as_vector(members_->state(member).twist.rounded()));
    // infinity: held (RestProblem)
    problem.mass.emplace_back(b.lock_x ? kForever : b.mass, b.lock_y ? kForever : b.mass,
                              b.lock_angle ? kForever : b.inertia);
  }
  problem.force = forces_of(*members_, members_->accelerations());
  if (!members_->are_constant())
    for (std::size_t i = 0; i < members_->count(); ++i)
      problem.joined_to.push_back(members_->coupled_to(static_cast<int>(i)).front());
  if (search_->repeats()) return problem;
  for (std::size_t i = 0; i < members_->count(); ++i)
    problem.place.emplace_back(
        (members_->state(static_cast<int>(i)).position - members_->state(0).position).cast<double>());
  return problem;
}

void StepRows::add(const std::vector<HeldContact>& contacts, IslandStep& problem) const {
  for (std::size_t k = problem.contacts.size(); k < contacts.size(); ++k)
    problem.contacts.push_back(island_contact(contacts[k]));
}

/// Of a site that moves: the body is not abreast of it yet, and may be where it comes to.
bool StepRows::is_beside_driven(const HeldContact& c) const {
  return members_->on_moving_site(c) && (c.feature.at_end || c.feature.beside_arc);
}

/// Geometry at the start of the step; forces of the step before, from which friction bounds come. Of a site that moves geometry is
/// that where it comes to: the end of an arc may have gone by.
IslandContact StepRows::island_contact(const HeldContact& c) const {
  IslandContact made;
  made.rows = rows_of(c);
  const FeatureApproach approach(*members_, *search_);
  made.gap = c.feature.gap - approach.kept(c.feature);
  made.thin = c.feature.thin;
  // a wire has no inside: what is through it, by however little, is on its other side
  made.tolerance = approach.most_missed(c.feature);
  const Material& material = response_->material_of(c.pair);
  made.friction = material.friction;
  made.rolling_resistance = material.rolling_resistance;
  if (const HeldContact* warm = warm_->find(c)) {
    made.normal_force = warm->normal_force;
    made.tangential_force = warm->tangential_force;
    made.force_lasted = warm->lasted;
  }
  made.at_end = c.feature.at_end || c.feature.beside_arc;
  made.driven = members_->on_moving_site(c);
  // a body that is a member moves by the unknown twists; a site by what it is told
  note_shape(c, made);
  if (made.driven) drive(c, made);
  return made;
}

double StepRows::most_absorbed(const PairKey& pair) const {
  const double e = response_->material_of(pair).restitution;
  return e > 0.0 ? members_->pull() * h_ / e : kForever;
}

/// A vertex, or a corner, and a straight side.
bool StepRows::is_straight(const HeldContact& c) const {
  const Outline *carrier = &search_->outline_of(c.pair.body),
                *other = &search_->outline_of(search_->other_owner(c.pair));
  if (!c.feature.sample_on_a) std::swap(carrier, other);
  return carrier->samples[c.feature.sample].arc_site < 0 &&
         other->sites[c.feature.site].kind == SiteKind::segment;
}

/// The mean velocity of its surface along the normal, by what the gap loses where the body stays, and that of its point along the
/// tangent. A point's own along the normal would be no surface's: those of a round drum leave it along chords. What is under the
/// body now counts as the line or the circle that it is, until the step ends; what is beside it, as where it comes to. The body is
/// looked for there where a straight side takes it along the normal, and where its own point goes along the tangent: so nothing depends
/// on how fast the two go together.
void StepRows::drive(const HeldContact& c, IslandContact& made) const {
  const ExtendedState from = members_->other_state(c.pair), to = members_->other_state(c.pair, h_, {});
  // the site's own motion over the step, as one turn and shift of the point that touches
  const Frame step(
      {(to.position - from.position).cast<double>(), static_cast<double>(to.angle - from.angle)});
  const Vec2 way = step.to_world(c.feature.point) - c.feature.point;
  made.tangential_support = way.dot(perp(c.feature.normal)) / h_;
  // of a place that stays where it is, as the site turns under it: so much does the momentum that the site gives, linear and angular,
  // work on the whole (what a round drum turns away along chords is nothing)
  const double turn = static_cast<double>(to.angle - from.angle);
  const auto of_place = [&](const Vec2& place) { return Vec2((step.origin + turn * perp(place)) / h_); };
  made.site_velocity = of_place(c.feature.point);
  if (!is_beside_driven(c)) {
    made.normal_support = advance_of_surface(c.feature, search_->outline_of(search_->other_owner(c.pair)),
                                             static_cast<double>(from.angle), step) /
                          h_;
    // What it has at the end it gives, where the rest would be an impact by the next step: a lift that starts at once takes along
    // what lies on it. What it has of its turning alone is none: all its places would not go as one body.
    const Vec2 last = to.twist.rounded().at(step.to_world(c.feature.point) - step.origin);
    const double at_end = last.dot(c.feature.normal);
    const double turning = std::abs(turn) * way.norm() / h_;
    if (at_end - made.normal_support > most_absorbed(c.pair) + turning)
      made.normal_support = at_end, made.site_velocity = last;
    return;
  }
  const int body = members_->place_of(c.pair.body);
  // of what is round on either side only the shift: it rolls and slides, and is met elsewhere than where a point of it is led
  const Vec2 tangent = perp(c.feature.normal);
  const Vec2 taken =
      is_straight(c)
          ? Vec2(made.site_velocity.dot(c.feature.normal) * c.feature.normal +
                 tangent.dot(members_->state(body).twist.at(members_->arm(c)).cast<double>()) * tangent)
          : Vec2(step.origin / h_);
  std::vector<Vec3> along(members_->count(), Vec3::Zero());
  along[body] = {taken.x(), taken.y(), 0.0};
  const double gap = members_->gap(c, h_, along);
  const std::vector<NearFeature> ahead = members_->features_ahead(c.pair, h_, along);
  const auto found = std::find_if(ahead.begin(), ahead.end(), [&](const NearFeature& f) {
    return std::tuple(f.sample_on_a, f.sample, f.site) ==
           std::tuple(c.feature.sample_on_a, c.feature.sample, c.feature.site);
  });
  // not where the site has come over the body, which is on another side of it there
  const bool there = found != ahead.end() && found->normal.dot(c.feature.normal) > 0.0 &&
                     (found->over_joint || std::abs(found->gap - gap) <= search_->limits().tolerance);
  made.normal_support = (there ? c.feature.gap - found->gap : members_->gap(c, 0.0, along) - gap) / h_;
  HeldContact then = c;
  if (there) {
    then.feature = *found;
    const Vec2 point = found->point + step.origin;  // from where the site is now
    then.feature.point = point - h_ * taken;        // as the body sees it there
    made.rows = rows_of(then);
    const Vec2 way_there = point - step.to_local(point);
    made.tangential_support = way_there.dot(perp(found->normal)) / h_;
    made.site_velocity = of_place(then.feature.point);
  }
  // the rows speak of the body's whole way, of which this is a part
  made.normal_support += then.feature.normal.dot(taken);
}

/// What stands is as a site is, whichever of the two it is: the normal points into what moves then, or away from it.
LastingContact StepRows::rows_of(const HeldContact& c) const {
  const int a = members_->place_of(c.pair.body);
  const int b = c.pair.with_site() ? -1 : members_->place_of(c.pair.other_body);
  LastingContact rows = contact_at(a, b, c.feature.normal, members_->arm(c).cast<double>(), c.feature.point);
  if (b >= 0 && members_->is_support(b)) rows.other = -1;
  if (!members_->is_support(a)) return rows;
  rows.body = b;
  rows.normal_on_body = rows.normal_on_other;
  rows.tangent_on_body = rows.tangent_on_other;
  rows.other = -1;
  return rows;
}

/// How the gap behaves along a step. Of a segment it is convex in front of it, so of a wire it is not, nor where there is no
/// way by an end: there what is beside the segment counts as behind it, too. Of an arc it depends on the side.
void StepRows::note_shape(const HeldContact& c, IslandContact& made) const {
  const NearFeature& f = c.feature;
  const Outline *of_sample = &search_->outline_of(c.pair.body),
                *of_site = &search_->outline_of(search_->other_owner(c.pair));
  if (!f.sample_on_a) std::swap(of_sample, of_site);
  const Sample& sample = of_sample->samples[f.sample];
  const SiteKind kind = of_site->sites[f.site].kind;
  made.convex = !made.driven && !f.thin && !f.beside_arc && !f.no_way_by && !of_site->container &&
                kind != SiteKind::arc;
  const Site& site = of_site->sites[f.site];
  made.round_site = site.kind == SiteKind::point && site.a == Vec2(Vec2::Zero());
  // the row's body is the one who moves (rows_of)
  made.sample_on_body = f.sample_on_a != members_->is_support(members_->place_of(c.pair.body));
  made.arm = sample.p.norm();
  // from the centre of mass to the point on the site's surface, and on along the normal to the sample
  const Vec2 to_point = f.sample_on_a ? f.point : Vec2(members_->arm(c).cast<double>());
  made.apart = to_point.norm() + std::abs(f.gap) + sample.radius;
}

}  // namespace brink
