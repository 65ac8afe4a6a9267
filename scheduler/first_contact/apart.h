#pragma once
/// Pairs that are told to be apart at a glance: by shapes that hold their outlines, before any feature is looked at.

#include "brink/scheduler/first_contact/first_contact.h"

namespace brink::detail {

/// What is told without a look at features.
struct Apart {
  double until;          ///< the pair is clear [s]
  bool stopped = false;  ///< for want of steps: it may be clear for longer
};

/// Until when the pair is sure to be clear by the discs that hold the two outlines, by the smaller one's disc
/// beside a wall, or by a line between the two hulls: `to` or more, or a time short of their contact, which may be the
/// pair's and wants polishing from before. `from` where nothing is told: of containers, and of what is near. Cost: a few
/// certified steps, of hulls no more than `limits` has.
Apart apart_until(const Mover& a, const Mover& b, double from, double to, const SearchLimits& limits);

}  // namespace brink::detail
