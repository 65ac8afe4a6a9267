#include "brink/scheduler/broad_phase/flight_batch.h"

#include "brink/core/base/wide.h"

namespace brink {

BRINK_WIDE void FlightBatch::meet(const Course& a, double now) {
  const Course course = a;  // nothing that is written below is read by it
  // Whole registers of eight doubles: rows have room for that, and what is computed past size_ nobody
  // asks for.
  const int rounded_up = (size_ + 7) / 8 * 8;
  for (int i = 0; i < rounded_up; ++i)
    begin_[i] = meeting<false>(course, x_[i], y_[i], vx_[i], vy_[i], start_[i], radius_[i], disc_[i] != 0.0,
                               0.0, 0.0, now)
                    .begin;
}

}  // namespace brink
