#include "brink/scheduler/broad_phase/flight_batch.h"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace brink {

namespace {

// A flight is two rows: x, y, vx, vy; and start, radius, the cell, and what ends with the bit `disc`.
static_assert(sizeof(Flight) == 2 * sizeof(Four) && offsetof(Flight, x) == 0 && offsetof(Flight, y) == 8 &&
              offsetof(Flight, vx) == 16 && offsetof(Flight, vy) == 24 && offsetof(Flight, start) == 32 &&
              offsetof(Flight, radius) == 40 && std::endian::native == std::endian::little);

/// Rows as columns, four by four: from memory to memory, in registers.
[[gnu::always_inline]] inline void transpose(const double* const (&rows)[4], double (&columns)[4][4]) {
  const auto row = [&](int k) __attribute__((always_inline))->const Four& {
    return *reinterpret_cast<const Four*>(rows[k]);
  };
  const Four even01 = __builtin_shufflevector(row(0), row(1), 0, 4, 2, 6),
             odd01 = __builtin_shufflevector(row(0), row(1), 1, 5, 3, 7),
             even23 = __builtin_shufflevector(row(2), row(3), 0, 4, 2, 6),
             odd23 = __builtin_shufflevector(row(2), row(3), 1, 5, 3, 7);
  four(columns[0]) = __builtin_shufflevector(even01, even23, 0, 1, 4, 5);
  four(columns[1]) = __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5);
  four(columns[2]) = __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
  four(columns[3]) = __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
}

}  // namespace

BRINK_WIDE void FlightBatch::meet(int count, const Flight* flights, const Course& a, double now) {
  const Course course = a;  // nothing that is written below is read by it
  count_ = count;
  // the last four are whole: somebody in the place of who is not there
  for (int i = 0; i < 3; ++i) bodies_[count + i] = bodies_[0];
  for (int i = 0; i < count; i += 4) {
    const double* ways[4];
    const double* rests[4];
    for (int k = 0; k < 4; ++k) {
      const Flight& f = flights[bodies_[i + k]];
      ways[k] = &f.x;
      rests[k] = &f.start;
    }
    alignas(sizeof(Four)) double way[4][4], rest[4][4];
    transpose(ways, way);
    transpose(rests, rest);
    for (int k = 0; k < 4; ++k) {
      const bool disc = std::bit_cast<std::int64_t>(rest[3][k]) < 0;
      begin_[i + k] = meeting<false>(course, way[0][k], way[1][k], way[2][k], way[3][k], rest[0][k],
                                     rest[1][k], disc, 0.0, 0.0, now)
                          .begin;
    }
  }
}

}  // namespace brink
