#include "brink/scheduler/classic/depth_detector.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "brink/core/base/error.h"
#include "brink/core/shapes/distance.h"
#include "brink/scheduler/classic/depth_normal.h"

namespace brink {

namespace {

std::vector<double> bounding_radii(const World& world) {
  std::vector<double> radii;
  for (const Body& body : world.bodies) radii.push_back(body.outline->bounding_radius);
  return radii;
}

/// A fault of the sampling is told with the body's name.
std::vector<Particle> particles_of(const Body& body) {
  try {
    return make_particles(*body.outline, body.sampling);
  } catch (const BadInput& error) {
    throw BadInput(fmt::format("body \"{}\": {}", body.name, error.what()));
  }
}

/// The picture's signed gap [m]. A solid's inside is told by the picture; within a thickness, where both
/// sides of the core count as inside, by the site.
double signed_gap(const PixelValue& value, const Site& site, const Vec2& at) {
  if (!value.inside) return value.distance;
  if (site.radius == 0.0) return -static_cast<double>(value.distance);
  return side_of(site, nearest_on(site, at), at) * (value.distance + site.radius) - site.radius;
}

}  // namespace

DepthDetector::DepthDetector(const World& world, const SolverOptions& options, WorkCounters* work)
    : world_(world),
      tolerance_(options.contact_tolerance * world.length()),
      prune_(options.broad_phase),
      truncated_(options.field.truncated),
      pictures_(options.field, bounding_radii(world), world.length(), work) {
  for (const Body& body : world.bodies) {
    particles_.push_back(particles_of(body));
    for (const Particle& p : particles_.back()) largest_particle_ = std::max(largest_particle_, p.radius);
  }
}

double DepthDetector::tolerance(int body) const {
  return std::max(tolerance_, std::sqrt(0.5) * pictures_.pixel(body));
}

const Outline& DepthDetector::outline_of(int owner) const {
  const int n = static_cast<int>(world_.bodies.size());
  return owner < n ? *world_.bodies[owner].outline : *world_.sites[owner - n].outline;
}

/// Owners whose bounding circle comes within the margin of the body's; containers always do.
std::vector<int> DepthDetector::near_owners(int body, std::span<const OwnerMoment> owners,
                                            double margin) const {
  std::vector<int> near;
  const double reach = outline_of(body).bounding_radius + margin;
  for (int k = 0; k < static_cast<int>(owners.size()); ++k) {
    if (k == body) continue;
    const double apart = (owners[k].now.pose.position - owners[body].now.pose.position).norm();
    if (outline_of(k).container || apart <= reach + outline_of(k).bounding_radius) near.push_back(k);
  }
  return near;
}

DepthSight DepthDetector::look(std::span<const OwnerMoment> owners, double travel) {
  areas_.clear();
  double coarsest = 0.0;
  for (int k = 0; k < static_cast<int>(particles_.size()); ++k)
    coarsest = std::max(coarsest, pictures_.pixel(k));
  // Three pixels: half a diagonal by which a touching depth may exceed tolerance_ (tolerance()), as much
  // by which a particle is off its pixel's centre, and one to the neighbours of which the slope is made:
  // 2.42 in all.
  const double band = tolerance_ + largest_particle_ + travel + 3.0 * coarsest;
  std::vector<PlacedOutline> scene;
  for (int k = 0; k < static_cast<int>(owners.size()); ++k)
    scene.push_back({&outline_of(k), owners[k].now.pose, static_cast<std::uint32_t>(k)});
  // truncated or not, contacts are the same: sites beyond the band touch nobody
  pictures_.begin(std::move(scene), truncated_ ? band : std::numeric_limits<double>::infinity());
  for (int k = 0; k < static_cast<int>(particles_.size()); ++k) {
    std::vector<int> near;
    if (prune_) near = near_owners(k, owners, band);
    // an empty list would mean everybody to open()
    if (prune_ && near.empty()) continue;
    pictures_.open(k, near);
    look_from(k, owners);
  }
  // found body by body: a pair may come from its second body first
  std::stable_sort(sight_.overlaps.begin(), sight_.overlaps.end(),
                   [](const DepthOverlap& a, const DepthOverlap& b) { return a.pair < b.pair; });
  return std::exchange(sight_, {});
}

/// Reads the picture at the particles of one body, and turns what touches into contacts.
struct DepthDetector::Reader {
  DepthDetector& detector;
  int body;
  std::span<const OwnerMoment> owners;
  Frame frame{owners[body].now.pose}, frame_before{owners[body].before.pose};

  Vec2 place(const Particle& particle) const { return frame.to_world(particle.p); }

  const Site& site_of(const PixelValue& value) const {
    return detector.outline_of(static_cast<int>(value.owner)).sites[value.site];
  }

  /// Of what the pixel names, from a place in the world [m]; infinite where it sees nobody.
  double gap(const PixelValue& value, const Vec2& p) const {
    if (value.owner == FieldImage::kNone) return std::numeric_limits<double>::infinity();
    return signed_gap(value, site_of(value), Frame(owners[value.owner].now.pose).to_local(p));
  }

