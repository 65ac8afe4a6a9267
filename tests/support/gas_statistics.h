#pragma once
/// What the kinetic theory of hard discs says, measured from a run's events.

#include "tests/support/gases.h"

namespace brink::testing {

/// Sums over the collisions of bodies with bodies from the `after`-th on.
class VirialSum : public Recorder {
 public:
  VirialSum(double diameter, std::uint64_t after) : diameter_(diameter), after_(after) {}
  void frame(double, std::span<const BodyState>) override {}
  void checkpoint(double, const std::vector<std::byte>&) override {}
  void event(const Event& e) override {
    if (e.kind != EventKind::collision || e.contact.other_body < 0 || ++seen_ < after_) return;
    last_ = e.contact.time;
    if (seen_ == after_) {
      first_ = last_;
      return;
    }
    ++collisions;
    virial += diameter_ * e.impulse_n;
  }
  double seconds() const { return last_ - first_; }

  std::uint64_t collisions = 0;
  double virial = 0.0;  ///< sum of diameter x normal impulse [J s]

 private:
  double diameter_;
  std::uint64_t after_, seen_ = 0;
  double first_ = 0.0, last_ = 0.0;
};

/// Z = PV / NkT of a periodic gas of discs of diameter 1 and mass 1, in two ways: from the momentum that
/// collisions carry (the virial theorem), and from how often they happen (Enskog: the rate of a disc is
/// 2 rho chi sqrt(pi kT / m), and Z = 1 + 2 phi chi).
struct Compressibility {
  double by_momentum = 0.0, by_rate = 0.0;
};

inline Compressibility measure_compressibility(int count, double packing, std::uint64_t collisions) {
  const World world = lattice_gas(count, make_disc(0.5), packing);
  const std::uint64_t warm = static_cast<std::uint64_t>(20 * count);  // to forget the lattice
  SolverOptions options;
  options.max_collisions = warm + collisions;
  Simulator simulator(world, options);
  VirialSum sum(1.0, warm);
  const RunSummary summary = simulator.run(until(1e9), &sum);
  const double energy = summary.energy_initial, kt = energy / count;  // of two degrees of freedom each
  const double density = count / world.periods.size.prod(), pi = std::numbers::pi;
  const double rate = 2.0 * static_cast<double>(sum.collisions) / (count * sum.seconds());
  return {1.0 + sum.virial / (2.0 * energy * sum.seconds()),
          1.0 + 2.0 * packing * rate / (2.0 * density * std::sqrt(pi * kt))};
}

}  // namespace brink::testing
