#include "brink/core/world/formula.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "brink/core/base/error.h"

namespace brink::formula_test {
namespace {

using ::testing::HasSubstr;

double at(const Formula& formula, std::vector<double> values) { return formula(values); }

std::string fault(const std::string& text, std::vector<std::string> variables = {"t"}) {
  try {
    Formula formula(text, std::move(variables));
  } catch (const BadInput& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Formula, ValueIsTheExpressionInItsVariables) {
  EXPECT_EQ(at(Formula("0.1*sin(6*t)", {"t"}), {0.25}), 0.1 * std::sin(6 * 0.25));
  EXPECT_EQ(at(Formula("x - 2*vy", {"x", "vy"}), {1.0, 3.0}), -5.0);
  EXPECT_EQ(at(Formula("t < 1 ? 2 : 3", {"t"}), {0.5}), 2.0);
  EXPECT_EQ(at(Formula("t >= 1", {"t"}), {1.0}), 1.0);
}

TEST(Formula, KnowsPiAndE) {
  EXPECT_EQ(at(Formula("2*pi", {}), {}), 2 * 3.14159265358979323846);
  EXPECT_EQ(at(Formula("e", {}), {}), 2.71828182845904523536);
}

TEST(Formula, UnknownNameIsLocatedAndTheAllowedAreNamed) {
  const std::string message = fault("0.1*sin(6*q)", {"t", "x"});
  EXPECT_THAT(message, HasSubstr("formula \"0.1*sin(6*q)\""));
  EXPECT_THAT(message, HasSubstr("character 11"));
  EXPECT_THAT(message, HasSubstr("unknown name \"q\""));
  EXPECT_THAT(message, HasSubstr("allowed variables: t, x; constants: pi, e"));
}

TEST(Formula, WhatIsNotAFormulaIsRefused) {
  EXPECT_THAT(fault(""), HasSubstr("is empty"));
  EXPECT_THAT(fault("  "), HasSubstr("is empty"));
  EXPECT_THAT(fault("sin(t"), HasSubstr("formula \"sin(t\""));
  EXPECT_THAT(fault("1 +"), HasSubstr("formula \"1 +\""));
  EXPECT_THAT(fault("t = 3"), HasSubstr("character 3"));
  EXPECT_THAT(fault("1, 2"), HasSubstr("more than one value"));
  EXPECT_THAT(fault("\"text\""), HasSubstr("formula"));
  EXPECT_THAT(fault("sin(1, 2)"), HasSubstr("formula"));
  EXPECT_THAT(fault("t", {"pi"}), HasSubstr("formula"));
}

TEST(Formula, ValuesThatAreNotFiniteAreReturnedAsTheyAre) {
  EXPECT_EQ(at(Formula("1/t", {"t"}), {0.0}), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(at(Formula("sqrt(t)", {"t"}), {-1.0})));
  EXPECT_TRUE(std::isnan(at(Formula("t", {"t"}), {std::nan("")})));
}

TEST(Formula, WrongNumberOfValuesIsRefused) {
  const Formula formula("t", {"t"});
  EXPECT_THROW(at(formula, {}), BadInput);
  EXPECT_THROW(at(formula, {1.0, 2.0}), BadInput);
}

// A copy must not read its original's variables, which may be gone.
TEST(Formula, CopiesStandAlone) {
  auto original = std::make_unique<Formula>("2*t", std::vector<std::string>{"t"});
  const Formula copy = *original;
  Formula assigned("t", {"t"});
  assigned = copy;
  at(*original, {5.0});
  original.reset();
  EXPECT_EQ(at(copy, {1.5}), 3.0);
  EXPECT_EQ(at(assigned, {2.5}), 5.0);
  EXPECT_EQ(copy.text(), "2*t");
}

TEST(Formula, OneObjectMayBeEvaluatedByManyThreads) {
  const Formula formula("t*t + 1", {"t"});
  std::vector<std::thread> threads;
  std::array<int, 4> wrong{};
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      for (int k = 0; k < 20000; ++k) {
        const double t = k + 0.25 * i;
        if (at(formula, {t}) != t * t + 1) ++wrong[i];
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(wrong, ::testing::Each(0));
}

}  // namespace
}  // namespace brink::formula_test
