#pragma once
/// From features that are close to the contact: when the two of one meet, and which of a search's is the earliest.

#include <algorithm>
#include <optional>

#include "brink/scheduler/first_contact/corners.h"
#include "brink/scheduler/first_contact/falling_gap.h"
#include "brink/scheduler/first_contact/first_contact.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/pair_view.h"

namespace brink::detail {

/// How a moves against b, and b against a.
struct BothWays {
  RelativeBounds of_a, of_b;

  BothWays() = default;
  explicit BothWays(const RelativeBounds& a_against_b) : of_a(a_against_b), of_b(a_against_b.swapped()) {}
  const RelativeBounds& of(const Half& half) const { return half.s_is_a ? of_a : of_b; }
};

/// The time in which a search looks for a contact [s].
struct SearchWindow {
  double from = 0.0;
  double to = 0.0;  ///< once a contact is found, just behind the earliest so far
  double asked_from = 0.0, asked_to = 0.0;
  bool in_part = false;   ///< from and to are those of a part of a piece of dense output ...
  double part_end = 0.0;  ///< ... which ends here
  BothWays bounds;        ///< over all that was left when they were last asked for

  /// Nothing before it counts ...
  double soonest() const { return in_part ? from : asked_from; }
  /// ... and nothing after it.
  double end() const { return in_part ? part_end : asked_to; }
};

/// Used by one search, whose pair is placed at the time from which it looks.
class FeatureCrossing {
 public:
  /// `remembers_start`: the beginning of the two motions can be asked for, and has a part in the answer. The view and the
  /// window are the search's; a contact that is found brings window.to nearer.
  FeatureCrossing(const Mover& a, const Mover& b, bool remembers_start, PairView& view, SearchWindow& window,
                  const SearchLimits& limits, SearchScratch& scratch, WorkCounters& work)
      : a_(a),
        b_(b),
        remembers_start_(remembers_start),
        told_from_(remembers_start ? view.start()
                                   : std::max({view.start(), a.motion->remembered_from(window.asked_from),
                                               b.motion->remembered_from(window.asked_from)})),
        view_(view),
        window_(window),
        limits_(limits),
        scratch_(scratch),
        work_(work) {}

  /// The feature's two are within the touching band: if they approach, finds the last double at which they are still
  /// apart. True if a contact was found; false if they recede, or pass by. `bounds` of its sample's path.
  bool meets(const Half& half, const Feature& f, const SamplePath& path, const PathBounds& bounds);

  /// The earliest contact so far; its sample is below 0 where there is none.
  const FeatureContact& earliest() const { return earliest_; }
  bool has_found() const { return earliest_.sample >= 0; }
  void forget() { earliest_ = {}; }

 private:
  double time() const { return view_.time(); }
  double gap_at(const Half& half, const Feature& f, double t) const { return view_.gap_at(half, f, t).gap; }
  double motions_end() const;
  bool leaves_neighbours(const Half& half, const Feature& f, double t) const;
  Foot foot_at(const Half& half, const Feature& f, double t) const;
  std::optional<double> in_each_other_since(const Half& half, const Feature& f) const;
  bool meets_beyond_tip(const Half& half, const Feature& f, double passed);
  double deepest_after(const Half& half, const Feature& f, const FallingGap& gap, double last) const;
  /// Two tips that come upon each other: when, what rounding makes of that [s], and the contact, if they do not pass.
  struct TipsMeet {
    const Half* half;
    double time, noise;
    std::optional<FeatureContact> contact;
  };
  std::optional<TipsMeet> at_tip(const Half& half, const Feature& f, const SamplePath& path,
                                 const PathBounds& bounds);
  std::optional<TipsMeet> at_tip_of_a(const Half& of_b, const Feature& f, int i);
  std::optional<TipsMeet> straight_upon_tip(const Half& half, const Feature& f, const SamplePath& path,
                                            bool at_a);
  bool meets_before(const Half& half, const Feature& f, double t, double bend, double rounding) const;
  bool is_upon_tip(const Half& half, const Feature& f, const SamplePath& way, bool at_a,
                   const PairView& there) const;
  int corner_of_a(const Vec2& tip) const;
  bool remember(const Half& half, const Feature& f, double t, double noise = 0.0);
  template <class ContactThen>
  bool keep(const Half& half, double t, double noise, ContactThen&& contact_then);
  std::optional<FeatureContact> contact_then(const Half& half, const Feature& f, double t) const;

  const Mover &a_, &b_;
  bool remembers_start_;
  /// Since when both motions can be asked for: where they begin, or so far back as neither is given up.
  double told_from_;
  PairView& view_;
  SearchWindow& window_;
  const SearchLimits& limits_;
  SearchScratch& scratch_;
  WorkCounters& work_;
  FeatureContact earliest_;
};

}  // namespace brink::detail
