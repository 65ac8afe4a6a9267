/// Newton's method on the equations of the optimum, with the products relaxed to a common value that goes to
/// 0:
///
///   M u = f + J^T x       y = J u + offset, split over the row's pairs       s z = product for every pair
///
/// Linearised, every pair gives dz = (aim - z ds) / s, a row's pairs add up to dx = push - weight dy, and
/// what is left is one symmetric positive definite system in du, (M + J^T W J) du = imbalance + J^T push.
/// Each step factors it once and solves it twice: for a predictor, which tells how far products of 0 are, and
/// for the step proper.
#include "brink/core/contacts/interior_point.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/elementary.h"

namespace brink {

namespace {

/// Of the way to where a first pair meets 0: nearly all of it when the products are small.
double part_of_way(double product) { return 1.0 - std::clamp(product, 1e-8, 0.005); }

/// What a row yields under a force of 1, at least: bounds the weights, so that stiff rows leave something of
/// the masses. It changes the way to the solution, not the solution. Source: Friedlander & Orban 2012, "A
/// primal-dual regularized interior-point method for convex quadratic programs".
constexpr double kYield = 1e-12;

/// Weights below this, of order 1 where a row matters, are left out of the factor: chains of them underflow.
constexpr double kNoWeight = 1e-20;

/// Products that add up to less cannot be told from none; nor can such a step.
constexpr double kNothing = 1e-60, kNoStep = 1e-10;

/// Steps with a corrector, which is quick but may go in circles (once in some ten thousand random problems);
/// after so many steps plain ones follow that keep to the centre.
constexpr int kQuick = 25;

/// Of forces that add up on a body, as a part of them.
constexpr double kRounding = 1e-13;

}  // namespace

/// J u of this row, without the offset.
double InteriorPoint::Row::see(const std::vector<Vec3>& u) const {
  const double y = on_last.dot(u[last]);
  return first < 0 ? y : y + on_first.dot(u[first]);
}

/// Adds J^T force.
void InteriorPoint::Row::apply(double force, std::vector<Vec3>& to) const {
  to[last] += force * on_last;
  if (first >= 0) to[first] += force * on_first;
}

void InteriorPoint::Row::set_weight() {
  // dx = push - weight dy follows from z ds + s dz = aim with ds = sign dx: dz = (aim - z ds) / s, and
  // sum of sign dz = dy + residual.
  double yields = kYield;
  for (int p = 0; p < pairs; ++p) yields += z[p] / s[p];
  weight = 1.0 / yields;
}

void InteriorPoint::Row::set_push(double product, bool corrected) {
  // The residual goes in as well, so that a whole step brings it to 0.
  double dy = -residual;
  for (int p = 0; p < pairs; ++p) {
    // (s + ds)(z + dz) = product, with the term ds dz of second order as the predictor has left it
    aim[p] = product - s[p] * z[p] - (corrected ? ds[p] * dz[p] : 0.0);
    dy += sign[p] * aim[p] / s[p];
  }
  push = weight * dy;
}

void InteriorPoint::Row::set_direction(double dx) {
  for (int p = 0; p < pairs; ++p) {
    ds[p] = sign[p] * dx;
    dz[p] = (aim[p] - z[p] * ds[p]) / s[p];
  }
}

void InteriorPoint::begin(const QpProblem& problem) {
  const int n = static_cast<int>(problem.mass.size());
  // J^T W J couples two bodies only where a row sees both.
  std::vector<BlockLdl::Edge> edges;
  for (const QpRow& row : problem.rows)
    if (row.other >= 0) edges.emplace_back(row.body, row.other);
  factor_.analyse(n, std::move(edges));
  mass_.resize(n);
  f_.resize(n);
  for (int k = 0; k < n; ++k) {
    mass_[factor_.place(k)] = problem.mass[k];
    f_[factor_.place(k)] = problem.force[k];
  }
  u_.assign(n, Vec3::Zero());
  rows_.clear();
  for (const QpRow& row : problem.rows) rows_.push_back(ordered(row));
  steps_ = 0;
  last_length_ = 1.0;
  start_pairs();
  measure();
}

InteriorPoint::Row InteriorPoint::ordered(const QpRow& given) const {
  Row row{};
  row.first = -1;
  row.last = factor_.place(given.body);
  row.on_last = given.on_body;
  row.offset = given.offset;
  row.pairs = std::isinf(given.bound) ? 1 : 2;
  row.sign[0] = row.pairs == 1 ? 1.0 : -1.0;
  row.sign[1] = 1.0;
  // x = 0, in the middle of -bound .. bound
  if (row.pairs == 2) row.s[0] = row.s[1] = given.bound;
  if (given.other < 0) return row;
  row.first = factor_.place(given.other);
  row.on_first = given.on_other;
  if (row.first > row.last) {
    // The factor keeps blocks below the diagonal: the later place is the row.
    std::swap(row.first, row.last);
    std::swap(row.on_first, row.on_last);
  }
  row.slot = factor_.slot(row.last, row.first);
  return row;
}

/// All products alike, and large enough for what the rows begin with.
void InteriorPoint::start_pairs() {
  double speed = 1.0;
  for (const Row& row : rows_)
    speed = std::max(speed, row.pairs == 1 ? -row.offset : std::abs(row.offset) / 4);
  const double product = speed * speed;
  pairs_ = 0;
  for (Row& row : rows_) {
    pairs_ += row.pairs;
    // s is x where there is no bound, and z is y; else s stands at its bound already.
    // Either way s z = product.
    if (row.pairs == 1) {
      row.z[0] = std::max(row.offset, speed);
      row.s[0] = product / row.z[0];
    } else {
      row.z[0] = row.z[1] = product / row.s[0];
    }
  }
}

/// Residuals and gap where u, s and z stand.
void InteriorPoint::measure() {
  imbalance_.resize(u_.size());
  // All afresh from u, s and z: what a step leaves unsolved by rounding is a residual of the next one.
  for (std::size_t k = 0; k < u_.size(); ++k) imbalance_[k] = f_[k] - mass_[k].cwiseProduct(u_[k]);
  gap_ = 0.0;
  for (Row& row : rows_) {
    row.apply(row.force(), imbalance_);
    row.residual = row.see(u_) + row.offset;
    for (int p = 0; p < row.pairs; ++p) {
      row.residual -= row.sign[p] * row.z[p];
      gap_ += row.s[p] * row.z[p];
    }
  }
}

bool InteriorPoint::step() {
  // The first step is made always: without rows it is the whole solution, M u = f, at a gap of 0.
  if (steps_ > 0 && gap_ < kNothing) return false;
  ++steps_;
  factor();
  // Predictor: how far does the direction to products of 0 lead? Mehrotra's (gap after / gap)^3 says
  // from that how much of the centre the step proper needs.
  find_direction(0.0, false);
  const double reach = std::min(1.0, longest_step());
  double centre = rows_.empty() ? 0.0 : std::min(1.0, power(gap_after(reach) / gap_, 3.0));
  // A predictor that gets nowhere says little of the way: then the step keeps to the centre, without the
  // term of second order. After a step that was next to none, one step only makes the products alike.
  if (reach < 0.1 || steps_ > kQuick) centre = std::max(centre, 0.3);
  if (last_length_ < 0.05) centre = 1.0;
  const bool corrected = reach > 0.1 && centre < 1.0 && steps_ <= kQuick;
  find_direction(centre, corrected);
  // One length for u, s and z alike: the residuals, linear in them, then shrink by 1 -
  // length (up to kYield dx).
  last_length_ = std::min(1.0, part_of_way(gap_ / std::max(1, pairs_)) * longest_step());
  take(last_length_);
  measure();
  return last_length_ > kNoStep;
}

void InteriorPoint::factor() {
  factor_.begin(mass_);
  for (Row& row : rows_) {
    row.set_weight();
    if (row.weight < kNoWeight) continue;
    factor_.diagonal(row.last).add(row.weight, row.on_last, row.on_last);
    // Of the row's outer product with itself: two diagonal blocks and the one below them.
    if (row.first < 0) continue;
    factor_.diagonal(row.first).add(row.weight, row.on_first, row.on_first);
    factor_.below(row.slot).add(row.weight, row.on_last, row.on_first);
  }
  factor_.factor();
}

/// Newton's direction towards products that all are `centre` times their mean; `corrected` by the products of
/// the direction before.
void InteriorPoint::find_direction(double centre, bool corrected) {
  // (M + J^T W J) du = imbalance + J^T push, from M du = imbalance + J^T dx and dx = push - W J du
  const double product = rows_.empty() ? 0.0 : centre * gap_ / pairs_;
  du_ = imbalance_;
  for (Row& row : rows_) {
    row.set_push(product, corrected);
    row.apply(row.push, du_);
  }
  factor_.solve(du_);
  for (Row& row : rows_) row.set_direction(row.push - row.weight * row.see(du_));
}

/// How far the direction goes until a first s or z is 0, in whole steps; at most 2.
double InteriorPoint::longest_step() const {
  // More than 1, so that part_of_way() of what meets no bound still is a whole Newton step.
  double most = 2.0;
  for (const Row& row : rows_)
    for (int p = 0; p < row.pairs; ++p) {
      if (row.ds[p] < 0.0) most = std::min(most, -row.s[p] / row.ds[p]);
      if (row.dz[p] < 0.0) most = std::min(most, -row.z[p] / row.dz[p]);
    }
  return most;
}

/// The sum of products a part of the direction on.
double InteriorPoint::gap_after(double length) const {
  double sum = 0.0;
  for (const Row& row : rows_)
    for (int p = 0; p < row.pairs; ++p)
      sum += (row.s[p] + length * row.ds[p]) * (row.z[p] + length * row.dz[p]);
  return sum;
}

void InteriorPoint::take(double length) {
  for (std::size_t k = 0; k < u_.size(); ++k) u_[k] += length * du_[k];
  for (Row& row : rows_)
    for (int p = 0; p < row.pairs; ++p) {
      row.s[p] += length * row.ds[p];
      row.z[p] += length * row.dz[p];
    }
}

double InteriorPoint::energy() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < u_.size(); ++k) sum += u_[k].dot(mass_[k].cwiseProduct(u_[k]));
  return sum;
}

double InteriorPoint::row_residual() const {
  double most = 0.0;
  for (const Row& row : rows_) most = std::max(most, std::abs(row.residual));
  return most;
}

double InteriorPoint::body_residual() const {
  // Forces that cancel on a body, as in a deep heap, leave a rounding of their sizes, which no step can take
  // out: it is not held against the solution.
  std::vector<double> carried(u_.size(), 0.0);
  for (const Row& row : rows_) {
    const double x = std::abs(row.force());
    carried[row.last] += x * row.on_last.cwiseAbs().maxCoeff();
    if (row.first >= 0) carried[row.first] += x * row.on_first.cwiseAbs().maxCoeff();
  }
  double most = 0.0;
  for (std::size_t k = 0; k < u_.size(); ++k)
    most =
        std::max(most, (imbalance_[k].cwiseAbs().maxCoeff() - kRounding * carried[k]) / mass_[k].minCoeff());
  return most;
}

}  // namespace brink
