/// Bounds of formulas against muParser's values, on random formulas and on those whose bounds are known.
#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/random.h"
#include "brink/core/world/formula_tree.h"
#include "brink/core/world/interval.h"
#include "brink/core/world/steady.h"
#include "tests/support/seeded_random.h"

namespace brink::formula_bound_test {
namespace {

double value(const Formula& f, double t) { return f(std::span<const double>(&t, 1)); }

template <std::size_t n>
std::string any(Random& random, const char* const (&of)[n]) {
  return of[random.below(n)];
}

/// A random formula of t in all that muParser's grammar has. A `total` one has a value everywhere: what
/// muParser makes of a comparison or a maximum of what has none is nobody's business.
std::string random_formula(Random& random, int depth, bool total = false) {
  if (depth == 0 || random.below(6) == 0)
    return any(random, {"t", "t", "t", "2", "0.5", "1e-1", ".25", "3.", "pi", "e", "1E+1"});
  const auto part = [&] { return random_formula(random, depth - 1, total); };
  const auto sure = [&] { return random_formula(random, depth - 1, true); };
  switch (random.below(total ? 5 : 7)) {
    case 0:
      return part() + any(random, {" + ", "-", "*", " * ", "- ", " +"}) + part();
    case 1:
      return any(random, {"sin", "cos", "atan", "abs", "tanh", "asinh", "sign", "rint"}) + "(" + part() + ")";
    case 2:
      return any(random, {"min", "max", "sum", "avg"}) + "(" + sure() + ", " + sure() + "," + sure() + ")";
    case 3:
      return any(random, {"(-", "(+"}) + part() + any(random, {")", ")^2", ")^3"});
    case 4:
      return "(" + sure() + any(random, {"<", ">", "<=", ">=", "==", "!=", "&&", "||"}) + sure() + "?" +
             part() + ":" + part() + ")";
    case 5:
      return part() + any(random, {"/", "^", "/ ", " ^ ", "^-"}) + part();
    default:
      return any(random, {"tan", "asin", "acos", "sinh", "cosh", "acosh", "atanh", "log2", "log10", "log",
                          "ln", "exp", "sqrt"}) +
             "(" + part() + ")";
  }
}

/// What roundings may have made of the value at t, on both sides.
double slack(const Formula& f, double t, double v) {
  return 1e-11 * std::max(1.0, std::abs(v)) + 10.0 * f.time_bound(0, t, t, BoundOf::value).spread();
}

// At a single time the bounds are muParser's value and its roundings: tree and parser read the same.
TEST(FormulaBound, OfRandomFormulasHoldMuParsersValues) {
  SeededRandom random(11);
  int finite = 0, told = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string text = random_formula(random, 4);
    const Formula f(text, {"t"});
    for (int j = 0; j < 5; ++j) {
      const double t = random.uniform(-3.0, 3.0), width = std::exp(random.uniform(-14.0, 1.0));
      const TimeBound b = f.time_bound(0, t, t + width), here = f.time_bound(0, t, t, BoundOf::value);
      for (const double at : {t, t + 0.3 * width, t + width}) {
        const double v = value(f, at);
        if (!std::isfinite(v)) continue;
        ++finite;
        ASSERT_LE(b.low, v + slack(f, at, v)) << text << " at t = " << at << " in " << t << " + " << width;
        ASSERT_GE(b.high, v - slack(f, at, v)) << text << " at t = " << at << " in " << t << " + " << width;
      }
      const double v = value(f, t);
      if (!std::isfinite(v)) continue;
      ASSERT_LE(here.low, v + slack(f, t, v)) << text << " at t = " << t;
      ASSERT_GE(here.high, v - slack(f, t, v)) << text << " at t = " << t;
      told += here.spread() < 1e-6 * std::max(1.0, std::abs(v));
    }
  }
  EXPECT_GT(finite, 15000);
  EXPECT_GT(told, 6000) << "bounds at one time that are nearly a point";
}

// Taylor's theorem: the coefficients at one time, and the eleventh over the interval, hold every value.
TEST(FormulaBound, CoefficientsAreThoseOfTaylorsTheorem) {
  SeededRandom random(12);
  int smooth = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::string text = random_formula(random, 3);
    const Formula f(text, {"t"});
    const FormulaTree tree(text, {"t"});
    const double t = random.uniform(0.1, 2.0), h = random.uniform(1e-3, 0.1);
    const Taylor at = tree.over(0, t, t, 11), over = tree.over(0, t, t + h, 11);
    const double v = value(f, t + h);
    if (!(boost::numeric::norm(over.c[11]) < 1e12) || !std::isfinite(v)) continue;
    Interval sum = over.c[11];
    for (int k = 10; k >= 0; --k) sum = sum * h + at.c[k];
    ++smooth;
    ASSERT_LE(sum.lower(), v + slack(f, t + h, v)) << text << " at t = " << t << " + " << h;
    ASSERT_GE(sum.upper(), v - slack(f, t + h, v)) << text << " at t = " << t << " + " << h;
  }
  EXPECT_GT(smooth, 1000);
}

