#pragma once
/// What the kernel takes for rounding, all in one place. Every one is a part of something of the scene or of the
/// pair; the margins of the search itself stand in scheduler/first_contact/tolerances.h.

#include "brink/core/base/limits.h"

namespace brink {

/// Of features that meet together with others, one that approaches slower than this part of their speed does
/// not approach: that is rounding, some thousand times kEpsilon for speeds a thousand times their difference.
inline constexpr double kApproaches = 1e-12;

/// A contact that parts faster than this part of the speeds that take part is none; slower is rounding, of the
/// speeds themselves (1e-16) and of the normal, which leans by the place's rounding over the radius it is
/// measured across: 1e-10 where that is a millionth of the coordinates.
inline constexpr double kPartsOfSpeed = 1e-6;
/// The same in a group, of the speed at which its contact was found.
inline constexpr double kParting = 1e-6;

/// Two features closer than this many contact tolerances, with one normal, are one contact: a disc on a disc is
/// found from both sides, each to within one tolerance of gap; a flat angle makes more of it along the surface.
inline constexpr double kSamePlace = 10.0;
/// Two normals are one with a cosine this near to 1: an angle of 1.4e-3, by which a contact's neighbour within
/// kSamePlace may lean on a curved outline that is larger than some ten thousand tolerances.
inline constexpr double kSameNormal = 1e-6;

/// Places in two doubles are rounded by less than this part of what they are made of: a thousand roundings (2^-100 each),
/// of which no double sees anything.
inline constexpr double kSameInTwoDoubles = 0x1p-90;

/// Overlaps at the start up to this part of the scene's length are let go: coordinates written with six digits.
inline constexpr double kStartOverlap = 1e-6;

/// Of a step's end, instants by which a search goes past it: whatever belongs to the instant in which the step ends is seen
/// before.
inline constexpr double kWholeInstant = 128.0;

/// Rounding of the doubled area between a wall and a point, of their coordinates times the wall's length: two
/// differences and two products of them, each half kEpsilon, make 7e-16 at most; the rest holds the rounding of the
/// coordinates themselves, a turn and a shift.
inline constexpr double kSideRounding = 4e-15;

}  // namespace brink
