#include "brink/scheduler/zeno.h"

#include <algorithm>

namespace brink {

std::optional<ZenoEnding> ZenoWatch::collided(const PairKey& pair, double time, double closing_speed,
                                              double rest) {
  if (0.25 * closing_speed * rest > kHighFlight * tolerance_) return std::nullopt;
  Bounce& b = bounces_[pair];
  const bool first = b.count++ == 0;
  const double interval = time - b.last_time;
  b.last_time = time;
  if (first || interval <= 0.0)
    return std::nullopt;  // further impacts of one instant say nothing about flights
  const double ratio = b.last_interval > 0.0 ? interval / b.last_interval : 1.0;
  b.last_interval = interval;
  b.low_flights = 0.25 * closing_speed * interval < tolerance_ ? b.low_flights + 1 : 0;
  if (b.low_flights == 1) b.limit_time = ratio < 1.0 ? time + interval * ratio / (1.0 - ratio) : time;
  if (b.low_flights < kLowFlights) return std::nullopt;
  return ZenoEnding{pair, std::max(b.limit_time, time), b.count};
}

}  // namespace brink
