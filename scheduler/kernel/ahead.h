#pragma once
/// Collisions resolved ahead of time, before it was known that nothing earlier concerns their bodies.

#include <memory>
#include <span>
#include <vector>

#include "brink/scheduler/events/agenda.h"
#include "brink/scheduler/kernel/body_track.h"

namespace brink {

/// What there is to tell of a collision that has been resolved.
struct Outcome {
  PairKey pair;
  FeatureContact contact;
  double impulse_n = 0.0, impulse_t = 0.0;  ///< [N s]
  Real delay = 0;                           ///< from the clock to the moment of contact [s]
  double rest = 0.0;                        ///< since one of the two was last resolved [s]
};

/// One such collision: what it will tell when it is certain, and what it changed, so that it can be undone.
struct AheadCollision {
  struct Former {
    int body = -1;
    BodyTrack track;
  };
  struct Start {  ///< of a component that an integrator drives
    int component = -1;
    double time = 0.0;
    std::vector<BodyState> states;
  };

  double time = 0.0;  ///< [s]
  double end = 0.0;   ///< to which its bodies went on from there [s]
  Outcome outcome;
  std::vector<Former> former;  ///< every body that it changed, as it was
  std::vector<Start> starts;   ///< where their integrators were started

  const BodyTrack& former_of(int body) const {
    std::size_t k = 0;
    while (former[k].body != body) ++k;
    return former[k].track;
  }
};

/// All of them, by body and in order of time.
class AheadLog {
 public:
  using Entry = std::shared_ptr<AheadCollision>;

  bool empty() const { return kept_ == 0; }
  /// Former states of bodies that are kept.
  std::size_t kept() const { return kept_; }
  std::span<const Entry> of(int body) const {
    return static_cast<std::size_t>(body) < of_.size() ? std::span<const Entry>(of_[body])
                                                       : std::span<const Entry>();
  }
  /// @pre later than all that its bodies have.
  void add(Entry entry) {
    for (const AheadCollision::Former& f : entry->former) {
      if (static_cast<std::size_t>(f.body) >= of_.size()) of_.resize(f.body + 1);
      of_[f.body].push_back(entry);
    }
    kept_ += entry->former.size();
  }
  void remove(const Entry& entry) {
    for (const AheadCollision::Former& f : entry->former) std::erase(of_[f.body], entry);
    kept_ -= entry->former.size();
  }

 private:
  std::vector<std::vector<Entry>> of_;
  std::size_t kept_ = 0;
};

}  // namespace brink
