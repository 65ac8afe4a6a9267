#include "brink/scheduler/broad_phase/flight_batch.h"

namespace brink {

// The same operations in the same order with any of these instructions, so the same bits. Not with clang, whose
// version 14 gives the clones a name that other sources do not find.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define BRINK_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define BRINK_WIDE
#endif

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
