#pragma once
/// Prescribed motion: a site that moves as told by a function of time, as dense polynomial pieces.

#include <functional>
#include <string>

#include "brink/integrators/integrator.h"

namespace brink {

/// Turns t -> (x, y, angle) into a Motion with pose and twist continuous, made piece after piece as it is
/// asked for.
///
/// Time is cut on a fixed dyadic grid: cells of 1/16 s, halved where needed, down to 2^-30 s. In each cell
/// the function is interpolated at 11 Chebyshev-Lobatto points and checked at the 10 points between them, to
/// 1e-13 of the cell's largest value (more where rounding of t itself makes the function noisier). Then a
/// cubic makes neighbouring pieces meet with one twist. A piece depends on the function near it alone, never
/// on how far was asked. A corner of the function (a jump of its rate) is rounded off within 2^-30 s; a jump
/// of its value, an infinite rate, or a value that is not finite ends the motion.
///
/// What is not seen: features that live between the points, that is shorter than about 3 ms and zero
/// elsewhere. Cost: some 25 evaluations a cell and halving. Source: Trefethen 2013, Approximation Theory and
/// Practice, ch. 2-5.
class PrescribedMotion {
 public:
  using Function = std::function<Eigen::Vector3d(double)>;

  /// `name` stands for the function in messages: 'motion of site "drum" (x = "...", ...)'.
  /// The motion begins at t = 0.
  PrescribedMotion(Function pose, std::string name);
  ~PrescribedMotion();
  PrescribedMotion(PrescribedMotion&&) noexcept;
  PrescribedMotion& operator=(PrescribedMotion&&) noexcept;

  /// Extends the motion to cover at least time t. A failure is lasting. @throws BadInput if t is not finite.
  Extent extend(double t);

  /// From the beginning to the last extend(); grows with later ones. @pre extend() has reached something.
  Motion motion() const { return Motion::dense(track_); }

  /// Largest difference met between the function and its interpolant at the checking points, in the units of
  /// the pose.
  double worst_fit() const { return worst_fit_; }

 private:
  struct Fitted;

  bool fit(double begin, double width, int depth, const Eigen::Vector3d* base_scale);
  bool sample(double begin, double width, const Eigen::Vector3d* base_scale, Fitted& cell);
  bool settled(const Fitted& cell, int depth) const;
  bool take_corner(Fitted cell, int depth);
  void join_next(const Fitted& next);
  void close(const Fitted& piece, const Eigen::Vector3d& rate_end);
  bool fail(double t, const std::string& what);

  static constexpr int kDepths = 27;  ///< from cells of 2^-4 s to 2^-30 s

  Function pose_;
  std::string name_;
  double next_cell_ = 0.0;  ///< where the next grid cell begins
  std::shared_ptr<Track> track_ = std::make_shared<Track>();
  std::unique_ptr<Fitted> last_;  ///< fitted, not yet joined to what follows
  Eigen::Vector3d rate_begin_;    ///< the twist at which last_ begins, once joined to what came before
  double misfits_[kDepths] = {};  ///< of the cells that hold the present one
  double worst_fit_ = 0.0;
  std::string failure_;
};

}  // namespace brink
