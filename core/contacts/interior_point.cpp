/// Newton's method on the equations of the optimum, with the products relaxed to a common value that goes to
/// 0:
///
///   M u = f + J^T x       y = J u + offset, split over the row's pairs       s z = product for every pair
///
/// Linearised, every pair gives dz = (aim - z ds) / s, a row's pairs add up to dx = push - weight dy, and
/// what is left is one symmetric positive definite system in du, (M + J^T W J) du = imbalance + J^T push.
/// Each step factors it once and solves it twice or more: for a predictor, which tells how far products of 0 are, for the
/// step proper, and where that is short, for what holds it up.
///
/// What goes over all pairs is written so that a compiler can do several at once, in an order that does not depend on how
/// many.
#include "brink/core/contacts/interior_point.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "brink/core/base/elementary.h"
#include "brink/core/base/wide.h"

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
constexpr int kQuick = 40;

/// Of forces that add up on a body, as a part of them.
constexpr double kRounding = 1e-13;

/// A direction is corrected so many times at most, each time for a step longer by so much, until it leads nearly all the
/// way; a correction must make it longer by so much.
constexpr int kCorrections = 2;
constexpr double kLonger = 0.6, kAllTheWay = 0.95, kWorthIt = 0.01;
/// Products are well where they are within this part of what they are to be, and its inverse.
constexpr double kAlike = 0.1;

/// A force begins within this part of its bound.
constexpr double kInside = 0.7;

/// Places that a search came by are noted where the mean product is so many times smaller than at the one before.
constexpr double kApart = 0.1;
/// None are noted nearer to the solution: products there are not alike any more.
constexpr double kNearest = 1e-11;
/// Where another search goes on, products are at least so many times the square of what the equations miss there.
constexpr double kRoom = 1e-3;

/// Numbers that are gone through side by side.
constexpr std::size_t kLanes = 8;

}  // namespace

bool InteriorPoint::begin(const QpProblem& problem, const GoOn& go_on) {
  places_.clear();
  if (!take_graph(problem, go_on)) return false;
  u_.assign(problem.mass.size(), Triple{});
  take_rows(problem);
  const bool expects = std::any_of(problem.rows.begin(), problem.rows.end(),
                                   [](const QpRow& row) { return row.expected != 0.0; });
  expects ? start_near(problem) : start_pairs(problem);
  start(problem);
  return true;
}

bool InteriorPoint::take_graph(const QpProblem& problem, const GoOn& go_on) {
  // J^T W J couples two bodies only where a row sees both.
  std::vector<BlockLdl::Edge> edges;
  for (const QpRow& row : problem.rows)
    if (row.other >= 0) edges.emplace_back(row.body, row.other);
  return factor_.analyse(static_cast<int>(problem.mass.size()), std::move(edges), go_on);
}

/// @pre the graph has been taken
void InteriorPoint::take_rows(const QpProblem& problem) {
  rows_.clear();
  pairs_ = 0;
  PairsByName pair_of;
  for (const QpRow& row : problem.rows) {
    rows_.push_back(ordered(row));
    rows_.back().pair = pairs_;
    if (row.name >= static_cast<int>(pair_of.size())) pair_of.resize(row.name + 1, -1);
    if (row.name >= 0) pair_of[row.name] = pairs_;
    pairs_ += rows_.back().pairs;
  }
  pair_of_ = std::make_shared<const PairsByName>(std::move(pair_of));
  s_.assign(pairs_, 0.0);
  z_.assign(pairs_, 0.0);
}

/// From u, s and z as they are, which everything else follows from.
void InteriorPoint::start(const QpProblem& problem) {
  mass_.resize(u_.size());
  f_.resize(u_.size());
  for (int k = 0; k < static_cast<int>(u_.size()); ++k) {
    mass_[factor_.place(k)] = Triple::of(problem.mass[k]);
    f_[factor_.place(k)] = Triple::of(problem.force[k]);
  }
  for (OfPairs* of : {&ds_, &dz_, &other_.ds, &other_.dz, &aim_, &per_s_, &per_z_}) of->assign(pairs_, 0.0);
  steps_ = 0;
  stopped_ = false;
  last_length_ = 1.0;
  measure();
}

/// What another search may go on from.
void InteriorPoint::note_place() {
  const double product = mean_product();
  if (product < kNearest || (!places_.empty() && product > kApart * places_.back().product)) return;
  Place& place = places_.emplace_back(Place{{}, pair_of_, s_, z_, product});
  place.u.reserve(u_.size());
  for (int k = 0; k < static_cast<int>(u_.size()); ++k) place.u.push_back(u_[factor_.place(k)]);
}

