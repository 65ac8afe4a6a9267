#pragma once
/// What counts as one direction, one length of time, one series of bounces where impulses are found: all in one
/// place. Every one is a part of something of the pair's own, never a length or a speed by itself.

#include <cstdint>

namespace brink {

/// Below this part of the bounding radius a difference of points has no direction worth its digits: points
/// rounded to 1e-16 of it leave 1e-10 of the direction.
inline constexpr double kNoDirection = 1e-6;

/// Two unit normals with this cosine or more are one, but for rounding: 1e-12 is an angle of 1.4e-6, what
/// kNoDirection leaves room for.
inline constexpr double kSameDirection = 1.0 - 1e-12;

/// Sine of an angle that rounding alone may make of two parallel edges: an edge of a millionth of the
/// coordinates it is made of keeps ten digits.
inline constexpr double kParallelEdges = 1e-6;

/// A series of bounces is taken to its limit after so many low flights: their height falls by the square of the
/// restitution each time, so ten tell a series from chance at any restitution below 1.
inline constexpr std::uint64_t kLowFlights = 10;
/// After so many where flights have come down to the touching distance: below that bounces are roundings.
inline constexpr std::uint64_t kShortSeries = 2;
/// Nor are flights told that rise to less than so many roundings of their gap.
inline constexpr double kLeastRise = 8.0;
/// Flights that rise so many contact tolerances are not remembered: at a restitution of 0.5 ten bounces later
/// one is a low flight, and is remembered then.
inline constexpr double kHighFlight = 1e6;
/// Limits that are foreseen by a closed form are one series' while they agree to this part of what is left:
/// times and speeds of high flights keep ten digits.
inline constexpr double kAlikeLimit = 1e-6;
/// And the form is the flights' own if it agrees with their intervals to this part of what is left: those of a
/// body that turns shrink by another ratio.
inline constexpr double kAlikeForm = 1e-2;
/// Intervals with a ratio so near to 1 are of one length: each is the difference of two times, which keeps ten
/// digits until it has come down to a millionth of the time itself.
inline constexpr double kAlike = 1e-6;

}  // namespace brink
