#include "brink/scheduler/resolve/zeno.h"

#include <algorithm>
#include <cmath>

#include "brink/scheduler/first_contact/tolerances.h"
#include "brink/scheduler/resolve/tolerances.h"

namespace brink {

namespace {

/// Of a series that shrinks the speeds shrink by this part of what the flights do, at least.
constexpr double kSlower = 0.1;

/// A flight that rose above the tolerance: the run is over.
void end_run(ZenoWatch::Bounce& b) {
  b.low_flights = 0;
  b.limit_time = 0.0;
  b.shortest = std::numeric_limits<double>::infinity();
}

}  // namespace

/// A flight of duration T on a parabola that ends with v = g T / 2 rose by v^2 / (2 g) = v T / 4.
bool ZenoWatch::is_high(double closing_speed, double since_last, double contact_tolerance) {
  return 0.25 * closing_speed * since_last > kHighFlight * contact_tolerance;
}

std::optional<ZenoEnding> ZenoWatch::collided(const Feature& feature, double time, double closing_speed,
                                              BounceLoss loss, double since_last, bool sunk,
                                              const ForeseenLimit& foreseen, double rounding) {
  if (loss == BounceLoss::none || is_high(closing_speed, since_last, tolerance_)) return std::nullopt;
  // remembered from here on: high flights have not come so far (kHighFlight)
  Bounce& b = bounces_[feature];
  const double left = foreseen.time - time;
  // While they agree the earliest one stays: the higher the flight, the finer its limit. No limit (0) agrees with
  // none.
  if (!(std::abs(foreseen.time - b.foreseen) <= kAlikeLimit * left + foreseen.rounding))
    b.foreseen = foreseen.time;
  const bool first = b.count++ == 0;
  const double interval = time - b.last_time;
  b.last_time = time;
  if (first || interval <= 0.0)
    return std::nullopt;  // further impacts of one instant say nothing about flights
  // of the first interval nothing is known: as if it were of one length
  const double ratio = b.last_interval > 0.0 ? interval / b.last_interval : 1.0;
  b.last_interval = interval;
  // of a series both go alike; between two that close in only the way does
  const bool slower = closing_speed <= b.last_closing * (1.0 - kSlower * (1.0 - std::min(ratio, 1.0)));
  b.last_closing = closing_speed;
  if (0.25 * closing_speed * interval >= tolerance_) {
    end_run(b);
    return std::nullopt;
  }
  // the flights to come last interval (r + r^2 + ...) = interval r / (1 - r)
  if (b.limit_time == 0.0 && loss != BounceLoss::all && ratio < 1.0 - kAlike && slower)
    b.limit_time = time + interval * ratio / (1.0 - ratio);
  const bool pressed = sunk || loss == BounceLoss::all || (since_last >= interval && ratio <= 1.0 + kAlike);
  // others are low, but say nothing: they neither count nor end the run
  if ((interval < b.shortest && slower) || pressed) ++b.low_flights;
  b.shortest = std::min(b.shortest, interval);
  // a series that shrinks ends where its flights come down to roundings: what bounces on after is pressed
  const double rose = 0.25 * closing_speed * interval, will_rise = rose * ratio * ratio;
  const bool run_out =
      b.limit_time > 0.0 && ((b.low_flights >= kShortSeries && rose < kTouchOfTolerance * tolerance_) ||
                             (b.low_flights > 0 && will_rise < kLeastRise * rounding));
  if (b.low_flights < kLowFlights && !run_out) return std::nullopt;
  // a limit foreseen in closed form is the finer one, if these flights follow that form at all
  const double seen = std::max(b.limit_time, time);
  const double beside = std::abs(foreseen.time - seen);
  const bool alike = foreseen.time > 0.0 && beside <= kAlikeForm * (seen - time) + foreseen.rounding;
  return ZenoEnding{feature.pair, alike ? std::max(b.foreseen, time) : seen, b.count};
}

}  // namespace brink
