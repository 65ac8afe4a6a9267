#pragma once
/// An interior point for convex quadratic programs of bodies in the plane: a cost in each body's velocity, and
/// rows that each see one body or two.

#include <limits>
#include <memory>
#include <vector>

#include "brink/core/contacts/block_ldl.h"

namespace brink {

/// A contact's normal, tangent or spin as one number, y = on_body . u(body) + on_other . u(other) + offset,
/// and the force x that goes with it.
struct QpRow {
  int body = 0, other = -1;  ///< indices of bodies; -1: something that does not yield
  Vec3 on_body = Vec3::Zero(), on_other = Vec3::Zero();
  double offset = 0.0;
  /// infinity: 0 <= x _|_ y >= 0. Else > 0: |x| <= bound, and x is -bound * sign(y) where y is not 0.
  double bound = std::numeric_limits<double>::infinity();
  double expected = 0.0;  ///< force that the search begins near; 0 in all rows: nothing is known
  /// By which it is known again in the next problem (begin_again), one of its own in each; -1: by nothing.
  int name = -1;
};

/// minimise u.M u / 2 - f.u + (sum of bound |y| over the rows that have one), subject to y >= 0 at the others.
/// Its forces x satisfy M u = f + J^T x. @pre M > 0; M, f, and velocities wanted are of order 1 or less
struct QpProblem {
  std::vector<Vec3> mass;   ///< M, the diagonal: x, y, angle of each body
  std::vector<Vec3> force;  ///< f
  std::vector<QpRow> rows;
  /// Where forces are expected, neither they nor speeds begin below this: nearer to 0 what is expected wrongly takes longer
  /// to be made up for than what is expected rightly saves.
  double near = 0.1;
};

/// Steps towards the solution: primal-dual, predictor and correctors, with one factor of M + J^T W J a step
/// (W > 0 diagonal), in blocks of a body. Rows that depend on others, or are given twice, do no harm.
/// Sources: Mehrotra 1992, "On the implementation of a primal-dual interior point method"; Wright 1997,
/// "Primal-dual interior-point methods", ch. 10; Nocedal & Wright, "Numerical optimization", 16.6.
class InteriorPoint {
 public:
  /// Before the first step. What is known of the graph is kept from the problem before. False: it was stopped, and there
  /// is nothing to ask.
  bool begin(const QpProblem& problem, const GoOn& go_on = {});
  /// From where the searches since begin() came by, for the same bodies, and rows of the same names with other offsets and
  /// bounds: the less these have changed, the fewer steps are left. Rows may have come and gone; those that are new begin as the
  /// velocities of then have them. False: there is no such place, or it was stopped; then begin() is to be asked.
  bool begin_again(const QpProblem& problem, const GoOn& go_on = {});
  /// One factorisation, one step. False: no step of any length is left to rounding, or it was stopped.
  bool step(const GoOn& go_on = {});
  bool stopped() const { return stopped_; }
  /// The last step had to be short. Near the solution that is by rounding, and more steps do not help.
  bool hindered() const { return last_length_ < 0.9; }

  int steps() const { return steps_; }
  int blocks() const { return factor_.blocks(); }
  Vec3 velocity(int body) const { return u_[factor_.place(body)].vector(); }
  /// f + J^T x - M u
  Vec3 imbalance(int body) const { return imbalance_[factor_.place(body)].vector(); }
  double force(int row) const { return force_of(rows_[row]); }
  /// u.M u
  double energy() const;
  /// Sum of the products of what must not both be positive: bounds 2 (cost - least cost), where the two below
  /// are 0.
  double gap() const { return gap_; }
  double mean_product() const { return pairs_ > 0 ? gap_ / pairs_ : 0.0; }
  /// Largest |y| that a row's own y differs from that of the velocities.
  double row_residual() const;
  /// Largest |imbalance| beyond the rounding of its body's forces, as a velocity of the body.
  double body_residual() const;

 private:
  /// A row in the order of elimination. Its pairs stand from `pair` on: s >= 0, z >= 0, s z -> 0. Without a bound the one
  /// pair is (x, y); with one they are (bound - x, z0) and (bound + x, z1), where y = z1 - z0.
  struct Row {
    Triple on_first, on_last;
    int first, last, slot;  ///< places of bodies, first < last; first -1: one body only
    int pair, pairs;
    double offset;
    double residual;      ///< y of the velocities less y of the pairs
    double weight, push;  ///< dx = push - weight dy
  };
  /// One number of each pair, in the order of rows.
  using OfPairs = std::vector<double>;
  /// First pairs of rows, by names of these; -1: there is none.
  using PairsByName = std::vector<int>;
  /// Where a search came by.
  struct Place {
    std::vector<Triple> u;  ///< of each body
    std::shared_ptr<const PairsByName> pair_of;
    OfPairs s, z;
    double product;
  };

  double force_of(const Row& row) const {
    return row.pairs == 1 ? s_[row.pair] : (s_[row.pair + 1] - s_[row.pair]) / 2;
  }
  /// y of the velocities, as they are.
  double speed_of(const Row& row) const {
    const double own = row.offset + row.on_last.dot(u_[row.last]);
    return row.first >= 0 ? own + row.on_first.dot(u_[row.first]) : own;
  }
  Row ordered(const QpRow& row) const;
  bool take_graph(const QpProblem& problem, const GoOn& go_on);
  void take_rows(const QpProblem& problem);
  void start_pairs(const QpProblem& problem);
  void start_near(const QpProblem& problem);
  void start_where(const Row& row, double bound, double product);
  void start(const QpProblem& problem);
  void measure();
  bool factor(const GoOn& go_on);
  void find_direction(double centre, bool corrected);
  void correct_outliers(double centre);
  void swap_direction();
  void solve_for_aim();
  double longest_step() const;
  double gap_after(double length) const;
  void take(double length);
  void note_place();
  void stand_at(const Place& place, const QpProblem& problem);

  BlockLdl factor_;
  std::vector<Triple> mass_, f_, u_, du_, imbalance_;  ///< in the order of elimination
  std::vector<Row> rows_;
  std::shared_ptr<const PairsByName> pair_of_;
  OfPairs s_, z_, ds_, dz_;
  OfPairs aim_;            ///< what s dz + z ds is to be
  OfPairs per_s_, per_z_;  ///< 1 / s, 1 / z where the factor was made
  struct {
    std::vector<Triple> du;
    OfPairs ds, dz;
  } other_;                    ///< a direction, while another one is tried
  std::vector<Place> places_;  ///< from the farthest to the nearest to the solution
  int pairs_ = 0, steps_ = 0;
  bool stopped_ = false;
  double gap_ = 0.0, last_length_ = 1.0;
};

}  // namespace brink
