#include "brink/scenes/run_file/run_moment.h"

#include <fmt/format.h>

#include <cmath>

#include "brink/core/base/error.h"
#include "brink/core/shapes/distance.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/shape_json.h"
#include "brink/scheduler/kernel/site_motion.h"

namespace brink {
namespace {

/// Frames looked at for what is worth seeing; times at which a trail is asked.
/// A look costs reading a frame; a time of a trail costs two frames and the events between them.
constexpr int kLooks = 32, kTrailLooks = 400;

/// Numbers of a file are finite, but squares of places from 1e154 m on are not, and a turn of 1e20 rad
/// has no digits left below 2 pi. False of NaN.
bool somewhere(const Pose& pose) {
  return pose.position.norm() <= kFarthestPlace && std::abs(pose.angle) <= kFarthestPlace;
}

/// The same message for bodies and sites; `table` is where their place comes from.
[[noreturn]] void nowhere(const std::filesystem::path& file, const char* table, const std::string& name,
                          double t) {
  throw IoError(fmt::format("{}: table {}: '{}' is at no place that can be drawn at t = {} s", file.string(),
                            table, name, t));
}

/// @throws IoError naming the first site or body whose pose cannot be drawn. Sites of formulas may be
/// at NaN, which no check of the file could find, as the file holds the formula.
void require_drawable(const std::filesystem::path& file, const RunMoment& moment) {
  for (std::size_t k = 0; k < moment.sites.size(); ++k)
    if (!somewhere(moment.sites[k])) nowhere(file, "site", moment.world.sites[k].name, moment.t);
  for (std::size_t k = 0; k < moment.bodies.size(); ++k)
    if (!somewhere(moment.bodies[k].pose)) nowhere(file, "frame", moment.world.bodies[k].name, moment.t);
}

}  // namespace

namespace {

/// Who carries the sample of a contact, or its site: an outline where it stands.
struct Carrier {
  const Outline& outline;
  const Pose& pose;
};

/// all[index], where the index comes from a file. @throws BadInput naming what it is and how many there
/// are.
template <class T>
const T& feature_at(const std::vector<T>& all, int index, const char* what) {
  if (index < 0 || index >= static_cast<int>(all.size()))
    throw BadInput(fmt::format("contact: {} {} given; the outline has {}", what, index, all.size()));
  return all[static_cast<std::size_t>(index)];
}

/// Where the two features touch, nearest to the sample.
/// The sample may have left the site a little since, or sunk into it: the surface point is the nearest
/// one to it, the site's thickness towards the sample.
Vec2 place_of(const LastedContact& c, const Carrier& samples, const Carrier& sites) {
  const Sample& sample = feature_at(samples.outline.samples, c.sample, "sample");
  const Site& site = feature_at(sites.outline.sites, c.site, "site");
  // By way of the world into the frame of the site's outline, where the site's coordinates are.
  const Frame from(samples.pose), to(sites.pose);
  const Vec2 p = to.to_local(from.to_world(sample.p));
  const Vec2 on = nearest_on(site, p).point, out = p - on;
  // A sample on the core itself has no direction out; the core is then near enough for a picture.
  return to.to_world(out.norm() > 0.0 ? Vec2(on + site.radius * out.normalized()) : on);
}

}  // namespace

std::vector<DrawnForce> forces_of(const RunMoment& moment) {
  std::vector<DrawnForce> out;
  // at() wherever an index comes from the file.
  for (const LastedContact& c : moment.contacts) {
    const Pose& body = moment.bodies.at(c.body).pose;
    const bool with_site = c.other_body < 0;
    // A copy: of a body in a plane that repeats it is moved by whole periods.
    Pose other = with_site ? moment.sites.at(c.other_site) : moment.bodies.at(c.other_body).pose;
    // its image that the body meets: the contact's place was near the body
    for (int axis = 0; axis < 2; ++axis)
      if (const double size = moment.world.periods.size[axis]; size > 0.0 && !with_site)
        other.position[axis] -= size * std::round((other.position[axis] - body.position[axis]) / size);
    // The sample is on one of the two outlines, the site on the other.
    const Carrier a{*moment.world.bodies.at(c.body).outline, body};
    const Carrier b{with_site ? *moment.world.sites.at(c.other_site).outline
                              : *moment.world.bodies.at(c.other_body).outline,
                    other};
    Vec2 arm = (c.sample_on_body ? place_of(c, a, b) : place_of(c, b, a)) - body.position;
    if (with_site)  // of a site that covers many periods: the image at the contact
      for (int axis = 0; axis < 2; ++axis)
        if (const double size = moment.world.periods.size[axis]; size > 0.0)
          arm[axis] -= size * std::round(arm[axis] / size);
    // A force on each of the two bodies, of the same size; a fixed site is not drawn as being pushed.
    out.push_back({c.body, arm, c.normal_force, c.normal});
    // The same place, from the other's centre.
    if (!with_site)
      out.push_back({c.other_body, body.position + arm - other.position, c.normal_force, -c.normal});
  }
  return out;
}

// At equal distances in time: a run of a million frames takes as long as one of a hundred. Where a body
// is between two looks may be left out.
Box extent_of(const RunFile& run, const World& world) {
  Box all;
  const auto [first, last] = run.time_range();
  for (int k = 0; k <= kLooks; ++k) {
    const RunFile::Frame frame = run.frame_at(first + (last - first) * k / kLooks);
    std::vector<Pose> sites;
    for (const FixedSite& site : world.sites) sites.push_back(told_pose(site, frame.t));
    const Box seen = automatic_view(world, frame.states, sites);
    all.add(seen.low);
    all.add(seen.high);
  }
  for (int axis = 0; axis < 2; ++axis)  // of a plane that repeats itself, one period
    if (const double size = world.periods.size[axis]; size > 0.0) {
      all.low[axis] = 0.0;
      all.high[axis] = size;
    }
  return all;
}

std::vector<std::vector<Vec2>> trails_of(const RunFile& run, double t) {
  const double first = run.time_range().first;
  std::vector<std::vector<Vec2>> trails;
  // Between frames along the bodies' collisions: a ball's trail has its corners where it bounced.
  for (int k = 0; k <= kTrailLooks; ++k) {
    const auto states = run.states_at(first + (t - first) * k / kTrailLooks).states;
    trails.resize(states.size());
    for (std::size_t b = 0; b < states.size(); ++b) trails[b].push_back(states[b].pose.position);
  }
  return trails;
}

std::vector<DrawnContact> contacts_before(const RunFile& run, double t) {
  // On a frame's own time: collisions since the one before it.
  double since = run.frame_at(t).t;
  // nextafter() gives the double before t: frame_at() takes the last frame at or before it.
  if (since == t) since = run.frame_at(std::nextafter(t, -1.0)).t;
  std::vector<DrawnContact> contacts;
  for (const Event& e : run.events())
    if (e.kind == EventKind::collision && e.contact.time > since && e.contact.time <= t)
      contacts.push_back({e.contact.point, e.contact.normal, std::abs(e.impulse_n)});
  return contacts;
}

RunMoment moment_of_run(const std::filesystem::path& file, std::optional<double> at) {
  const RunFile run(file);
  const auto [first, last] = run.time_range();
  const double t = at.value_or(last);
  if (!(t >= first && t <= last))
    throw BadInput(fmt::format("--at: {} given; allowed: {} .. {} s", t, first, last));
  RunMoment moment{t, run.world(), run.states_at(t).states, {}, run.contacts_at(t)};
  for (const FixedSite& site : moment.world.sites) moment.sites.push_back(told_pose(site, t));
  require_drawable(file, moment);
  try {
    // For its faults alone: features that an outline does not have are told of the file, before
    // anything is drawn.
    forces_of(moment);
  } catch (const BadInput& e) {
    throw IoError(fmt::format("{}: table contact: {}", file.string(), e.what()));
  }
  return moment;
}

}  // namespace brink