/// Rows have been taken.
void InteriorPoint::stand_at(const Place& place, const QpProblem& problem) {
  for (int k = 0; k < static_cast<int>(u_.size()); ++k) u_[factor_.place(k)] = place.u[k];
  const PairsByName& pair_of = *place.pair_of;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    const int name = problem.rows[r].name;
    const int from = name >= 0 && name < static_cast<int>(pair_of.size()) ? pair_of[name] : -1;
    if (from < 0) {
      start_where(row, problem.rows[r].bound, place.product);
      continue;
    }
    std::copy_n(&place.s[from], row.pairs, &s_[row.pair]);
    std::copy_n(&place.z[from], row.pairs, &z_[row.pair]);
    if (row.pairs == 1) continue;
    // the same part of another bound
    double* s = &s_[row.pair];
    const double grows = 2.0 * problem.rows[r].bound / (s[0] + s[1]);
    s[0] *= grows;
    s[1] *= grows;
  }
  start(problem);
}

bool InteriorPoint::begin_again(const QpProblem& problem, const GoOn& go_on) {
  if (places_.empty() || places_.back().u.size() != problem.mass.size() || !take_graph(problem, go_on))
    return false;
  u_.resize(problem.mass.size());
  take_rows(problem);
  stand_at(places_.back(), problem);
  // What the equations miss there is what has changed. Products must leave room for it.
  const double changed = std::max(row_residual(), body_residual()), least = kRoom * changed * changed;
  auto from = places_.end() - 1;
  while (from != places_.begin() && from->product < least) --from;
  if (from + 1 != places_.end()) stand_at(*from, problem);
  // nearer ones are of another problem
  places_.erase(from + 1, places_.end());
  return true;
}

/// A row's pairs as the velocities have them, with products of that size.
void InteriorPoint::start_where(const Row& row, double bound, double product) {
  const double y = speed_of(row);
  double *s = &s_[row.pair], *z = &z_[row.pair];
  if (row.pairs == 1) {
    z[0] = std::max(y, std::sqrt(product));
    s[0] = product / z[0];
    return;
  }
  // y = product / (bound + x) - product / (bound - x)
  const double root = std::sqrt(product * product + y * y * bound * bound);
  const double x = bound * std::abs(y) * bound / (product + root);  // against y
  const double near =
      bound * (product + root - std::abs(y) * bound) / (product + root);  // bound - x, of x near to it, too
  s[0] = y < 0.0 ? near : bound + x;
  s[1] = y < 0.0 ? bound + x : near;
  for (int p = 0; p < 2; ++p) z[p] = product / s[p];
}

InteriorPoint::Row InteriorPoint::ordered(const QpRow& given) const {
  Row row{};
  row.first = -1;
  row.last = factor_.place(given.body);
  row.on_last = Triple::of(given.on_body);
  row.offset = given.offset;
  row.pairs = std::isinf(given.bound) ? 1 : 2;
  if (given.other < 0) return row;
  row.first = factor_.place(given.other);
  row.on_first = Triple::of(given.on_other);
  if (row.first > row.last) {
    // The factor keeps blocks below the diagonal: the later place is the row.
    std::swap(row.first, row.last);
    std::swap(row.on_first, row.on_last);
  }
  row.slot = factor_.slot(row.last, row.first);
  return row;
}

/// Nothing is known: all products alike, and large enough for what the rows begin with.
void InteriorPoint::start_pairs(const QpProblem& problem) {
  double speed = 1.0;
  for (const Row& row : rows_)
    speed = std::max(speed, row.pairs == 1 ? -row.offset : std::abs(row.offset) / 4);
  const double product = speed * speed;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    double *s = &s_[row.pair], *z = &z_[row.pair];
    // s is x where there is no bound, and z is y. Either way s z = product.
    if (row.pairs == 1) {
      z[0] = std::max(row.offset, speed);
      s[0] = product / z[0];
    } else {
      // x = 0, in the middle of -bound .. bound
      s[0] = s[1] = problem.rows[r].bound;
      z[0] = z[1] = product / s[0];
    }
  }
}

/// Forces and speeds as they are expected, and none of them near 0.
void InteriorPoint::start_near(const QpProblem& problem) {
  const double near = problem.near, product = near * near;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    const double expected = problem.rows[r].expected;
    double *s = &s_[row.pair], *z = &z_[row.pair];
    if (row.pairs == 1) {
      s[0] = std::max(expected, near);
      z[0] = std::max(row.offset, near);
    } else {
      const double bound = problem.rows[r].bound;
      // what slips has its force close to the bound against it, the closer the faster
      const double slips = std::abs(row.offset);
      const double most = std::max(kInside * bound, bound - product / std::max(slips, near));
      const double x = slips > near ? std::copysign(most, -row.offset)
                                    : std::clamp(expected, -kInside * bound, kInside * bound);
      s[0] = bound - x;
      s[1] = bound + x;
      for (int p = 0; p < 2; ++p) z[p] = product / s[p];
    }
  }
}

