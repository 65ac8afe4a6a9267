#pragma once
/// What counts as one point, one direction, no motion, no force where islands move, all in one place. Every one is a part of
/// something of the island's own; how many looks, passes and tries there are stands beside what makes them. The search's
/// own margins are in scheduler/first_contact/tolerances.h.

#include "brink/core/base/extended.h"

namespace brink {

// -- features that are near (near_features.h) --

/// Below this part of the size two points are one, and their difference has no direction: places seen from the pair
/// are rounded to 1e-16 of the size, a few thousand times less.
inline constexpr double kOnePoint = 1e-12;
/// What is no farther beyond an end than this part of how far off it is is beside it.
inline constexpr double kBeside = 0.5;
/// Corners of solids that are so near, of their sizes, lie on each other: contacts keep their gaps no better than to
/// the contact tolerance, 1e-10 of the scene's length by default.
inline constexpr double kOneCorner = 1e-10;
/// And corners that are so near, of the contact tolerance where that is known: sunk by it from two sides of a tip of 60 degrees,
/// a place is two of it off the tip.
inline constexpr double kCornerOfTolerance = 2.0;
/// What lies nearer to a wire than this part of its own radius may be on either side by roundings of all that has
/// moved it, and what is nearer by it to the centre of a solid's arc than the arc is has sunk into it: ten thousand contact
/// tolerances, as an overlap at the start may be.
inline constexpr double kSunkOfRadius = 1e-6;
/// An arc that looks past a site by no more than this may come to face it within a step [rad]: a step moves no point of a body
/// by more than a tenth of the smallest member's size, if no impulse does.
inline constexpr double kTurnedInStep = 0.5;
/// What a sample may come to over a hump in a step looks away from what is nearest to it by 60 degrees at most (its cosine).
inline constexpr double kOverHump = 0.5;
/// Two sites go on into each other where their directions are opposite to this: within some 1e-5 rad.
inline constexpr double kSmoothJoint = 1e-10;
/// Sine of an angle between an edge and a wire that it lies along: far more than roundings of directions make of none, far
/// less than an angle at which a body leans on it.
inline constexpr double kAlongLine = 1e-6;
/// Cosine between a site's normal, or the way to it, and the next site that roundings may leave of a straight joint: ends that
/// are written to 1e-16 of the outline's size leave 1e-9 of the direction of a piece of a ten-millionth of it.
inline constexpr double kStraightJoint = 1e-9;
/// Two unit normals whose cosine is so near to 1 are one side's: an angle of 4.5e-5, below that of any corner that is
/// one.
inline constexpr double kOneSide = 1e-9;

// -- rest --

/// Cones of friction are so many times as wide where a step has held bodies still: the friction that it had was found by sweeps,
/// which leave some hundredths of the largest force.
inline constexpr double kWidened = 1.03;

// -- steps at the level of velocities (island_step.h) --

/// A gap that is missed by less than this part of the tolerance is not made up for: ten such misses in a row keep the
/// tolerance still.
inline constexpr double kMissCounts = 0.1;
/// What bends between looks by less than this part of the tolerance dips by nothing that counts: by half as much at most, a
/// two-hundredth of kMissCounts.
inline constexpr double kNoDip = 1e-3;
/// A correction lifts by so much of what was missed: by more than the rounding of the solve, by less than kMissCounts
/// would see.
inline constexpr double kAimHigher = 1.001;
/// Where that would take a speed that the step has not, no further than to this part of the tolerance below 0: the
/// solver's own miss must not lead beyond the tolerance itself.
inline constexpr double kLeftBelow = 0.95;
/// What the solver may miss, of the step's speed: gaps and energy are looked at themselves, so it need only be small
/// beside kWonOf.
inline constexpr double kResidual = 1e-6;
/// A step may win this part of the energies that it turns over, before it is slowed to win none: the solver's
/// rounding, and what faces that turn push into what lies on them, which the true motion takes from their
/// turning.
inline constexpr double kWonOf = 1e-3;
/// Sites push along one line if sines of angles between their pushes are below this.
inline constexpr double kOnePush = 1e-9;
/// Friction bounds are exact that are wrong by no more than this part of the largest force: the solver's own digits.
inline constexpr double kFrictionExact = 1e-9;
/// And good enough: the order of what a step of order 1 is off anyway (kWonOf).
inline constexpr double kFrictionNear = 1e-3;

// -- motion by modes (modes/) --

/// An acceleration below this part of the numbers that it is made of is none: a thousand roundings of a double, which the
/// rates are made of, however many digits the solution has.
inline constexpr Real kNoAcceleration = 1e-13;
/// A gap that closes slower than this part of the speeds that take part does not: ten thousand roundings of them.
inline constexpr double kNoClosing = 1e-12;
/// A slip slower than this part of the speeds that take part is none, likewise.
inline constexpr double kNoSlip = 1e-12;
/// And where modes are chosen anew, as bounces that have ended leave it, whose normals are told to 1e-9.
inline constexpr double kNoSlipAtFirst = 1e-9;
/// Speeds are never measured by less than this part of the size a second: so that there is something to measure by where nobody
/// moves and nothing pulls.
inline constexpr double kLeastSpeed = 1e-9;
/// Modes are chosen from so far ahead, of a step: what fails has failed there beyond rounding, which at 1e-16 of the
/// state leaves ten digits, and nothing else has changed by more than 1e-5.
inline constexpr double kAhead = 1e-5;
/// Where a feature is left the step leads beyond its end, by this part of the size: a tenth of kOneCorner, and a hundred thousand
/// roundings.
inline constexpr double kBeyondEnd = 1e-11;
/// A step of less than this part of the longest is next to no time: modes that change into each other there must run out.
inline constexpr double kNoTime = 1e-9;
/// What is left of the time to the step's end, if no more than this part of the step, goes with it: no step is made of a
/// rounding.
inline constexpr double kSameEnd = 1e-9;
/// The least error by which the next step is chosen, so that its root is a number: it is limited to a growth of 4, that of
/// an error of 6e-4, anyway.
inline constexpr double kLeastError = 1e-10;
/// Newton's method has put gaps to zero at this part of the size: some roundings of a place.
inline constexpr double kGapIsZero = 1e-15;
/// A point nearer to a circle's centre than this part of what it is made of has no direction from it: of points
/// rounded to 1e-16 that leaves seven digits.
inline constexpr double kAtCentre = 1e-9;
/// And bounds that grow towards the centre are taken at this part of the distance at least: nearer they say nothing.
inline constexpr double kNearCentre = 1e-3;

// -- forces of modes (modes/mode_forces.h) --

/// Rows that depend on each other to this part are redundant: rows of length one are rounded to 1e-16, and a
/// million times that is no force of the world's.
inline constexpr double kRedundant = 1e-10;
/// A contact that is closed is off its gap by no more than this part of the size: steps are shortened until that holds.
inline constexpr double kOnContact = 1e-6;
/// Of rows by which places and velocities are put onto contacts: what these are off by moves nobody by more than 1 / this of it.
inline constexpr double kNearlyRedundant = 1e-4;
/// What accelerations may miss of closed contacts, of the largest that takes part: what rows as near to redundant as kRedundant
/// lets them be lose, and a hundred times more.
inline constexpr double kConsistent = 1e-8;
/// Forces of redundant contacts balance when they leave over this part: ten thousand roundings.
inline constexpr double kBalances = 1e-12;
/// A force below this part of the weight of the heaviest member is none.
inline constexpr double kNoForce = 1e-9;
/// Contacts hold an island of many bodies at rest that are open by no more than this part of the smallest member's size: some
/// hundredths of what a step of first order leaves places off by.
inline constexpr double kHolds = 1e-4;
/// A column joins the least squares if it reduces what is left by more than this part of all: below it is rounding.
inline constexpr double kJoins = 1e-14;

}  // namespace brink
