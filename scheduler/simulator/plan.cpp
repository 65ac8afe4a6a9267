/// The plan: what this scene needs, and what is left out because it does not.
#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "brink/scheduler/first_contact/closed_forms.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/kernel/kernel.h"

namespace brink {

namespace {

std::string switched(bool on, const char* option, std::string text) {
  if (!on) text += fmt::format(" (skipping switched off by {} = false)", option);
  return text;
}

}  // namespace

Plan Kernel::plan() const {
  Plan plan;
  auto& lines = plan.lines;
  lines.push_back(fmt::format("policy {}, order {}, response {}, detector {}", options_.policy,
                              options_.order, options_.response, options_.detector));
  const bool closed_motion = options_.integrator == "auto" || options_.integrator == "ballistic";
  const auto is_ballistic = [&](int k) {
    return bodies_[k].component < 0 ||
           (closed_motion && components_[bodies_[k].component].component.dynamics->constant());
  };
  int ballistic = 0;
  for (int k = 0; k < body_count(); ++k) ballistic += is_ballistic(k);
  lines.push_back(
      fmt::format("motion: {} of {} bodies ballistic in closed form, {} component(s) with an integrator, {}",
                  ballistic, bodies_.size(), components_.size(), options_.integrator));

  const auto mover_of = [&](int owner) {
    return owner < body_count() ? mover(owner) : site_mover(owner - body_count());
  };
  std::vector<int> discs;  // one of the two is a disc wherever a pair has a closed form
  for (int k = 0; k < owner_count(); ++k)
    if (is_centred_disc(outline_of(k)) && (k >= body_count() || is_ballistic(k)) &&
        has_closed_form(mover_of(k), mover_of(k)))
      discs.push_back(k);
  std::uint64_t disc_bodies = 0, partners = 0, disc_sites = 0,
                site_partners = 0;  // partners: of discs, no discs
  for (int k = 0; k < owner_count() && !discs.empty(); ++k) {
    const bool is_site = k >= body_count();
    if (!(is_site || is_ballistic(k)) || !has_closed_form(mover_of(k), mover_of(discs.front()))) continue;
    if (is_centred_disc(outline_of(k)))
      ++(is_site ? disc_sites : disc_bodies);
    else
      ++(is_site ? site_partners : partners);
  }
  const std::uint64_t n = bodies_.size(), pairs = n * (n - (n > 0)) / 2 + n * sites_.size();
  const std::uint64_t closed = disc_bodies * (disc_bodies - (disc_bodies > 0)) / 2 +
                               disc_bodies * (partners + disc_sites + site_partners) + partners * disc_sites;
  lines.push_back(
      switched(options_.skip_closed_forms, "solver.skip_closed_forms",
               fmt::format("pairs: {} of {} have a first contact in closed form", closed, pairs)));

  std::set<const Outline*> shapes, with_field;
  const auto look = [&](const Outline* o) {
    shapes.insert(o);
    if (!options_.skip_fields || static_cast<int>(o->sites.size()) >= options_.field.brute_force_below)
      with_field.insert(o);
  };
  for (const Body& b : world_.bodies) look(b.outline.get());
  for (const FixedSite& s : world_.sites) look(s.outline.get());
  lines.push_back(switched(
      options_.skip_fields, "solver.skip_fields",
      fmt::format(
          "fields: {} distinct shape(s), {} with a rendered field, {} of fewer than {} sites by brute force",
          shapes.size(), with_field.size(), shapes.size() - with_field.size(),
          options_.field.brute_force_below)));
  if (depth_)
    for (std::string& line : depth_->describe()) lines.push_back(std::move(line));
  const bool context = !with_field.empty() || passes_ || depth_;
  lines.push_back(context ? "GL context: needed (" + options_.field.context + ")" : "GL context: not needed");
  const bool friction = std::any_of(world_.materials.begin(), world_.materials.end(),
                                    [](const Material& m) { return m.friction > 0.0; });
  lines.push_back(friction ? "friction: solved" : "friction: none in this scene, left out");
  lines.push_back(switched(options_.skip_broad_phase, "solver.skip_broad_phase",
                           "broad phase: pairs whose moving bounds do not meet are left out"));
  return plan;
}

}  // namespace brink