/// Residuals and gap where u, s and z stand.
BRINK_WIDE void InteriorPoint::measure() {
  imbalance_.resize(u_.size());
  // All afresh from u, s and z: what a step leaves unsolved by rounding is a residual of the next one.
  for (std::size_t k = 0; k < u_.size(); ++k)
    for (int c = 0; c < 4; ++c) imbalance_[k].at[c] = f_[k].at[c] - mass_[k].at[c] * u_[k].at[c];
  for (Row& row : rows_) {
    row.residual = 0.0;
    const double force = force_of(row);
    imbalance_[row.last].add(force, row.on_last);
    double y = row.on_last.dot(u_[row.last]);
    if (row.first >= 0) {
      imbalance_[row.first].add(force, row.on_first);
      y += row.on_first.dot(u_[row.first]);
    }
    const double own = row.pairs == 1 ? z_[row.pair] : z_[row.pair + 1] - z_[row.pair];
    row.residual = y + row.offset - own;
  }
  gap_ = gap_after(0.0);
}

bool InteriorPoint::step(const GoOn& go_on) {
  // The first step is made always: without rows it is the whole solution, M u = f, at a gap of 0.
  if (steps_ > 0 && gap_ < kNothing) return false;
  ++steps_;
  if (!factor(go_on)) {
    stopped_ = true;
    return false;
  }
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
  correct_outliers(centre);
  // One length for u, s and z alike: the residuals, linear in them, then shrink by 1 -
  // length (up to kYield dx).
  last_length_ = std::min(1.0, part_of_way(gap_ / std::max(1, pairs_)) * longest_step());
  take(last_length_);
  measure();
  if (!hindered()) note_place();
  return last_length_ > kNoStep;
}

BRINK_WIDE bool InteriorPoint::factor(const GoOn& go_on) {
  factor_.begin(mass_);
  const std::size_t count = s_.size();
  for (std::size_t p = 0; p < count; ++p) per_s_[p] = 1.0 / s_[p];
  for (std::size_t p = 0; p < count; ++p) per_z_[p] = 1.0 / z_[p];
  for (Row& row : rows_) {
    row.weight = 0.0;
    // dx = push - weight dy follows from z ds + s dz = aim with ds = sign dx: dz = (aim - z ds) / s, and
    // sum of sign dz = dy + residual.
    double yields = kYield;
    for (int p = row.pair; p < row.pair + row.pairs; ++p) yields += z_[p] * per_s_[p];
    row.weight = 1.0 / yields;
    if (row.weight < kNoWeight) continue;
    factor_.diagonal(row.last).add(row.weight, row.on_last, row.on_last);
    // Of the row's outer product with itself: two diagonal blocks and the one below them.
    if (row.first < 0) continue;
    factor_.diagonal(row.first).add(row.weight, row.on_first, row.on_first);
    factor_.below(row.slot).add(row.weight, row.on_last, row.on_first);
  }
  return factor_.factor(go_on);
}

/// Newton's direction towards products that all are `centre` times their mean; `corrected` by the products of
/// the direction before.
BRINK_WIDE void InteriorPoint::find_direction(double centre, bool corrected) {
  // (M + J^T W J) du = imbalance + J^T push, from M du = imbalance + J^T dx and dx = push - W J du
  const double product = pairs_ == 0 ? 0.0 : centre * gap_ / pairs_;
  const std::size_t count = s_.size();
  // (s + ds)(z + dz) = product, with the term ds dz of second order as the predictor has left it
  if (corrected)
    for (std::size_t p = 0; p < count; ++p) aim_[p] = product - s_[p] * z_[p] - ds_[p] * dz_[p];
  else
    for (std::size_t p = 0; p < count; ++p) aim_[p] = product - s_[p] * z_[p];
  solve_for_aim();
}

