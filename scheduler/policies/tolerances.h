#pragma once
/// Times that policies take for the same or for none, all in one place. What exact policies find does not depend
/// on them.

namespace brink {

/// The least horizon [s]; of the first, a part of the run's end: shorter ones would only repeat broad phases, and
/// no run could do a billion of them.
inline constexpr double kShortestHorizon = 1e-9;

/// No horizon is made shorter than this part of the time in which a body crosses itself for the sake of pairs that are near.
inline constexpr double kOfCrossing = 1.0 / 64.0;

/// How far a body may go in a horizon, its own size with it, where the plane repeats [periods].
inline constexpr double kMostPeriods = 6.0;

/// A time that lies this part of a step before a step's end is that end: a quotient of times is told to 1e-16 of
/// itself, so up to ten million steps are counted right.
inline constexpr double kSameStep = 1e-9;

/// Searches in a row that may end undecided, each beginning where the last ended, before the run says so.
inline constexpr int kMostUndecided = 100;

}  // namespace brink
