#pragma once
/// What policies share that look at everything up to a common horizon and then deal with what they found.

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "brink/scheduler/kernel/kernel.h"

namespace brink {

/// What a horizon had.
struct HorizonTally {
  std::size_t pairs = 0;  ///< that could meet in it
  /// Bodies whose motion began anew, counted each time: what they had ahead was for nothing.
  std::size_t restarts = 0;
};

/// Horizon after horizon to `until`, longer while little happens, shorter while much does: that changes what
/// work is done, never what happens. `run_one` takes the kernel to a horizon's end; it returns nothing on a halt.
/// It may come less far: where a motion fails, or an instalment of it ends.
void run_horizons(Kernel& kernel, double until,
                  const std::function<std::optional<HorizonTally>(double end)>& run_one);

/// How far a horizon, or a run, to `end` looks [s]: what belongs to one instant is chosen from together, as by a policy that knows no
/// horizons, and as by a run that goes on; so an instant that begins by the end is seen whole.
double seen_beyond(double end);

/// Lets motions go on towards `end`, and says how far all can be looked at [s]: to where they cover and, in a plane that
/// repeats, no body passes more than a few periods. One that passes many is near as many images of everybody. A policy
/// that knows horizons asks for motions by this alone.
double look_ahead(Kernel& kernel, double end);

/// Of a horizon from `begin` to `end` that could look as far as `seen` [s], the last time at which anything in it may
/// begin: the end, if an instant that begins there is seen; but where a motion fails.
double last_beginning(const KernelView& kernel, double begin, double end, double seen);

/// Certificates of one horizon: who meets whom before its end.
class HorizonAgenda {
 public:
  /// Looks at every pair that can meet during [from, end]. False on a halt.
  bool pass(Kernel& kernel, double from, double end);
  /// The same for bodies whose motion a resolve has changed just now. False on a halt.
  bool pass_again(Kernel& kernel, std::span<const int> changed, double end);
  /// The next contact that begins by `last`, by time and by the option `order`.
  std::optional<Certificate> take_earliest(Kernel& kernel, double last);
  /// Goes on with a search that stopped at its cap; gives up where a hundred such in a row led nowhere. False
  /// on a halt.
  bool search_on(Kernel& kernel, const Certificate& c, double end);

  /// Pairs that the last pass() or pass_again() looked at.
  const std::vector<PairKey>& pairs() const { return pairs_; }

 private:
  void test(Kernel& kernel, const PairKey& pair, double from, double end);
  void insert(Kernel& kernel, const Certificate& c);

  Agenda agenda_;
  std::vector<PairKey> pairs_;
  int undecided_ = 0;  ///< searches in a row that met their cap
};

}  // namespace brink
