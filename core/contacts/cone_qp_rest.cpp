/// Rest as a convex problem. Each contact's cone of forces is spanned by its edges; with x >= 0 the weights
/// of all edges and J their directions, forces balance where f + J^T x = 0. That is the optimum of
///
///   minimise w.M w / 2 - f.w   subject to   J w >= 0,      M w = f + J^T x,   0 <= x _|_ J w >= 0
///
/// with w = 0: so the solver is asked for w, and what it finds is either balance or the proof that there is
/// none.
#include <algorithm>
#include <cmath>

#include "brink/core/contacts/cone_qp.h"
#include "brink/core/contacts/island_units.h"

namespace brink {

namespace {

constexpr int kMostRestSteps = 80;
/// Accelerations below this part of the unit are rest; the search goes on to the lesser one where it can.
constexpr double kRest = 1e-8, kSure = 1e-10;
/// Rounding of what loads add up to, as a part of them.
constexpr double kRoundingOfLoads = 1e-13;
/// Of w.M w: the gap at which w is known to the square root of this, if rounding hinders that it is known better; and at which w
/// is known not to be 0.
constexpr double kRestNearly = 1e-14, kProof = 1e-8;

/// The problem's rows: the edges of each contact's cone of forces.
class Cones {
 public:
  Cones(const RestProblem& given) : given_(given), units_(given.mass) {
    // the unit of `residual`: what the largest force would give the largest mass
    units_.set_speed(units_.largest(given.force) / units_.mass());
    for (int k = 0; k < static_cast<int>(given.mass.size()); ++k) {
      problem_.mass.push_back(units_.scaled_mass(k));
      problem_.force.push_back(units_.scaled_force(k, given.force[k]));
    }
    problem_.near = given.near;
    problem_.rows.reserve(2 * given.contacts.size());
    edges_.reserve(2 * given.contacts.size());
    for (int k = 0; k < static_cast<int>(given.contacts.size()); ++k) add_contact(k);
  }

  const QpProblem& problem() const { return problem_; }
  const IslandUnits& units() const { return units_; }

  /// Forces within a cone are sums of its edges with weights x >= 0: normal sum of x,
  /// tangential sum of +-mu x.
  std::vector<ContactLoad> loads(const InteriorPoint& solver) const {
    std::vector<ContactLoad> loads(given_.contacts.size());
    for (std::size_t r = 0; r < edges_.size(); ++r) {
      const double x = solver.force(static_cast<int>(r)) * units_.force();
      ContactLoad& load = loads[edges_[r].contact];
      load.normal += x;
      load.tangential += edges_[r].tangential * x;
      load.rolling += edges_[r].rolling * x;
    }
    return loads;
  }

 private:
  struct Edge {
    int contact;
    double tangential, rolling;  ///< for a normal force of 1
  };

  /// 1, 2 or 4 edges: (1, +-mu, +-r) in normal, tangential and rolling parts. In the plane the cone of
  /// friction is spanned by two edges exactly; it is no approximation as a pyramid in space would be.
  void add_contact(int k) {
    const LastingContact& c = given_.contacts[k];
    const std::vector<double> drags = signs(c.friction), turns = signs(c.rolling_resistance);
    for (const double q : drags)
      for (const double m : turns) add_edge({k, q, m}, static_cast<double>(drags.size() * turns.size()));
  }

  /// The edge's weight in the load that is expected of its contact, which has so many edges: their normal parts add up to the
  /// load's, and so do the others.
  double expected(const Edge& edge, double edges) const {
    if (given_.expected.empty()) return 0.0;
    const ContactLoad& load = given_.expected[edge.contact];
    const auto part = [](double of, double edge_has) { return edge_has != 0.0 ? of / edge_has : 0.0; };
    const double sum =
        load.normal + part(load.tangential, edge.tangential) + part(load.rolling, edge.rolling);
    return std::max(0.0, sum / (edges * units_.force()));
  }

  /// Both ends of -bound .. bound, which are one where it is 0.
  static std::vector<double> signs(double bound) {
    return bound > 0.0 ? std::vector{bound, -bound} : std::vector{0.0};
  }

  void add_edge(const Edge& edge, double edges) {
    const LastingContact& c = given_.contacts[edge.contact];
    // A rolling torque turns the body one way and the other one the opposite way.
    const Vec3 turn(0.0, 0.0, edge.rolling);
    QpRow row;
    row.body = c.body;
    // What a unit of the edge's force does to the bodies, so that J^T x is the sum of all contact forces.
    row.on_body = units_.scaled_row(c.body, c.normal_on_body + edge.tangential * c.tangent_on_body + turn);
    row.other = c.other;
    if (c.other >= 0)
      row.on_other =
          units_.scaled_row(c.other, c.normal_on_other + edge.tangential * c.tangent_on_other - turn);
    if (row.on_body.isZero(0.0) && row.on_other.isZero(0.0)) return;  // between what is held
    row.expected = expected(edge, edges);
    edges_.push_back(edge);
    problem_.rows.push_back(row);
  }