/// Asks for products at the end of a longer step that lie in a range about what they are to be, where the direction leads out
/// of it: few pairs hold up all others. Keeps a direction that leads farther. Source: Gondzio 1996, "Multiple centrality
/// corrections in a primal-dual method for linear programming".
BRINK_WIDE void InteriorPoint::correct_outliers(double centre) {
  const double product = centre * gap_ / std::max(1, pairs_), high = product / kAlike;
  double reach = std::min(1.0, longest_step());
  for (int k = 0; k < kCorrections && reach < kAllTheWay; ++k) {
    const double tried = std::min(1.0, reach + kLonger);
    for (std::size_t p = 0; p < s_.size(); ++p) {
      const double there = (s_[p] + tried * ds_[p]) * (z_[p] + tried * dz_[p]);
      // what is far too large is asked to fall by no more than the range is wide
      aim_[p] += std::max(std::clamp(there, kAlike * product, high) - there, -high);
    }
    swap_direction();
    solve_for_aim();
    const double farther = std::min(1.0, longest_step());
    if (farther < reach) swap_direction();
    if (farther < reach + kWorthIt) return;
    reach = farther;
  }
}

void InteriorPoint::swap_direction() {
  du_.swap(other_.du);
  ds_.swap(other_.ds);
  dz_.swap(other_.dz);
}

/// Newton's direction towards products that change by what is aimed for. All of it is made anew.
BRINK_WIDE void InteriorPoint::solve_for_aim() {
  const std::size_t count = s_.size();
  du_ = imbalance_;
  for (Row& row : rows_) {
    row.push = 0.0;
    // The residual goes in as well, so that a whole step brings it to 0.
    const int p = row.pair;
    const double dy = row.pairs == 1 ? aim_[p] * per_s_[p] - row.residual
                                     : aim_[p + 1] * per_s_[p + 1] - aim_[p] * per_s_[p] - row.residual;
    row.push = row.weight * dy;
    du_[row.last].add(row.push, row.on_last);
    if (row.first >= 0) du_[row.first].add(row.push, row.on_first);
  }
  factor_.solve(du_);
  for (const Row& row : rows_) {
    double dy = row.on_last.dot(du_[row.last]);
    if (row.first >= 0) dy += row.on_first.dot(du_[row.first]);
    const double dx = row.push - row.weight * dy;
    ds_[row.pair] = row.pairs == 1 ? dx : -dx;
    if (row.pairs == 2) ds_[row.pair + 1] = dx;
  }
  for (std::size_t p = 0; p < count; ++p) dz_[p] = (aim_[p] - z_[p] * ds_[p]) * per_s_[p];
}

/// How far the direction goes until a first s or z is 0, in whole steps; at most 2.
BRINK_WIDE double InteriorPoint::longest_step() const {
  // The largest part of any s or z that a whole step takes. At least 1/2, so that part_of_way() of what meets no bound
  // still is a whole Newton step.
  double most[kLanes];
  std::fill(most, most + kLanes, 0.5);
  const auto see = [&](std::size_t lane, std::size_t p) {
    const double a = -ds_[p] * per_s_[p], b = -dz_[p] * per_z_[p];
    const double more = a > b ? a : b;
    most[lane] = more > most[lane] ? more : most[lane];
  };
  std::size_t p = 0;
  for (; p + kLanes <= s_.size(); p += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) see(lane, p + lane);
  for (; p < s_.size(); ++p) see(0, p);
  return 1.0 / *std::max_element(most, most + kLanes);
}

/// The sum of products a part of the direction on.
BRINK_WIDE double InteriorPoint::gap_after(double length) const {
  double sums[kLanes] = {};
  const auto add = [&](std::size_t lane, std::size_t p) {
    sums[lane] += (s_[p] + length * ds_[p]) * (z_[p] + length * dz_[p]);
  };
  std::size_t p = 0;
  for (; p + kLanes <= s_.size(); p += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) add(lane, p + lane);
  for (; p < s_.size(); ++p) add(0, p);
  double sum = 0.0;
  for (const double part : sums) sum += part;
  return sum;
}

BRINK_WIDE void InteriorPoint::take(double length) {
  for (std::size_t k = 0; k < u_.size(); ++k) u_[k].add(length, du_[k]);
  for (std::size_t p = 0; p < s_.size(); ++p) s_[p] += length * ds_[p];
  for (std::size_t p = 0; p < s_.size(); ++p) z_[p] += length * dz_[p];
}

double InteriorPoint::energy() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < u_.size(); ++k) {
    const Vec3 u = u_[k].vector();
    sum += u.dot(mass_[k].vector().cwiseProduct(u));
  }
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
    const double x = std::abs(force_of(row));
    carried[row.last] += x * row.on_last.vector().cwiseAbs().maxCoeff();
    if (row.first >= 0) carried[row.first] += x * row.on_first.vector().cwiseAbs().maxCoeff();
  }
  double most = 0.0;
  for (std::size_t k = 0; k < u_.size(); ++k)
    most = std::max(most, (imbalance_[k].vector().cwiseAbs().maxCoeff() - kRounding * carried[k]) /
                              mass_[k].vector().minCoeff());
  return most;
}

}  // namespace brink
