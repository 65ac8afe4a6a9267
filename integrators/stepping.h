#pragma once
/// The frame of every integrator that goes step by step: segments between breaks, tracks, counting, failures.

#include <memory>
#include <string>
#include <vector>

#include "brink/integrators/integrator.h"

namespace brink {

/// Throws BadInput unless t and every number of `states` are finite and there is one state a body.
void check_start(const Dynamics& dynamics, double t, std::span<const BodyState> states);
/// Throws BadInput unless t is a time that steps can reach.
void check_finite_time(double t);
/// What an extend() to t has come to that ends at `end`; `failure` is empty if there was none.
Extent extent_at(double end, double t, const std::string& failure);
bool is_finite(const BodyState& state);
/// True if no number of the state is beyond 1e150 in SI units: energies and momenta are then finite, too.
bool is_in_range(const BodyState& state);
bool is_finite(const Acceleration& a);
/// "1.25" style text of a time in messages.
std::string time_text(double t);

/// extend(t):
///   while the tracks end before t:
///     at the start, and where the right-hand side has jumped:
///       next segment = up to Dynamics::next_break; begin afresh
///     take one step of the method's own length, never past the segment's end
///     append one piece a body
/// A failure ends the tracks at the last accepted step and stays until start().
class SteppingIntegrator : public Integrator {
 public:
  void start(double t, std::span<const BodyState> states) final;
  using Integrator::extend;
  Extent extend(double t, std::uint64_t most_steps) final;
  void forget_before(double t) final;
  Motion motion(int k) const final;

 protected:
  SteppingIntegrator(std::shared_ptr<Dynamics> dynamics, WorkCounters* work)
      : dynamics_(std::move(dynamics)), work_(work) {}

  /// The method's own start at time() with states(), where nothing before counts. False: fail() was called.
  virtual bool begin_segment() = 0;
  /// One accepted step: append() a piece for every body, then accept(). False: fail() was called.
  virtual bool step() = 0;

  int size() const { return dynamics_->size(); }
  double time() const { return time_; }
  double segment_end() const { return segment_end_; }
  /// See Dynamics, from the present time on.
  double steady_until() { return dynamics_->steady_until(time_); }
  std::span<const BodyState> states() const { return states_; }

  /// Accelerations at time t of the present segment: a time at its end counts as just before the jump there.
  /// False where one of them is not finite; why() then says which.
  bool accelerations(double t, std::span<const BodyState> states, std::span<Acceleration> out);
  /// Of the last accelerations() in this step that were not finite; empty if all were.
  const std::string& why() const { return why_; }

  void append(int k, const PolynomialPiece& piece) { tracks_[k]->pieces.push_back(piece); }
  bool accept(double t, std::span<const BodyState> states);
  bool fail(std::string why);

 private:
  bool next_segment();

  std::shared_ptr<Dynamics> dynamics_;
  WorkCounters* work_;
  std::vector<std::shared_ptr<Track>> tracks_;
  std::vector<BodyState> states_;
  double time_ = 0.0;
  double segment_end_ = 0.0;
  bool in_segment_ = false;
  std::string why_;
  std::string failure_;  ///< empty: none since start()
};

}  // namespace brink
