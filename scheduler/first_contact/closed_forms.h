#pragma once
/// First contact by a quadratic: a disc against a disc, or against segments that do not turn, both on
/// parabolas.

#include "brink/scheduler/first_contact/first_contact.h"

namespace brink {

/// g(s) = value + rate s + half_of_second * s^2: the quadratics of this file.
struct Quadratic {
  double value = 0.0, rate = 0.0, second = 0.0;  ///< second derivative
  double at(double s) const { return value + s * (rate + 0.5 * s * second); }
  double slope(double s) const { return rate + s * second; }
};

/// The s at which g falls through zero, or infinity. It is unique: on a parabola open downward the later
/// root, on one open upward the earlier. Free of cancellation. May lie in the past (s < 0) where g is already
/// below zero.
double falling_root(const Quadratic& g);

/// A centred disc on a parabola: all of a Mover that its quadratics ask for.
struct DiscMover {
  const Motion* motion = nullptr;
  double radius = 0.0;  ///< of its one site, and of its bounds [m]
  double velocity_rounding = 0.0;
};

/// A contact of two discs at a level of 0, without its place.
struct DiscContact {
  double time = 0.0;           ///< [s]
  double gap = 0.0;            ///< [m]
  double closing_speed = 0.0;  ///< [m/s], to roundings
};

/// Two discs' contact in [from, to] in closed form, when first_contact() tells it. False: there is none that is told
/// here, be it that they are clear, that they begin where they touch or that the general search must tell; ask
/// first_contact() then. @pre both motions are parabolas that cover [from, to]. Cost: where neither is accelerated and
/// nothing is near a rounding half of that of first_contact_in_closed_form().
bool discs_meet(const DiscMover& a, const DiscMover& b, double from, double to, const SearchLimits& limits,
                DiscContact& contact);
/// All of that contact, as it is seen from the world's origin.
FeatureContact contact_of_discs(const DiscMover& a, const DiscMover& b, double time);

/// True if the pair has a closed form and `answer` was filled; false: ask the general search.
/// Cases: discs under equal acceleration; a disc against an outline of segments that does not turn, while the
/// disc's centre stays abreast of each segment that it could reach.
///
/// A contact's time is the general search's, to the last bit; two discs' contact is so in every field, a
/// segment's place and normal are those of the quadratic (first_contact() looks again). Cost: two discs that
/// do not meet before `to` a square root or none; two that do a dozen gaps more, to find the canonical time
/// (brink_bench_first_contact: search/discs_that_miss, search/discs).
bool first_contact_in_closed_form(const Mover& a, const Mover& b, double from, double to,
                                  const SearchLimits& limits, SearchScratch& scratch, PairAnswer& answer);

/// True if first_contact_in_closed_form may succeed for these outlines and motions (the plan's question).
bool has_closed_form(const Mover& a, const Mover& b);

}  // namespace brink