// d/dt of 0.1 sin(6 t) to the second and eleventh are 3.6 sin and 6^11 / 11! 0.1 cos: bounds tend to them.
TEST(FormulaBound, OfASineAreItsDerivatives) {
  const TimeBound b = Formula("0.1*sin(6*t)", {"t"}).time_bound(0, 0.25, 0.25 + 1e-9);
  EXPECT_NEAR(b.low, 0.1 * std::sin(1.5), 1e-8);
  EXPECT_NEAR(b.second, 3.6 * std::sin(1.5), 1e-6);
  EXPECT_NEAR(b.eleventh, 0.1 * std::pow(6.0, 11) / 39916800.0 * std::cos(1.5), 1e-6);
}

// Where a function has no derivative, a constant may stand all the same.
TEST(FormulaBound, ConstantsAtTheEndOfADomainHaveNoDerivatives) {
  for (const char* text : {"acosh(1) + t", "asin(1) + t", "sqrt(0) + t"})
    EXPECT_EQ(Formula(text, {"t"}).time_bound(0, 0.0, 1.0).second, 0.0) << text;
}

TEST(FormulaBound, OwnsUpToASpikeThatNoSampleMeets) {
  const Formula f("max(0, 0.3 - abs(t - 0.7031)*300)", {"t"});
  const TimeBound b = f.time_bound(0, 0.0, 64.0);
  EXPECT_GE(b.high, 0.3);
  EXPECT_TRUE(std::isinf(b.second));
  EXPECT_EQ(f.time_bound(0, 0.0, 0.7).high, 0.0);
}

// Between its corners the triangle wave is straight: no derivative beyond the first.
TEST(FormulaBound, OfTheTriangleWaveAreThoseOfStraightPieces) {
  for (const char* text : {"asin(sin(t))", "acos(cos(t + pi/2))"}) {
    const Formula f(text, {"t"});
    EXPECT_EQ(f.time_bound(0, 1.6, 4.7).second, 0.0) << text;
    EXPECT_TRUE(std::isinf(f.time_bound(0, 1.5, 1.6).second)) << text;
    EXPECT_LT(f.time_bound(0, 1.5, 1.6).spread(), 0.11) << text;
    SeededRandom random(13);
    for (int i = 0; i < 10000; ++i) {
      const double t = random.uniform(-100.0, 100.0);
      EXPECT_NEAR(f.time_bound(0, t, t).low, value(f, t), 5e-8) << text << ": so rough is an arc sine near 1";
    }
  }
}

