#pragma once
/// Prescribed motion: a site that moves as told by a function of time, as dense polynomial pieces.

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "brink/core/base/time_bound.h"
#include "brink/integrators/integrator.h"

namespace brink {

/// Turns t -> (x, y, angle) into a Motion with pose and twist continuous, made piece after piece as it is
/// asked for.
///
/// Time is cut on a fixed dyadic grid: cells of 1/16 s, halved where needed, down to 2^-30 s. In each cell
/// the function is interpolated at 11 Chebyshev-Lobatto points. The cell is small enough when the bound of
/// the function's eleventh derivative over it, not a sample, says that the interpolant misses it by no more
/// than 1e-13 of the cell's largest value, or than the roundings of the function itself: so nothing is too
/// short to be seen. Then a cubic makes neighbouring pieces meet with one twist. A piece depends on the
/// function near it alone, never on how far was asked. A corner of the function (a jump of its rate) is
/// rounded off within 2^-30 s, by rates between those before and after it; narrow cells beside it are one piece with the wider
/// one that comes before or after. A jump of its value (right at a time of the grid: of more than 1e-7, and than that part of it),
/// an infinite rate, a value that is not finite, or bounds
/// that say nothing end the motion there.
///
/// Cost: some 25 evaluations and four bounds a coordinate a cell and halving. Sources: Trefethen 2013, Approximation
/// Theory and Practice, ch. 2-5; Moore 1966, Interval Analysis.
class PrescribedMotion {
 public:
  using Function = std::function<Eigen::Vector3d(double)>;
  /// Of coordinate i (x, y, angle) over [from, to], with derivatives up to the highest that is named.
  using Bound = std::function<TimeBound(int i, double from, double to, BoundOf highest)>;

  /// The motion is `base` + `pose`; the base, which may be far away, does not blur the fit. `bound` holds for
  /// what `pose` gives but for a few roundings. `name` stands for the function in messages:
  /// 'motion of site "drum" (x = "...", ...)'. The motion begins at t = 0.
  PrescribedMotion(const Eigen::Vector3d& base, Function pose, Bound bound, std::string name);
  ~PrescribedMotion();
  PrescribedMotion(PrescribedMotion&&) noexcept;
  PrescribedMotion& operator=(PrescribedMotion&&) noexcept;

  /// Extends the motion to cover at least time t, in one instalment of at most `most_cells` cells and
  /// halvings
  /// (>= 1). A failure is lasting. @throws BadInput if t is not finite.
  Extent extend(double t, std::uint64_t most_cells = std::numeric_limits<std::uint64_t>::max());
  /// Nobody will ask the motion for a time before t any more.
  void forget_before(double t) { track_->forget_before(t); }

  /// True if it has failed because nothing bounds the function, which may be continuous.
  bool lacks_bounds() const { return corners_in_a_row_ > kMostCornersInARow; }
  /// True once extend() has reached something.
  bool begun() const { return !track_->pieces.empty(); }
  /// From the beginning to the last extend(); grows with later ones. @pre begun().
  Motion motion() const { return Motion::dense(track_); }

 private:
  struct Fitted;
  struct Cell {
    double begin, width;
    int depth;  ///< of halving
  };
  struct Certainty {            ///< over a cell
    Eigen::Vector3d spread;     ///< of the function's values
    Eigen::Vector3d remainder;  ///< by which its interpolant misses it at most
  };

  void fit_next();
  bool interpolate(const Cell& at, Fitted& cell);
  struct Noise {                ///< of values
    Eigen::Vector3d roundings;  ///< what they may be off by
    Eigen::Vector3d on_grid;    ///< bounds at the cell's ends and middle, where there may be a jump
  };
  Noise noise(const Cell& at, const Eigen::Vector3d& scale) const;
  Certainty bound(const Cell& at) const;
  void take_corner(Fitted cell, const Certainty& known);
  bool is_merged(Fitted& next);
  static void move_join(Fitted& left, Fitted& right, double t);
  void join_next(Fitted next);
  void close(const Fitted& piece, const Eigen::Vector3d& rate_end);
  void close_corner(const Fitted& cell, const Eigen::Vector3d& rate_end);
  void fail(double t, const std::string& what);

  static constexpr int kMostCornersInARow = 4096;  ///< of 2^-30 s each
  static constexpr int kDepths = 27;               ///< from cells of 2^-4 s to 2^-30 s

  Eigen::Vector3d base_;
  Function pose_;
  Bound bound_;
  std::string name_;
  double next_cell_ = 0.0;  ///< where the next grid cell begins
  std::shared_ptr<Track> track_ = std::make_shared<Track>();
  std::unique_ptr<Fitted> last_;  ///< fitted, not yet joined to what follows
  Eigen::Vector3d rate_begin_;    ///< the twist at which last_ begins, once joined to what came before
  std::vector<Cell> cells_;       ///< of the present grid cell that are to be fitted, the next last
  int corners_in_a_row_ = 0;
  std::string failure_;
};

}  // namespace brink
