#pragma once
/// What bodies were before collisions that were resolved ahead of time: to be confirmed, or undone.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "brink/scheduler/events/agenda.h"
#include "brink/scheduler/kernel/trajectories.h"
#include "brink/scheduler/resolve/zeno.h"

namespace brink {

/// What there is to tell of a collision that has been resolved.
struct Outcome {
  PairKey pair;
  FeatureContact contact;
  double impulse_n = 0.0, impulse_t = 0.0;  ///< [N s]
  Real delay = 0;                           ///< from the clock to the moment of contact [s]
  double since_last = 0.0;                  ///< since one of the two was last resolved [s]
  ForeseenLimit limit;                      ///< of a series of bounces that this is one of
  EventSide body = {}, other = {};          ///< if somebody is to be told
};

/// One collision ahead of time: what it will tell when it is certain, and what it changed.
struct AheadCollision {
  struct Former {
    int body = -1;
    BodyTrack track;
  };

  double time = 0.0;  ///< [s]
  double end = 0.0;   ///< to which its bodies went on from there [s]
  Outcome outcome;
  std::vector<Former> former;          ///< every body that it changed, as it was
  std::vector<ComponentStart> starts;  ///< where their integrators were started

  const BodyTrack& former_of(int body) const {
    std::size_t k = 0;
    while (former[k].body != body) ++k;
    return former[k].track;
  }
};

/// The log of them, by body and in order of time.
class Speculation {
 public:
  using Entry = std::shared_ptr<AheadCollision>;

  Speculation(Trajectories& trajectories, RunControl& run) : trajectories_(&trajectories), run_(&run) {}

  bool empty() const { return kept_ == 0; }
  /// Former states of bodies that are kept.
  std::size_t kept() const { return kept_; }
  std::span<const Entry> of(int body) const {
    return static_cast<std::size_t>(body) < of_.size() ? std::span<const Entry>(of_[body])
                                                       : std::span<const Entry>();
  }

  // -- motions that a body has --
  /// The body as of its last collision that is certain.
  const BodyTrack& certain(int k) const;
  /// The body with its motion of that version; null if there is none.
  const BodyTrack* track(int k, std::uint64_t version) const;
  /// Motions that body k certainly has now, and after collisions ahead of time, in order.
  std::vector<std::uint64_t> versions(int k) const;
  /// When that motion ends in a collision ahead of time; infinity: it is the newest. Nothing if it was
  /// undone, or has ended for certain.
  std::optional<double> end_of_version(int k, std::uint64_t version) const;

  // -- the log --
  /// Everything that a collision of the pair at the present time can change, as it is now.
  Entry before(const PairKey& pair) const;
  /// @pre later than all that its bodies have.
  void add(const Entry& entry);
  /// It is certain now.
  void remove(const Entry& entry);
  /// Puts back what it changed. @pre nothing hangs on it.
  void undo(const Entry& entry);
  /// Takes a body back to its motion of that version and to time t, and everyone whose collisions hang on
  /// what is undone; they are appended to `undone`. @pre one of versions(body).
  void roll_back(int body, std::uint64_t version, double t, std::vector<int>& undone);
  void roll_back_all();
  /// Swaps bodies that were resolved ahead of time with what they certainly are.
  void swap_with_certain();

 private:
  struct Undone {  ///< a body and the times between which it is undone
    int body;
    double from, to;
  };
  void undo_last(int body, std::vector<Undone>& taken_back);

  Trajectories* trajectories_;
  RunControl* run_;
  std::vector<std::vector<Entry>> of_;
  std::size_t kept_ = 0;
};

}  // namespace brink
