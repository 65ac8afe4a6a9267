#include "brink/scheduler/run/options.h"

#include <fmt/core.h>

#include <array>
#include <cmath>

#include "brink/core/base/error.h"

namespace brink {

namespace {

/// As `Order` numbers them: order_of() finds them by place.
constexpr std::array kOrders{
    Choice{"index", "lowest body, other, site and sample first"},
    Choice{"closing_speed", "fastest approach first"},
    Choice{"depth", "smallest gap first"},
    Choice{"random", "drawn with the scene's seed"},
    Choice{"lcp",
           "all that hang together at once: Newton's law at every contact (a complementarity problem)"},
    Choice{"reflections",
           "all that hang together: generalized reflections until none approaches (Smith et al. 2012)"},
};
constexpr std::array kResponses{
    Choice{"impulse", "Newton restitution and Coulomb friction in closed form"},
    Choice{"reflection", "the classic mirror rebound with slip and spin scalars; not exact"},
};
constexpr std::array kDetectors{
    Choice{"field", "candidates from each body's own rendered Voronoi field, answers in double precision"},
    Choice{"pass", "near owners from rendered pass windows, then the same exact search"},
    Choice{"depth", "the classic method: particles read rendered depth; approximate, with steps of `step`"},
};

/// For messages: what is allowed, with commas.
std::string names_of(std::span<const Choice> choices) {
  std::string text;
  for (const Choice& c : choices) text += (text.empty() ? "" : ", ") + std::string(c.name);
  return text;
}

/// True if it is one of the choices; else *error says of which option, what was given, and what is allowed.
bool known(std::span<const Choice> choices, const std::string& given, const char* option,
           std::string* error) {
  for (const Choice& c : choices)
    if (c.name == given) return true;
  *error = fmt::format("{} = \"{}\" is not known; allowed: {}", option, given, names_of(choices));
  return false;
}

/// Likewise of a number; neither NaN nor infinity will do.
bool positive(double value, const char* option, std::string* error) {
  if (std::isfinite(value) && value > 0.0) return true;
  *error = fmt::format("{} = {} must be a finite number > 0", option, value);
  return false;
}

bool not_negative(double value, const char* option, std::string* error) {
  if (std::isfinite(value) && value >= 0.0) return true;
  *error = fmt::format("{} = {} must be a finite number >= 0", option, value);
  return false;
}

}  // namespace

std::span<const Choice> orders() { return kOrders; }
std::span<const Choice> responses() { return kResponses; }
std::span<const Choice> detectors() { return kDetectors; }

Order order_of(std::string_view name) {
  for (std::size_t k = 0; k < kOrders.size(); ++k)
    if (kOrders[k].name == name) return static_cast<Order>(k);  // listed as they are numbered
  throw BadInput(fmt::format("order = \"{}\" is not known; allowed: {}", name, names_of(kOrders)));
}

/// The first fault that is met is told, no more.
bool SolverOptions::is_valid(std::string* error) const {
  // First: order_of() throws on a name that is not known.
  if (!known(orders(), order, "order", error)) return false;
  // A group is resolved by impulses at features: the mirror has no impulses of several contacts, and a picture
  // names no features.
  if (takes_together(order_of(order)) && (response == "reflection" || detector == "depth")) {
    *error = fmt::format(
        "order = \"{}\" needs response = \"impulse\" and an exact detector (field, pass); given response = "
        "\"{}\", "
        "detector = \"{}\"; allowed with these: index, closing_speed, depth, random",
        order, response, detector);
    return false;
  }
  return known(policies(), policy, "policy", error) && known(responses(), response, "response", error) &&
         known(detectors(), detector, "detector", error) && not_negative(rest_speed, "rest_speed", error) &&
         not_negative(island_tolerance, "island_tolerance", error) &&
         positive(contact_tolerance, "contact_tolerance", error) && positive(step, "step", error) &&
         integrator_options().is_valid(error) && field.is_valid(error);
}

}  // namespace brink
