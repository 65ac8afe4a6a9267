/// Pieces are polynomials of x, y and angle at once. Those of a solver's step are made about its begin, where
/// the first two coefficients are pose and twist without rounding; what is to hold at the end is met by cubics
/// and quintics of s = t - begin, with h for the step's length.
#include "brink/integrators/dense_output.h"

#include <algorithm>

namespace brink {

namespace {

using Eigen::Vector3d;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// x, y, angle as one vector; so for rates and accelerations.
Vector3d stacked(const Pose& pose) { return {pose.position.x(), pose.position.y(), pose.angle}; }
Vector3d stacked(const Twist& twist) { return {twist.velocity.x(), twist.velocity.y(), twist.omega}; }
Vector3d stacked(const Acceleration& a) { return {a.linear.x(), a.linear.y(), a.angular}; }

/// True where what a step from a to b does not explain is rounding: of the two, or of the clock, which has moved them at
/// this rate. Divided by a tiny step it would turn into a large velocity and an enormous acceleration that are not there,
/// so it is left out: the piece then ends within rounding of the accepted pose.
bool is_rounding(double difference, double a, double b, double rate, double clock) {
  // of the clock half a rounding at either end of the step, and what h times the rate makes of them
  return std::abs(difference) <=
         kEpsilon * (8.0 * std::max(std::abs(a), std::abs(b)) + 2.0 * std::abs(rate * clock));
}

}  // namespace

bool is_rounding_of(double a, double b) {
  return std::abs(a - b) <= 8.0 * kEpsilon * std::max(std::abs(a), std::abs(b));
}

void add_cubic(PolynomialPiece& piece, const Vector3d& pose_begin, const Vector3d& rate_begin,
               const Vector3d& pose_end, const Vector3d& rate_end) {
  const double h = piece.end - piece.begin;
  const Vector3d pose_error = pose_end - pose_begin - h * rate_begin, rate_error = rate_end - rate_begin;
  PolynomialPiece cubic;
  cubic.origin = piece.begin;
  cubic.degree = 3;
  cubic.c[0] = pose_begin;
  cubic.c[1] = rate_begin;
  // Hermite's cubic, by what the tangent at the begin misses at the end, in pose and in rate.
  cubic.c[2] = (3.0 * pose_error - h * rate_error) / (h * h);
  cubic.c[3] = (h * rate_error - 2.0 * pose_error) / (h * h * h);
  if (piece.origin != piece.begin) move_origin(cubic, piece.origin);
  // coefficients beyond the degree are not initialised
  for (int k = piece.degree + 1; k <= 3; ++k) piece.c[k].setZero();
  piece.degree = std::max(piece.degree, 3);
  for (int k = 0; k <= 3; ++k) piece.c[k] += cubic.c[k];
}

/// The begin is set, the end corrected by a cubic with no pose and no rate at the begin.
void match_ends(PolynomialPiece& piece, const BodyState& from, const BodyState& to) {
  for (int k = piece.degree + 1; k <= 1; ++k) piece.c[k].setZero();
  piece.degree = std::max(piece.degree, 1);
  // With its origin at the begin the first two coefficients are pose and twist there:
  // exact, not to rounding.
  piece.c[0] = stacked(from.pose);
  piece.c[1] = stacked(from.twist);
  const Vector3d target = stacked(to.pose);
  const BodyState end = piece.state(piece.end);
  Vector3d pose_error = target - stacked(end.pose);
  for (int i = 0; i < 3; ++i)
    if (is_rounding(pose_error[i], piece.c[0][i], target[i], piece.c[1][i], piece.end)) pose_error[i] = 0.0;
  add_cubic(piece, Vector3d::Zero(), Vector3d::Zero(), pose_error, stacked(to.twist) - stacked(end.twist));
}

PolynomialPiece cubic_piece(double begin, const BodyState& from, double end, const BodyState& to) {
  PolynomialPiece piece;
  piece.begin = piece.origin = begin;
  piece.end = end;
  match_ends(piece, from, to);
  return piece;
}

PolynomialPiece quintic_piece(double begin, const BodyState& from, const Acceleration& at_begin, double end,
                              const BodyState& to, const Acceleration& at_end) {
  PolynomialPiece piece;
  piece.begin = piece.origin = begin;
  piece.end = end;
  piece.degree = 5;
  const double h = end - begin;
  const Vector3d x0 = stacked(from.pose), v0 = stacked(from.twist), a0 = stacked(at_begin);
  const Vector3d x1 = stacked(to.pose), v1 = stacked(to.twist), a1 = stacked(at_end);
  piece.c[0] = x0;
  piece.c[1] = v0;
  piece.c[2] = 0.5 * a0;
  // what the parabola misses at the end, times the powers of h that make them lengths
  const Vector3d x = x1 - (x0 + h * (v0 + 0.5 * h * a0));
  const Vector3d v = h * (v1 - (v0 + h * a0));
  const Vector3d a = h * h * (a1 - a0);
  for (int i = 0; i < 3; ++i) {
    // Pose, rate and second derivative of third s^3 + fourth s^4 + fifth s^5 at s = 1, s in units of h.
    // The solution of (1 1 1), (3 4 5), (6 12 20) times (third, fourth, fifth) = x, v, a.
    double third = 10.0 * x[i] - 4.0 * v[i] + 0.5 * a[i];
    double fourth = -15.0 * x[i] + 7.0 * v[i] - a[i];
    double fifth = 6.0 * x[i] - 3.0 * v[i] + 0.5 * a[i];
    // twist and acceleration alone: the pose follows to rounding
    if (is_rounding(x[i], x0[i], x1[i], v0[i], end)) {
      // 3 third + 4 fourth = v and 6 third + 12 fourth = a: a quartic.
      fourth = 0.25 * (a[i] - 2.0 * v[i]);
      third = (v[i] - 4.0 * fourth) / 3.0;
      fifth = 0.0;
    }
    piece.c[3][i] = third / (h * h * h);
    piece.c[4][i] = fourth / (h * h * h * h);
    piece.c[5][i] = fifth / (h * h * h * h * h);
  }
  return piece;
}

void move_origin(PolynomialPiece& piece, double origin) {
  // Taylor's coefficients about the new origin: each pass divides by (t - origin) once,
  // its remainder is the next.
  const double s = origin - piece.origin;
  for (int i = 0; i < piece.degree; ++i)
    for (int k = piece.degree - 1; k >= i; --k) piece.c[k] += s * piece.c[k + 1];
  piece.origin = origin;
}

}  // namespace brink
