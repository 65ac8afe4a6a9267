#pragma once
/// What every body has in view, from which policies with local clocks know whom to look at next.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "brink/scheduler/broad_phase/flight_batch.h"
#include "brink/scheduler/broad_phase/neighbourhood.h"
#include "brink/scheduler/kernel/kernel.h"

namespace brink {

/// The views of all bodies of a kernel's world. After look_around(k), every pair of k is clear until k's
/// clock expires, or is in the view of the other; look_ahead() keeps that up as k changes cells.
class Views {
 public:
  /// Places all bodies at the kernel's present time; looks at nothing yet.
  explicit Views(Kernel& kernel);

  BodyClock& clock(int k) { return clocks_[k]; }
  const BodyClock& clock(int k) const { return clocks_[k]; }
  bool stale(const Candidate& c) const { return c.version != version_of(c.other); }
  /// True if body k and what that candidate of its is are two plain discs in free flight.
  bool plain_pair(int k, const Candidate& c) const {
    return c.other < body_count() && flights_[k].plain && flights_[c.other].plain;
  }
  /// True if body k is such a disc and the site is a plain wall.
  bool plain_at_wall(int k, int site, const Image& image) const {
    return flights_[k].plain && image == Image{} && kernel_->is_plain_wall(site);
  }
  /// True if waiting for the memory of bodies that are met in no order costs more than to fetch it before it is needed.
  bool are_many() const { return body_count() > kInCaches; }
  /// Starts to fetch body k's clock and flight.
  void expect(int k) const {
    prefetch(&clocks_[k]);
    prefetch(&flights_[k]);
  }
  /// Starts to fetch where expect_look(k) looks. Slow if k's own flight is not at hand.
  void expect_cells(int k) const {
    if (are_many()) near_->expect_cells(k);
  }
  /// Starts to fetch what looking around body k reads. Slow if its own flight is not at hand.
  void expect_look(int k) const {
    if (are_many()) near_->expect(k);
  }
  /// Until when a search of body k's candidate must go: they cannot meet later, or k's view of it ends. Still
  /// sites are looked at again as k leaves its cell; whatever moves is not.
  double end_of(int k, const Candidate& c) const {
    const BodyClock& clock = clocks_[k];
    if (c.other >= body_count())
      return kernel_->site_moves(c.other - body_count()) ? clock.horizon
                                                         : std::min(clock.exit, clock.horizon);
    if (flights_[k].free && flights_[c.other].free)
      return meeting(Course(flights_[k], gravity_, c.clear), flights_[c.other], periods_.shift(c.image),
                     c.clear)
          .end;
    return clock.horizon;
  }
  /// The end of the present run: views of bodies that are not in free flight end just after it at the latest.
  void set_end(double until) { until_ = until; }

  /// Reads body k's motion anew; candidates that others have of it are stale.
  void take_up(int k);
  /// The same of two plain discs that have met, and both look around in a round of their own.
  void look_around_after(int a, int b, double now);
  /// Of one that has met a wall.
  void look_around_after(int k, double now);
  /// Bodies that look around from now on see none of those that have done so before them since.
  void begin_round() {
    ++round_;
    lookers_ = 0;
    first_lookers_ = {-1, -1};
  }
  /// Fills body k's view with everything that it may meet from now on, but for bodies that have looked around
  /// in this round: they see it. May halt the kernel (an integrator that fails).
  void look_around(int k, double now);
  /// Where the earliest search of what is in view would begin, or `now`: no motion will be asked for a time
  /// before that.
  double earliest_search(double now) const;
  /// Adds what comes near as body k, in free flight, leaves its cell.
  void look_ahead(int k, double now);

 private:
  static constexpr int kInCaches = 2000;  ///< bodies that a processor has near at hand

  int body_count() const { return static_cast<int>(clocks_.size()); }
  unsigned version_of(int owner) const { return owner < body_count() ? flights_[owner].version : 0; }
  void start_anew(int k, const Motion& motion);
  void start_anew(int k);
  void look(int k, double now);
  void note_look(int k);
  bool has_looked(int k) const {
    const bool first = k == first_lookers_[0], second = k == first_lookers_[1];
    return lookers_ <= 2 ? first | second : looked_[k] == round_;  // nearly always without a branch
  }
  /// Who is near a body in free flight, and who of them can be met.
  struct Sight {
    FlightBatch near;
    unsigned met = 0;       ///< bit i: the i-th of them
    bool is_whole = false;  ///< all near are there; else they are to be seen one by one
  };
  void begin_view(int k, double now);
  Course place(int k, double now);
  void compare(int k, const Course& here, double now, Sight& sight, const Cell* former = nullptr);
  void see_bodies(int k, double now);
  void see_bodies(int k, const Course& here, double now, const Sight& sight, const Cell* former = nullptr);
  void see_one_by_one(int k, const Course& here, double now, const Cell* former);
  void see_sites(int k, double now);
  bool sees(int k, int other, const Image& image) const;
  void see_bounded(int k, int j, const Image& image, double now);
  void see_site(int k, int site, const Image& image, double now);
  void see_moving_site(int k, int site, double now);
  void see_by_pass(int k, double now);
  bool begin_window(int k, double now);
  double follow(int k, int owner, double end);
  double end_view(int k, double followed);
  double speed(int k, double now) const;
  void limit_view(int k, double now, double closing, double stride, double gap);
  void note_start(int k, double start);
  double stride(int k, double now) const;
  MeetingTimes bounded_meeting(int k, int owner, const Image& image, double now);

  Kernel* kernel_;
  Vec2 gravity_;
  Periods periods_;
  double until_ = 0.0;
  LargeVector<Flight> flights_;
  LargeVector<BodyClock> clocks_;
  struct Pace {                                                ///< of a body that an integrator drives
    double start = 0.0;                                        ///< of its motion [s]
    double typical = std::numeric_limits<double>::infinity();  ///< time from start to start [s]
  };
  std::vector<Pace> paces_;                   ///< of every body
  std::vector<std::vector<Box>> site_boxes_;  ///< what must be reached to touch a still site; empty: anywhere
  std::vector<int> moving_;
  std::vector<std::uint64_t> looked_;  ///< the round in which each body looked around, if more than two did
  std::uint64_t round_ = 0;
  int lookers_ = 0;  ///< in this round: 0, 1, 2, or more
  std::array<int, 2> first_lookers_{-1, -1};
  std::optional<Neighbourhood> near_;
  std::array<Sight, 2> sights_;  ///< of those who look around
};

}  // namespace brink
