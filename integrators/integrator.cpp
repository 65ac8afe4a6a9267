#include "brink/integrators/integrator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <sstream>

#include "brink/core/base/error.h"
#include "brink/integrators/closed_form.h"
#include "brink/integrators/fixed_step.h"
#include "brink/integrators/sundials.h"

namespace brink {

namespace {

/// In the order in which they are listed. make_integrator() has a line for each.
constexpr std::array<IntegratorInfo, 8> kIntegrators{{
    {"auto", "closed form where the forces allow it (constant, or linear drag), erk otherwise"},
    {"ballistic", "closed form only: no force, uniform gravity, thrust, linear drag; exact, no steps"},
    {"euler", "explicit Euler, fixed step, order 1: a baseline that gains energy"},
    {"semi_implicit_euler", "semi-implicit (symplectic) Euler, fixed step, order 1"},
    {"rk4", "classic Runge-Kutta, fixed step, order 4"},
    {"erk", "SUNDIALS ERKStep, adaptive Dormand-Prince 5(4): the general choice"},
    {"adams", "SUNDIALS CVODE, adaptive Adams-Moulton, orders 1 to 12: smooth forces, tight tolerances"},
    {"bdf", "SUNDIALS CVODE, adaptive BDF, orders 1 to 5: stiff forces"},
}};

/// Levenshtein distance: single-letter changes between two names.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  // row[j]: changes from the first letters of a to the first j of b (Wagner & Fischer
  // 1974); one row is enough
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      // Letters differ: change one. Else leave one out of either name. `diagonal` is row[j] of the row
      // before.
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// @throws BadInput with the known name that is fewest letters away, and all of them.
[[noreturn]] void fail_unknown(std::string_view name) {
  const auto nearest =
      std::min_element(kIntegrators.begin(), kIntegrators.end(), [&](const auto& a, const auto& b) {
        return edit_distance(name, a.name) < edit_distance(name, b.name);
      });
  std::string message = "integrator \"" + std::string(name) + "\" is not known; did you mean \"" +
                        std::string(nearest->name) + "\"? allowed:";
  for (const IntegratorInfo& info : kIntegrators) message.append(" ").append(info.name);
  throw BadInput(message);
}

/// `ok`; where it is false, why goes to *error. NaN fails every comparison, so `ok` is false for it.
bool check_option(const char* name, double value, bool ok, const char* allowed, std::string* error) {
  if (ok || !error) return ok;
  std::ostringstream out;
  out << name << " is " << value << "; allowed: " << allowed;
  *error = out.str();
  return ok;
}

}  // namespace

bool IntegratorOptions::is_valid(std::string* error) const {
  return check_option("tolerance", tolerance, tolerance >= 1e-14 && tolerance <= 0.1, "1e-14 to 0.1",
                      error) &&
         check_option("absolute_tolerance", absolute_tolerance,
                      std::isfinite(absolute_tolerance) && absolute_tolerance > 0.0, "finite numbers > 0",
                      error) &&
         check_option("step", step, std::isfinite(step) && step > 0.0, "finite numbers > 0 (seconds)", error);
}

// `brink list` shows these.
std::span<const IntegratorInfo> integrators() { return kIntegrators; }

std::unique_ptr<Integrator> make_integrator(std::string_view name, std::shared_ptr<Dynamics> dynamics,
                                            const IntegratorOptions& options, WorkCounters* work) {
  if (!dynamics || dynamics->size() <= 0)
    throw BadInput("make_integrator: dynamics of no body; allowed: at least one");
  std::string error;
  // All options, also those that this method does not use: a scene is as valid under any of them.
  if (!options.is_valid(&error)) throw BadInput("integrator option " + error);
  // `auto` goes by the forces alone, never by states: the choice is the same whenever it is made.
  const bool closed = has_closed_form(*dynamics);
  if (name == "auto") name = closed ? "ballistic" : "erk";
  if (name == "ballistic") {
    if (closed) return make_closed_form(std::move(dynamics), work);
    throw BadInput(
        "integrator \"ballistic\" needs a closed form: no force but uniform gravity, thrust and linear drag; "
        "these "
        "forces have none (choose \"auto\")");
  }
  if (name == "euler") return make_euler(std::move(dynamics), options.step, work);
  if (name == "semi_implicit_euler") return make_semi_implicit_euler(std::move(dynamics), options.step, work);
  if (name == "rk4") return make_rk4(std::move(dynamics), options.step, work);
  if (name == "erk") return make_erk(std::move(dynamics), options, work);
  if (name == "adams") return make_adams(std::move(dynamics), options, work);
  if (name == "bdf") return make_bdf(std::move(dynamics), options, work);
  fail_unknown(name);
}

}  // namespace brink