  const RestProblem& given_;
  IslandUnits units_;
  QpProblem problem_;
  std::vector<Edge> edges_;  ///< of each row
};

/// What the solver's numbers say so far.
class Verdict {
 public:
  Verdict(const QpProblem& problem, const InteriorPoint& solver)
      : problem_(problem), solver_(solver), carried_(problem.mass.size(), 0.0) {
    for (std::size_t r = 0; r < problem.rows.size(); ++r) {
      const QpRow& row = problem.rows[r];
      const double x = solver.force(static_cast<int>(r));
      carried_[row.body] += x * row.on_body.cwiseAbs().maxCoeff();
      if (row.other >= 0) carried_[row.other] += x * row.on_other.cwiseAbs().maxCoeff();
    }
    for (int k = 0; k < bodies(); ++k)
      acceleration_ = std::max(acceleration_, solver.velocity(k).cwiseAbs().maxCoeff());
  }

  /// Largest component of w, in units of the problem.
  double acceleration() const { return acceleration_; }
  /// Largest force that is left over on a body, beside its own mass and what its contacts push.
  double imbalance() const {
    double most = 0.0;
    for (int k = 0; k < bodies(); ++k) most = std::max(most, left_over(k) / (own(k) + carried_[k]));
    return most;
  }

  /// Both: w is 0 to `bound`, and the forces balance to as much, but for what their own roundings leave.
  bool rests(double bound) const {
    if (!(acceleration_ <= bound)) return false;
    for (int k = 0; k < bodies(); ++k)
      if (!(left_over(k) <= bound * own(k) + kRoundingOfLoads * carried_[k])) return false;
    return true;
  }
  /// The cost is convex, with second derivative M, so that for the true w*: (w - w*).M (w - w*) <= gap.
  /// Within part * w.M w the relative error of w is at most sqrt(part), and w* is not 0.
  bool moves(double part) const {
    return acceleration_ > kRest && solver_.gap() <= part * solver_.energy() &&
           std::max(solver_.row_residual(), solver_.body_residual()) <= std::sqrt(part) * acceleration_;
  }

 private:
  int bodies() const { return static_cast<int>(problem_.mass.size()); }
  double own(int k) const { return problem_.mass[k].maxCoeff(); }
  /// f + J^T x, which forces in balance bring to 0.
  double left_over(int k) const {
    return (solver_.imbalance(k) + problem_.mass[k].cwiseProduct(solver_.velocity(k))).cwiseAbs().maxCoeff();
  }

  const QpProblem& problem_;
  const InteriorPoint& solver_;
  std::vector<double> carried_;  ///< by each body: what its contacts push
  double acceleration_ = 0.0;
};

}  // namespace

RestResult ConeQp::rest_forces(const RestProblem& problem, const GoOn& go_on, double proved) {
  const Cones cones(problem);
  if (!solver_.begin(cones.problem(), go_on))
    return {RestResult::Status::stopped, std::vector<Vec3>(problem.mass.size(), Vec3::Zero()),
            std::vector<ContactLoad>(problem.contacts.size())};
  // The search ends at the sharper bounds. Where steps get short rounding has the word, and the wider ones
  // are taken; else the last steps would be spent on nothing.
  const auto sure = [&] {
    const Verdict verdict(cones.problem(), solver_);
    if (verdict.rests(kSure) || verdict.moves(proved)) return true;
    return solver_.hindered() && (verdict.rests(kRest) || verdict.moves(kRestNearly));
  };
  while (!sure() && solver_.steps() < kMostRestSteps && solver_.step(go_on)) continue;

  RestResult result;
  const Verdict verdict(cones.problem(), solver_);
  // Not both: moves() asks for an acceleration above kRest, rests() for one up to it.
  if (verdict.rests(kRest)) result.status = RestResult::Status::rests;
  if (verdict.moves(std::max(proved, kProof))) result.status = RestResult::Status::moves;
  if (solver_.stopped()) result.status = RestResult::Status::stopped;
  const bool rests = result.status == RestResult::Status::rests;
  for (int k = 0; k < static_cast<int>(problem.mass.size()); ++k)
    // What is called rest is 0 exactly, so that nothing creeps.
    result.acceleration.push_back(rests ? Vec3(Vec3::Zero())
                                        : cones.units().speed_of(k, solver_.velocity(k)));
  result.loads = cones.loads(solver_);
  result.residual = verdict.acceleration();
  result.imbalance = verdict.imbalance();
  result.factorisations = solver_.steps();
  if (result.status != RestResult::Status::undecided || problem.expected.empty()) return result;
  // what is expected may be far off the answer
  RestProblem afresh = problem;
  afresh.expected.clear();
  const int before = result.factorisations;
  result = rest_forces(afresh, go_on, proved);
  result.factorisations += before;
  return result;
}

}  // namespace brink
