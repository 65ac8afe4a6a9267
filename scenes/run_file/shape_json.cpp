#include "brink/scenes/run_file/shape_json.h"

#include <nlohmann/json.hpp>

#include "brink/core/base/error.h"

namespace brink {
namespace {

using nlohmann::ordered_json;

// [x, y], and back. Keys are written in the order of the page in the header, hence ordered_json.
ordered_json pair(const Vec2& v) { return ordered_json::array({v.x(), v.y()}); }

Vec2 vector(const nlohmann::json& j) { return {j.at(0).get<double>(), j.at(1).get<double>()}; }

/// A site by its kind: what a kind does not use is not written. Normals, samples and bounds are left
/// out, too: finish_outline() makes them of the sites.
ordered_json site_object(const Site& site) {
  switch (site.kind) {
    case SiteKind::segment:
      return {{"kind", "segment"}, {"radius", site.radius}, {"a", pair(site.a)}, {"b", pair(site.b)}};
    case SiteKind::arc:
      return {{"kind", "arc"},      {"radius", site.radius},       {"a", pair(site.a)},
              {"b", pair(site.b)},  {"center", pair(site.center)}, {"arc_radius", site.arc_radius},
              {"sweep", site.sweep}};
    case SiteKind::point:
      break;
  }
  return {{"kind", "point"}, {"radius", site.radius}, {"a", pair(site.a)}};
}

/// `solid` is said once a loop. @throws BadInput on a kind that there is not; nlohmann's exceptions.
Site site_from(const nlohmann::json& j, bool solid) {
  const std::string kind = j.at("kind");
  Site site;
  site.solid = solid;
  site.radius = j.at("radius");
  site.a = vector(j.at("a"));
  // A point begins and ends at one place (core/shapes/site.h).
  site.b = kind == "point" ? site.a : vector(j.at("b"));
  if (kind == "segment") {
    site.kind = SiteKind::segment;
  } else if (kind == "arc") {
    site.kind = SiteKind::arc;
    site.center = vector(j.at("center"));
    site.arc_radius = j.at("arc_radius");
    site.sweep = j.at("sweep");
  } else if (kind != "point") {
    throw BadInput("shape: site of kind '" + kind + "'; allowed: point, segment, arc");
  }
  return site;
}

/// The sites of a loop stand side by side in the outline, in the loop's order.
ordered_json loop_object(const Outline& outline, const Loop& loop) {
  auto sites = ordered_json::array();
  for (int i = loop.first; i < loop.first + loop.count; ++i) sites.push_back(site_object(outline.sites[i]));
  const bool solid = loop.count > 0 && outline.sites[loop.first].solid;
  return {{"closed", loop.closed}, {"solid", solid}, {"sites", std::move(sites)}};
}

// The bounding radius is for other programs; reading works it out again.
ordered_json outline_object(const Outline& outline) {
  auto loops = ordered_json::array();
  for (const Loop& loop : outline.loops) loops.push_back(loop_object(outline, loop));
  return {{"solid", outline.solid},
          {"container", outline.container},
          {"bounding_radius", outline.bounding_radius},
          {"loops", std::move(loops)}};
}

/// A formula that is not there does not move: 0.
ordered_json formula(const std::optional<Formula>& f) {
  return f ? ordered_json(f->text()) : ordered_json("0");
}

/// null of a site that stands still. Formulas are kept as their texts, and are read by the same parser
/// again.
ordered_json motion_object(const FixedSite& site) {
  if (const auto* constant = std::get_if<ConstantMotion>(&site.motion)) {
    return {{"velocity", pair(constant->twist.velocity)}, {"angular_velocity", constant->twist.omega}};
  }
  if (const auto* told = std::get_if<FormulaMotion>(&site.motion)) {
    return {{"x", formula(told->x)}, {"y", formula(told->y)}, {"angle", formula(told->angle)}};
  }
  return nullptr;
}

/// Formulas of a site have one variable, the time. @throws BadInput where the text is none.
std::optional<Formula> formula_from(const nlohmann::json& j) { return Formula(j.get<std::string>(), {"t"}); }

/// The kind of motion is told by its keys: `velocity` is of constant twists alone.
void read_motion(const nlohmann::json& motion, FixedSite& site) {
  if (motion.contains("velocity")) {
    site.motion =
        ConstantMotion{{vector(motion.at("velocity")), motion.at("angular_velocity").get<double>()}};
  } else {
    site.motion = FormulaMotion{formula_from(motion.at("x")), formula_from(motion.at("y")),
                                formula_from(motion.at("angle"))};
  }
}

/// The pose that undoes `pose`.
/// p becomes R^T (p - position) = R^T p - R^T position.
Pose inverse(const Pose& pose) { return {-Frame(pose).direction_to_local(pose.position), -pose.angle}; }

}  // namespace

std::string outline_to_json(const Outline& outline) { return outline_object(outline).dump(); }

/// The outline at the site's pose at t = 0, and what reading needs to move it from there.
std::string fixed_site_to_json(const FixedSite& site) {
  // In the world: who reads the file needs no pose to draw a site that stands still.
  ordered_json j = outline_object(transformed(*site.outline, site.pose));
  j["pose"] = ordered_json::array({site.pose.position.x(), site.pose.position.y(), site.pose.angle});
  j["motion"] = motion_object(site);
  return j.dump();
}

Outline outline_from_json(const std::string& text) {
  Outline outline;
  try {
    // nlohmann's accessors throw where a key is missing or of another type: that is the whole
    // check of the form.
    const auto j = nlohmann::json::parse(text);
    outline.solid = j.at("solid");
    outline.container = j.at("container");
    for (const auto& l : j.at("loops")) {
      const bool solid = l.at("solid");
      Loop loop{static_cast<int>(outline.sites.size()), 0, l.at("closed")};
      for (const auto& s : l.at("sites")) outline.sites.push_back(site_from(s, solid));
      loop.count = static_cast<int>(outline.sites.size()) - loop.first;
      outline.loops.push_back(loop);
    }
  } catch (const nlohmann::json::exception& e) {
    throw BadInput(std::string("shape: not an outline in JSON: ") + e.what());
  }
  // Checks what makes an outline of sites: loops that join, arcs on their circles, no NaN.
  // It also fills what was not written: samples, normals, bounds.
  finish_outline(outline);
  if (!(outline.bounding_radius <= kFarthestPlace))
    throw BadInput("shape: it reaches farther than any scene");
  return outline;
}

FixedSite fixed_site_from_json(const std::string& text) {
  Outline in_world = outline_from_json(text);
  FixedSite site;
  try {
    const auto j = nlohmann::json::parse(text);
    // A site that stands still stays in the world, at the identity: so no rounding is added by
    // turning it back.
    if (!j.at("motion").is_null()) {
      const auto& pose = j.at("pose");
      site.pose = {vector(pose), pose.at(2).get<double>()};
      read_motion(j.at("motion"), site);
      // Back into the site's own frame, which moves: off by a rounding of the places.
      in_world = transformed(in_world, inverse(site.pose));
    }
  } catch (const nlohmann::json::exception& e) {
    throw BadInput(std::string("shape: not a fixed site in JSON: ") + e.what());
  }
  site.outline = std::make_shared<const Outline>(std::move(in_world));
  return site;
}

}  // namespace brink