TEST(FormulaBound, PartsOfTheTimeAloneAreAsLargeAsCanBe) {
  const std::vector<std::string> names{"t", "x"};
  EXPECT_EQ(Formula("sin(2*t + 1)", names).time_parts(), 1);
  EXPECT_EQ(Formula("x*sin(2*t) + abs(t - 1)*x + 3", names).time_parts(), 2);
  EXPECT_EQ(Formula("x + 3", names).time_parts(), 0);
  EXPECT_FALSE(Formula("3", names).depends_on_time());
}

TEST(FormulaBound, DeepNestingIsRefusedAndLongSumsAreNot) {
  std::string deep = "t", sum = "t";
  for (int i = 0; i < 2000; ++i) deep = "(" + deep + ")";
  for (int i = 0; i < 2000; ++i) sum += "+t";
  EXPECT_ANY_THROW(Formula(deep, {"t"}));
  EXPECT_NEAR(Formula(sum, {"t"}).time_bound(0, 1.0, 1.0).low, 2001.0, 1e-6);
}

// A smooth function far from anything: cells of the size of its waves. A spike: cells that end inside it.
TEST(FormulaSteady, CellsAreAsSmallAsTheFormulaIsShort) {
  const Formula wave("sin(6*t)", {"t"}), still("3", {"t"}), straight("4*t", {"t"});
  const auto steady_until = [](const Formula& f, double t) { return SteadyFormula(f, 0).until(t); };
  EXPECT_GT(steady_until(wave, 1.0), 1.05);
  EXPECT_LT(steady_until(wave, 1.0), 3.0);
  EXPECT_TRUE(std::isinf(steady_until(still, 1.0)));
  EXPECT_EQ(steady_until(straight, 1.0), 128.0);
  const Formula spike("max(0, 0.3 - abs(t - 0.7031)*300)", {"t"});
  EXPECT_LE(steady_until(spike, 0.7), 0.7021);  // narrower cells are not passed at once
  int inside = 0;
  for (double t = 0.0; t < 1.0; t = steady_until(spike, t)) inside += t > 0.7021 && t < 0.7041;
  EXPECT_GT(inside, 10);
}

// What was asked before is remembered, but makes no difference.
TEST(FormulaSteady, IsAFunctionOfTimeAlone) {
  Random random(11);
  for (const char* text : {"sin(6*t)", "max(0, 0.3 - abs(t - 70.31)*30)", "t^3 - 40*t", "sqrt(t)"}) {
    const Formula formula(text, {"t"});
    SteadyFormula asked_often(formula, 0);
    double t = 0.0;
    for (int k = 0; k < 300; ++k) {
      t = k % 3 == 0 ? 200.0 * random.uniform() : t + 0.1 * random.uniform();
      EXPECT_EQ(asked_often.until(t), SteadyFormula(formula, 0).until(t)) << text << " at " << t;
    }
  }
}

// Outward rounding goes to the next double, as the library's nextafter does, from every kind of number.
TEST(OutwardRounding, GoesToTheNextDouble) {
  constexpr double kInfinity = OutwardRounding::kInfinity, kLeast = std::numeric_limits<double>::denorm_min(),
                   kMost = std::numeric_limits<double>::max();
  for (const double x : {0.0, -0.0, 1.0, -1.0, 0.1, -1e-300, 1e300, kLeast, -kLeast, kMost, -kMost}) {
    EXPECT_EQ(OutwardRounding::above(x), std::nextafter(x, kInfinity)) << x;
    EXPECT_EQ(OutwardRounding::below(x), std::nextafter(x, -kInfinity)) << x;
  }
  EXPECT_EQ(OutwardRounding::above(kInfinity), kInfinity);
  EXPECT_EQ(OutwardRounding::below(kInfinity), kMost);
  EXPECT_EQ(OutwardRounding::above(-kInfinity), -kMost);
  EXPECT_EQ(OutwardRounding::above(std::nan("")), kInfinity);
  EXPECT_EQ(OutwardRounding::below(std::nan("")), -kInfinity);
}

}  // namespace
}  // namespace brink::formula_bound_test
