/// One text, read twice: muParser compiles it for values, FormulaTree for bounds over a while. A formula is
/// accepted where both can read it, so that what has a value has a bound too.
#include "brink/core/world/formula.h"

#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "brink/core/base/elementary.h"
#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/core/base/sine_cosine.h"
#include "brink/core/world/formula_tree.h"

namespace brink {

namespace {

/// "t, x, y" for messages; "none" where there are none.
std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

/// Throws BadInput about a formula. `position` counts from 0 and is told from 1; -1: none is told. The text
/// comes from a file: it is shown by printable().
[[noreturn]] void fail(const std::string& text, int position, const std::string& what,
                       const std::vector<std::string>& variables) {
  std::string message = "formula \"" + printable(text) + "\": ";
  if (position >= 0) message += "at character " + std::to_string(position + 1) + ": ";
  throw BadInput(message + what + "; allowed variables: " + joined(variables) + "; constants: pi, e");
}

/// Position of a single '=' (an assignment, which would change a variable), or -1.
int find_assignment(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    // "==" compares; "<=", ">=" and "!=" end in a "=" that does.
    if (i + 1 < text.size() && text[i + 1] == '=') {
      ++i;
      continue;
    }
    if (i > 0 && (text[i - 1] == '<' || text[i - 1] == '>' || text[i - 1] == '!')) continue;
    return static_cast<int>(i);
  }
  return -1;
}

/// muParser's own words, without the full stop: fail() goes on behind them. What it calls an unassignable
/// token is a name that it does not know.
std::string explain(const mu::Parser::exception_type& e) {
  if (e.GetCode() == mu::ecUNASSIGNABLE_TOKEN) return "unknown name \"" + e.GetToken() + "\"";
  std::string message = e.GetMsg();
  while (!message.empty() && (message.back() == '.' || message.back() == '\n')) message.pop_back();
  return message.empty() ? "cannot be understood" : message;
}

/// Of the motions and forces that people write, with the same bits on every machine; what is left to the C library
/// (tan, asin, atan, the hyperbolic functions, powers by `^` above the fourth) is as good as that.
void define_functions(mu::Parser& parser) {
  const auto define = [&](const char* name, double (*of)(double)) { parser.DefineFun(name, of); };
  define("sin", [](double x) { return sine_cosine(x).sine; });
  define("cos", [](double x) { return sine_cosine(x).cosine; });
  define("exp", [](double x) { return exponential(x); });
  define("ln", [](double x) { return logarithm(x); });
  define("log", [](double x) { return logarithm(x); });
  define("acos", [](double x) { return arc_cosine(x); });
  parser.DefineFun(
      "atan2", +[](double y, double x) { return angle_of(y, x); });
  // muParser's own lose all digits of asinh(-1e8)
  define("asinh", [](double x) { return std::asinh(x); });
  define("acosh", [](double x) { return std::acosh(x); });
  define("atanh", [](double x) { return std::atanh(x); });
}

}  // namespace

/// The parser points into `values`, so a Compiled never moves and is never shared.
struct Formula::Compiled {
  std::string text;
  std::vector<std::string> variables;
  std::vector<double> values;
  mu::Parser parser;
  std::optional<FormulaTree> tree;
  std::mutex busy;  ///< the parser reads `values` where they are: one evaluation at a time

  Compiled(std::string formula, std::vector<std::string> names)
      : text(std::move(formula)), variables(std::move(names)), values(variables.size(), 0.0) {
    // Faults that are better told here than by muParser. An assignment would be accepted by it.
    if (text.find_first_not_of(" \t\r\n") == std::string::npos) fail(text, -1, "is empty", variables);
    if (const std::size_t nul = text.find('\0'); nul != std::string::npos)
      fail(text, static_cast<int>(nul), "holds a NUL character", variables);
    const int assignment = find_assignment(text);
    if (assignment >= 0) fail(text, assignment, "\"=\" assigns; compare with \"==\"", variables);
    compile();
  }

  /// Hands text and variables to muParser, then to the tree.
  void compile() {
    try {
      // muParser's own constants are _pi and _e, which FormulaTree does not know.
      parser.ClearConst();
      parser.DefineConst("pi", 3.14159265358979323846);
      parser.DefineConst("e", 2.71828182845904523536);
      define_functions(parser);
      for (std::size_t i = 0; i < variables.size(); ++i) parser.DefineVar(variables[i], &values[i]);
      // SetExpr() only keeps the text. The first evaluation compiles it and finds its faults; the value, with
      // all variables 0, is not looked at.
      parser.SetExpr(text);
      parser.Eval();
    } catch (const mu::Parser::exception_type& error) {
      fail(text, error.GetPos(), explain(error), variables);
    }
    if (parser.GetNumResults() != 1) fail(text, -1, "gives more than one value", variables);
    try {
      // After muParser, whose messages have a position and name what is allowed: what the tree refuses is
      // only what it cannot bound.
      tree.emplace(text, variables);
    } catch (const std::invalid_argument& error) {
      fail(text, -1, std::string("cannot be bounded: ") + error.what(), variables);
    }
  }
};

Formula::Formula(std::string text, std::vector<std::string> variables)
    : compiled_(std::make_unique<Compiled>(std::move(text), std::move(variables))) {}
Formula::Formula(const Formula& other)
    : compiled_(std::make_unique<Compiled>(other.compiled_->text, other.compiled_->variables)) {}
Formula& Formula::operator=(const Formula& other) { return *this = Formula(other); }
Formula::Formula(Formula&&) noexcept = default;
Formula& Formula::operator=(Formula&&) noexcept = default;
Formula::~Formula() = default;

/// The variables are copied to where the parser reads them: hence the lock.
double Formula::operator()(std::span<const double> values) const {
  Compiled& c = *compiled_;
  if (values.size() != c.values.size())
    throw BadInput("formula \"" + c.text + "\": " + std::to_string(values.size()) + " values given for " +
                   std::to_string(c.values.size()) + " variables (" + joined(c.variables) + ")");
  const std::lock_guard<std::mutex> lock(c.busy);
  std::copy(values.begin(), values.end(), c.values.begin());
  try {
    return c.parser.Eval();
  } catch (const mu::Parser::exception_type&) {  // a domain error that muParser reports instead of NaN
    return std::nan("");
  }
}

int Formula::time_parts() const { return compiled_->tree->time_parts(); }

bool Formula::depends_on_time() const { return compiled_->tree->depends_on_time(); }

TimeBound Formula::time_bound(int part, double from, double to, BoundOf highest) const {
  const Taylor f = compiled_->tree->over(part, from, to, static_cast<int>(highest));
  // Coefficient k is f^(k) / k!: the second derivative is twice it, and TimeBound has the eleventh over 11!.
  TimeBound bound{f.value().lower(), f.value().upper()};
  if (highest >= BoundOf::second) bound.second = 2.0 * boost::numeric::norm(f.c[2]);
  if (highest >= BoundOf::eleventh) bound.eleventh = boost::numeric::norm(f.c[11]);
  return bound;
}

const std::string& Formula::text() const { return compiled_->text; }

}  // namespace brink
