#include "brink/scheduler/simulator/make_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "brink/scheduler/first_contact/closed_forms.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"

namespace brink {

namespace {

/// A line about what is left out; `setting`: by which it was not, else empty.
std::string unless(const std::string& setting, std::string text) {
  if (!setting.empty()) text += " (not left out: " + setting + ")";
  return text;
}

}  // namespace

/// Asks what the parts would do, by the same questions that they ask themselves, and counts. Nothing of it is
/// looked up later: the plan is for people. Cost: a look at every owner, none at pairs.
Plan make_plan(const KernelView& kernel, const std::vector<std::string>& of_policy) {
  const World& world = kernel.world();
  const SolverOptions& options = kernel.options();
  const int n = kernel.body_count();
  Plan plan;
  auto& lines = plan.lines;
  lines.push_back(fmt::format("policy {}, order {}, response {}, detector {}", options.policy, options.order,
                              options.response, options.detector));
  int ballistic = 0;
  for (int k = 0; k < n; ++k) ballistic += kernel.is_ballistic(k);
  lines.push_back(
      fmt::format("motion: {} of {} bodies ballistic in closed form, {} component(s) with an integrator, {}",
                  ballistic, world.bodies.size(), kernel.component_count(), options.integrator));

  std::vector<int> discs;  // one of the two is a disc wherever a pair has a closed form
  for (int k = 0; k < kernel.owner_count(); ++k)
    // asked against itself: whether its own motion allows a closed form
    if (is_centred_disc(kernel.outline_of(k)) && (k >= n || kernel.is_ballistic(k)) &&
        has_closed_form(kernel.mover(k), kernel.mover(k)))
      discs.push_back(k);
  std::uint64_t disc_bodies = 0, partners = 0, disc_sites = 0,
                site_partners = 0;  // partners: of discs, no discs
  // What k's motion and outline allow does not depend on which disc it meets: one is asked for all.
  for (int k = 0; k < kernel.owner_count() && !discs.empty(); ++k) {
    const bool is_site = k >= n;
    if (!(is_site || kernel.is_ballistic(k)) ||
        !has_closed_form(kernel.mover(k), kernel.mover(discs.front())))
      continue;
    if (is_centred_disc(kernel.outline_of(k)))
      ++(is_site ? disc_sites : disc_bodies);
    else
      ++(is_site ? site_partners : partners);
  }
  // numbers without a sign: n - (n > 0) is no -1 where there are none
  const std::uint64_t bodies = world.bodies.size(),
                      pairs = bodies * (bodies - (bodies > 0)) / 2 + bodies * world.sites.size();
  // two bodies that are discs; such a body with any other body or site that has a form; one of those other bodies
  // with a disc that is a site
  const std::uint64_t closed = disc_bodies * (disc_bodies - (disc_bodies > 0)) / 2 +
                               disc_bodies * (partners + disc_sites + site_partners) + partners * disc_sites;
  lines.push_back(unless(options.closed_forms ? "" : "solver.closed_forms = false",
                         fmt::format("pairs: {} of {} have a first contact in closed form", closed, pairs)));

  // by address, as the kernel shares them
  std::set<const Outline*> shapes, with_field;
  // the rule by which a site index takes a field or brute force
  const auto look = [&](const Outline* o) {
    shapes.insert(o);
    if (options.fields_for_small_shapes ||
        static_cast<int>(o->sites.size()) >= options.field.brute_force_below)
      with_field.insert(o);
  };
  for (const Body& b : world.bodies) look(b.outline.get());
  for (const FixedSite& s : world.sites) look(s.outline.get());
  lines.push_back(unless(
      options.fields_for_small_shapes ? "solver.fields_for_small_shapes = true" : "",
      fmt::format(
          "fields: {} distinct shape(s), {} with a rendered field, {} of fewer than {} sites by brute force",
          shapes.size(), with_field.size(), shapes.size() - with_field.size(),
          options.field.brute_force_below)));
  lines.insert(lines.end(), of_policy.begin(), of_policy.end());
  // detectors `pass` and `depth` draw whatever the shapes are
  const bool context = !with_field.empty() || options.detector != "field";
  lines.push_back(context ? fmt::format("GL context: needed ({})", options.field.context)
                          : "GL context: not needed");
  const bool friction = std::any_of(world.materials.begin(), world.materials.end(),
                                    [](const Material& m) { return m.friction > 0.0; });
  lines.emplace_back(friction ? "friction: solved" : "friction: none in this scene, left out");
  lines.push_back(unless(options.broad_phase ? "" : "solver.broad_phase = false",
                         "broad phase: pairs whose moving bounds do not meet are left out"));
  return plan;
}

}  // namespace brink
