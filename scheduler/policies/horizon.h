#pragma once
/// What policies share that look at everything up to a common horizon and then deal with what they found.

#include <optional>
#include <span>
#include <vector>

#include "brink/scheduler/kernel.h"

namespace brink {

/// The length of horizons: longer while little happens, shorter while much does. It changes what work is
/// done, never what happens.
class HorizonLength {
 public:
  /// The end of the next horizon from the present time [s].
  static double next_end(Kernel& kernel, double until);
  /// Learns from a horizon that had so many near pairs and collisions.
  static void adapt(Kernel& kernel, std::size_t pairs, std::uint64_t collisions);
};

/// Certificates of one horizon: who meets whom before its end.
class HorizonAgenda {
 public:
  /// Looks at every pair that can meet during [from, end]. False on a halt.
  bool pass(Kernel& kernel, double from, double end);
  /// The same for bodies whose motion a resolve has changed just now. False on a halt.
  bool pass_again(Kernel& kernel, std::span<const int> changed, double end);
  /// The next contact, by time and by the option `order`.
  std::optional<Certificate> take_earliest(Kernel& kernel);
  /// Goes on with a search that stopped at its cap; gives up where a hundred such in a row led nowhere. False
  /// on a halt.
  bool search_on(Kernel& kernel, const Certificate& c, double end);

  /// Pairs that the last pass() or pass_again() looked at.
  const std::vector<PairKey>& pairs() const { return pairs_; }

 private:
  void test(Kernel& kernel, const PairKey& pair, double from, double end);

  Agenda agenda_;
  std::vector<PairKey> pairs_;
  int undecided_ = 0;  ///< searches in a row that met their cap
};

}  // namespace brink