  /// Central differences of the depth one pixel apart, about the particle's pixel, in the world.
  Vec2 slope(const Vec2& particle) const {
    const Vec2 p = detector.pictures_.pixel_center(particle);
    const double pixel = detector.pictures_.pixel(body);
    const std::array<Vec2, 4> around{Vec2(p.x() + pixel, p.y()), Vec2(p.x() - pixel, p.y()),
                                     Vec2(p.x(), p.y() + pixel), Vec2(p.x(), p.y() - pixel)};
    const std::vector<PixelValue> values = detector.pictures_.read(around);
    std::array<double, 4> depth{};
    for (std::size_t k = 0; k < 4; ++k) depth[k] = gap(values[k], around[k]);
    // A neighbour that sees nobody is infinitely deep: no slope then, and geometry answers
    // (kLeastSlope).
    const Vec2 difference(depth[0] - depth[1], depth[2] - depth[3]);
    return difference.allFinite() ? Vec2(difference / (2.0 * pixel)) : Vec2(Vec2::Zero());
  }

  /// What particle `index` makes of its pixel, `depth` being the gap of its centre [m].
  DepthContact contact(int index, const PixelValue& value, double depth) const {
    const Particle& particle = detector.particles_[body][index];
    const OwnerMoment& other = owners[value.owner];
    const Frame there(other.now.pose);
    const Vec2 p = place(particle);
    const Vec2 velocity = owners[body].now.twist.at(p - frame.origin) - other.now.twist.at(p - there.origin);
    const ParticlePlace beside{there.to_local(p),
                               Frame(other.before.pose).to_local(frame_before.to_world(particle.p)),
                               there.direction_to_local(velocity)};
    const DepthNormal found =
        normal_of(site_of(value), beside, [&] { return there.direction_to_local(slope(p)); });
    const Vec2 normal = there.direction_to_world(found.normal);
    const int other_owner = static_cast<int>(value.owner), n = static_cast<int>(detector.particles_.size());
    DepthContact c;
    // The first of a pair is the body with the lower number: the one that carries the particle, or not.
    const bool on_a = other_owner >= n || body < other_owner;
    c.pair = other_owner >= n ? PairKey{body, -1, other_owner - n}
             : on_a           ? PairKey{body, other_owner, -1}
                              : PairKey{other_owner, body, -1};
    c.contact.seen = true;
    c.contact.sample_on_a = on_a;
    c.contact.sample = index;
    c.contact.site = static_cast<int>(value.site);
    c.contact.point = p - particle.radius * normal;
    c.contact.normal = on_a ? normal : Vec2(-normal);
    c.contact.closing_speed = -velocity.dot(normal);
    c.contact.gap = (found.crossed ? -std::abs(depth) : depth) - particle.radius;
    return c;
  }
};

/// One read of the picture for all particles of the body; slopes are read besides, where an arc touches.
void DepthDetector::look_from(int body, std::span<const OwnerMoment> owners) {
  const Reader reader{*this, body, owners};
  const std::vector<Particle>& particles = particles_[body];
  std::vector<Vec2> places;
  places.reserve(particles.size());
  for (const Particle& particle : particles) places.push_back(reader.place(particle));
  const std::vector<PixelValue> values = pictures_.read(places);
  const double touch = tolerance(body);
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const double depth = reader.gap(values[k], places[k]);
    if (!(depth - particles[k].radius < touch)) continue;
    DepthContact c = reader.contact(static_cast<int>(k), values[k], depth);
    if (c.contact.gap < 0.0) note_overlap(c, particles[k].area, c.contact.sample_on_a);
    // what lies inside is no surface that could touch: it tells how deep
    if (particles[k].area == 0.0) sight_.contacts.push_back(std::move(c));
  }
}

/// Deepest particle and area by pair. `on_a`: the particle is of the pair's first body.
void DepthDetector::note_overlap(const DepthContact& contact, double area, bool on_a) {
  auto& all = sight_.overlaps;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const DepthOverlap& o) { return o.pair == contact.pair; });
  const std::size_t place = static_cast<std::size_t>(found - all.begin());
  if (found == all.end()) {
    all.push_back({contact.pair, 0.0, 0.0, Vec2::Zero()});
    areas_.emplace_back(0.0, 0.0);
  }
  DepthOverlap& overlap = all[place];
  if (-contact.contact.gap > overlap.depth) {
    overlap.depth = -contact.contact.gap;
    overlap.normal = contact.contact.normal;
  }
  auto& [by_body, by_other] = areas_[place];
  (on_a ? by_body : by_other) += area;
  // Either body's particles measure the same overlap: two measures have a mean, one stands alone.
  overlap.area = by_body > 0.0 && by_other > 0.0 ? 0.5 * (by_body + by_other) : by_body + by_other;
}

std::vector<std::string> DepthDetector::describe() const {
  // Bodies of one outline with as many particles are told in one line, by the first one's name.
  std::map<std::pair<const Outline*, std::size_t>, std::pair<std::string, int>> kinds;
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    auto& [name, bodies] = kinds[{world_.bodies[k].outline.get(), particles_[k].size()}];
    if (++bodies == 1) name = world_.bodies[k].name;
  }
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    const Body& body = world_.bodies[k];
    const auto& [name, bodies] = kinds[{body.outline.get(), particles_[k].size()}];
    if (name != body.name) continue;
    lines.push_back(fmt::format(
        "samples: '{}'{}: {}, touching below {:.3g} m; features narrower than {:.3g} m can slip between",
        name, bodies > 1 ? fmt::format(" and {} more", bodies - 1) : "", particles_[k].size(),
        tolerance(static_cast<int>(k)), widest_gap(*body.outline, particles_[k])));
  }
  return lines;
}

}  // namespace brink
