/// A formula's text becomes a list of nodes, arguments before what they are given to. The nodes of a subtree
/// stand in one row and end with its root, so that a bound is one pass over the row without recursion:
///
///   for each node of the row: number, time or call of a function of Taylor series on nodes before it
///
/// The grammar is muParser's, whose value and this tree must mean the same. From loose to tight:
///
///   ?:      ||      &&      comparisons      + -      * /      signs      ^
#include "brink/core/world/formula_tree.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>

namespace brink {

namespace {

using Arguments = std::vector<const Taylor*>;

/// Entries of the function table: of one argument, of two, and of any number taken from left to right.
template <Taylor (*f)(const Taylor&)>
Taylor one(const Arguments& a) {
  return f(*a[0]);
}
template <Taylor (*f)(const Taylor&, const Taylor&)>
Taylor two(const Arguments& a) {
  return f(*a[0], *a[1]);
}
template <Taylor (*f)(const Taylor&, const Taylor&)>
Taylor folded(const Arguments& a) {
  Taylor r = *a[0];
  for (std::size_t i = 1; i < a.size(); ++i) r = f(r, *a[i]);
  return r;
}

Taylor plus(const Taylor& a, const Taylor& b) { return a + b; }
Taylor minus(const Taylor& a, const Taylor& b) { return a - b; }
Taylor times(const Taylor& a, const Taylor& b) { return a * b; }
Taylor quotient(const Taylor& a, const Taylor& b) { return a / b; }
Taylor opposite(const Taylor& a) { return -a; }
Taylor same(const Taylor& a) { return a; }
/// Comparisons by those that Taylor has, with sides exchanged or the answer turned round.
Taylor greater(const Taylor& a, const Taylor& b) { return less(b, a); }
Taylor greater_equal(const Taylor& a, const Taylor& b) { return less_equal(b, a); }
Taylor unequal(const Taylor& a, const Taylor& b) { return negation(equal(a, b)); }
// a && b: neither is 0. a || b: not both are. small() is 1 of what is 0 and leaves open what lies between 0
// and 1 in size:
// muParser's && and || cut their sides to whole numbers first where both are constants, and else do not
Taylor both(const Taylor& a, const Taylor& b) { return negation(max(small(a), small(b))); }
Taylor either(const Taylor& a, const Taylor& b) { return negation(min(small(a), small(b))); }
Taylor chosen(const Arguments& a) { return choose(*a[0], *a[1], *a[2]); }

Taylor constant(double x, int order) { return Taylor::constant(Interval(x), order); }
/// By natural logarithms: log_b a = log a / log b.
Taylor log_to(const Taylor& a, double base) { return log(a) / log(constant(base, a.order)); }
Taylor log2_of(const Taylor& a) { return log_to(a, 2.0); }
Taylor log10_of(const Taylor& a) { return log_to(a, 10.0); }
Taylor mean(const Arguments& a) {
  return folded<plus>(a) / constant(static_cast<double>(a.size()), a[0]->order);
}
Taylor triangle_cosine(const Taylor& a) {  // acos(cos(a))
  // acos x = pi / 2 - asin x and cos a = sin(a + pi / 2), so that it is a triangle wave moved and turned
  // over.
  const Interval half = boost::numeric::interval_lib::pi<Interval>() / 2.0;
  const Taylor quarter = Taylor::constant(half, a.order);
  return quarter - triangle(a + quarter);
}

/// As many arguments as are given.
constexpr int kAny = 1000000;

}  // namespace

/// The function or operator of that name, or null. Operators stand here under names that cannot be written
/// as one, so that a formula does not call them like functions; "asin sin" and "acos cos" are what call() puts
/// for the two compositions. `log` is the natural one, as in muParser. The last entry is an end mark.
const FormulaTree::Function* FormulaTree::find(std::string_view name) {
  static const std::array<Function, 45> all{{
      {"sin", 1, 1, one<sin>},
      {"cos", 1, 1, one<cos>},
      {"tan", 1, 1, one<tan>},
      {"asin", 1, 1, one<asin>},
      {"acos", 1, 1, one<acos>},
      {"atan", 1, 1, one<atan>},
      {"atan2", 2, 2, two<atan2>},
      {"sinh", 1, 1, one<sinh>},
      {"cosh", 1, 1, one<cosh>},
      {"tanh", 1, 1, one<tanh>},
      {"asinh", 1, 1, one<asinh>},
      {"acosh", 1, 1, one<acosh>},
      {"atanh", 1, 1, one<atanh>},
      {"log2", 1, 1, one<log2_of>},
      {"log10", 1, 1, one<log10_of>},
      {"log", 1, 1, one<log>},
      {"ln", 1, 1, one<log>},
      {"exp", 1, 1, one<exp>},
      {"sqrt", 1, 1, one<sqrt>},
      {"sign", 1, 1, one<sign>},
      {"rint", 1, 1, one<rint>},
      {"abs", 1, 1, one<abs>},
      {"sum", 1, kAny, folded<plus>},
      {"avg", 1, kAny, mean},
      {"min", 1, kAny, folded<min>},
      {"max", 1, kAny, folded<max>},
      {"+", 2, 2, two<plus>},
      {"-", 2, 2, two<minus>},
      {"*", 2, 2, two<times>},
      {"/", 2, 2, two<quotient>},
      {"^", 2, 2, two<pow>},
      {"<", 2, 2, two<less>},
      {">", 2, 2, two<greater>},
      {"<=", 2, 2, two<less_equal>},
      {">=", 2, 2, two<greater_equal>},
      {"==", 2, 2, two<equal>},
      {"!=", 2, 2, two<unequal>},
      {"&&", 2, 2, two<both>},
      {"||", 2, 2, two<either>},
      {"?:", 3, 3, chosen},
      {"unary -", 1, 1, one<opposite>},
      {"unary +", 1, 1, one<same>},
      {"asin sin", 1, 1, one<triangle>},
      {"acos cos", 1, 1, one<triangle_cosine>},
      {"", 0, 0, nullptr},
  }};
  const auto it = std::find_if(all.begin(), all.end() - 1, [&](const Function& f) { return f.name == name; });
  return it == all.end() - 1 ? nullptr : &*it;
}

/// Recursive descent, one function for each level of precedence.
class FormulaReader {
 public:
  FormulaReader(std::string_view text, const std::vector<std::string>& variables, FormulaTree& tree)
      : text_(text), variables_(variables), tree_(tree) {}

  /// The root of the whole text, which must be used up.
  int read() {
    const int root = condition();
    skip_space();
    if (at_ < text_.size()) fail("\"" + std::string(text_.substr(at_, 1)) + "\" is not known here");
    return root;
  }

 private:
  using Node = FormulaTree::Node;

  [[noreturn]] static void fail(const std::string& what) { throw std::invalid_argument(what); }

  /// What is nested deeper would run out of stack.
  struct Level {
    explicit Level(int& counter) : depth(counter) {
      // A parenthesis takes two levels, one in condition() and one in signed_power(), hence "some hundred".
      if (++depth > 1000) fail("it is nested more than some hundred levels deep");
    }
    ~Level() { --depth; }
    int& depth;
  };

  /// Each function here reads what binds as tight as its name says, or tighter, and returns the node's index.
  /// condition() is right associative: a ? b : c ? d : e is a ? b : (c ? d : e).
  int condition() {
    const Level level(depth_);
    const int question = either();
    if (!take("?")) return question;
    const int yes = condition();
    if (!take(":")) fail("\":\" is missing");
    return call("?:", {question, yes, condition()});
  }
  int either() {
    return left_to_right({"||"}, [this] { return both(); });
  }
  int both() {
    return left_to_right({"&&"}, [this] { return comparison(); });
  }
  int comparison() {
    // The long ones first: "<" would take half of "<=".
    return left_to_right({"<=", ">=", "!=", "==", "<", ">"}, [this] { return sum(); });
  }
  int sum() {
    return left_to_right({"+", "-"}, [this] { return product(); });
  }
  int product() {
    return left_to_right({"*", "/"}, [this] { return signed_power(); });
  }
  /// A power binds tighter than the sign before it, -2^2 = -(2^2), but its exponent may have a sign, 2^-1;
  /// powers go from right to left, 2^3^2 = 2^(3^2).
  int signed_power() {
    // Chains of signs and of powers recurse without a parenthesis.
    const Level level(depth_);
    for (const char* sign : {"-", "+"})
      if (take(sign)) return call(std::string("unary ") + sign, {signed_power()});
    const int base = primary();
    return take("^") ? call("^", {base, signed_power()}) : base;
  }
  /// A parenthesis, a number, or what begins with a name.
  int primary() {
    skip_space();
    if (take("(")) {
      const int inside = condition();
      if (!take(")")) fail("\")\" is missing");
      return inside;
    }
    if (at_ < text_.size() && (is_digit(text_[at_]) || text_[at_] == '.')) return number();
    return named();
  }

  /// Operands joined by operators of one level, (a - b) - c.
  template <class Operand>
  int left_to_right(std::initializer_list<const char*> operators, Operand operand) {
    int left = operand();
    for (;;) {
      const auto it =
          std::find_if(operators.begin(), operators.end(), [this](const char* o) { return take(o); });
      if (it == operators.end()) return left;
      left = call(*it, {left, operand()});
    }
  }

  /// Without a sign, which is an operator. from_chars() knows no locale: the decimal point is a point
  /// everywhere.
  int number() {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc()) fail("a number that is not understood");
    at_ = static_cast<std::size_t>(end - text_.data());
    return constant(value);
  }

  /// A call where "(" follows, else a variable or one of the two constants.
  int named() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    const std::string_view name = text_.substr(begin, at_ - begin);
    if (name.empty()) fail("a value is missing");
    if (take("(")) return function(name);
    if (std::find(variables_.begin(), variables_.end(), name) != variables_.end()) return variable(name);
    if (name == "pi") return constant(3.14159265358979323846);
    if (name == "e") return constant(2.71828182845904523536);
    fail(fmt::format("\"{}\" is not known", name));
  }

  /// The arguments behind "(", at least one.
  int function(std::string_view name) {
    std::vector<int> arguments;
    do arguments.push_back(condition());
    while (take(","));
    if (!take(")")) fail("\")\" is missing");
    return call(name, std::move(arguments));
  }

  int constant(double value) {
    Node node;
    node.number = Interval(value);
    return add(std::move(node));
  }
  int variable(std::string_view name) {
    Node node;
    node.kind = name == "t" ? Node::Kind::time : Node::Kind::other_variable;
    node.in_time = name == "t";
    node.of_others = !node.in_time;
    return add(std::move(node));
  }

  /// A triangle wave is known as what it is: bounds of an arc sine near 1 say little.
  int call(std::string_view name, std::vector<int> arguments) {
    if (name == "asin" || name == "acos") {
      const Node& inner = tree_.nodes_[arguments.front()];
      const std::string_view wave = name == "asin" ? "sin" : "cos";
      if (inner.kind == Node::Kind::call && inner.function->name == wave) {
        // The node of the inner wave stays in the row, and nothing uses it.
        arguments = inner.arguments;
        return call(name == "asin" ? "asin sin" : "acos cos", std::move(arguments));
      }
    }
    Node node;
    node.kind = Node::Kind::call;
    node.function = FormulaTree::find(name);
    const int count = static_cast<int>(arguments.size());
    if (!node.function || count < node.function->least || count > node.function->most)
      fail("the function \"" + std::string(name) + "\" is not known");
    // The row of a call begins where that of its first argument does.
    node.first = static_cast<int>(tree_.nodes_.size());
    for (const int a : arguments) {
      node.first = std::min(node.first, tree_.nodes_[a].first);
      node.in_time |= tree_.nodes_[a].in_time;
      node.of_others |= tree_.nodes_[a].of_others;
    }
    node.arguments = std::move(arguments);
    return add(std::move(node));
  }

  int add(Node node) {
    if (node.arguments.empty()) node.first = static_cast<int>(tree_.nodes_.size());
    tree_.nodes_.push_back(std::move(node));
    return static_cast<int>(tree_.nodes_.size()) - 1;
  }

  static bool is_digit(char c) { return c >= '0' && c <= '9'; }
  /// Names are ASCII: the text of a formula is taken byte by byte.
  static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
  /// Whatever is not above the space, as muParser skips it; bytes beyond ASCII are negative or above, and
  /// stay.
  void skip_space() {
    while (at_ < text_.size() && text_[at_] > 0 && text_[at_] <= ' ') ++at_;
  }
  /// Reads `token` if it comes next, spaces before it included.
  bool take(std::string_view token) {
    skip_space();
    if (text_.substr(at_, token.size()) != token) return false;
    at_ += token.size();
    return true;
  }

  std::string_view text_;
  const std::vector<std::string>& variables_;
  FormulaTree& tree_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

FormulaTree::FormulaTree(std::string_view text, const std::vector<std::string>& variables) {
  const int root = FormulaReader(text, variables, *this).read();
  find_parts(root);
}

/// Goes down from the root through what uses other variables; what is met that uses none of them but the time
/// is a part, and is not divided. Parts without the time change nothing with it and are left out.
void FormulaTree::find_parts(int root) {
  std::vector<int> open{root};
  while (!open.empty()) {
    const int at = open.back();
    const Node& n = nodes_[at];
    open.pop_back();
    if (n.of_others)
      open.insert(open.end(), n.arguments.begin(), n.arguments.end());
    else if (n.in_time || at == root)
      parts_.push_back(at);
  }
}

Taylor FormulaTree::over(int part, double from, double to, int order) const {
  const int root = parts_.at(part), first = nodes_[root].first;
  // of the nodes from `first` on: arguments come before what they are given to; kept, as it is asked often
  static thread_local std::vector<Taylor> values;
  static thread_local Arguments arguments;
  values.clear();
  values.reserve(root - first + 1);  // arguments point into it
  // A part uses no variable but the time, so that every leaf of its row is a number or the time.
  for (int i = first; i <= root; ++i) {
    const Node& n = nodes_[i];
    arguments.clear();
    for (const int a : n.arguments) arguments.push_back(&values[a - first]);
    if (n.kind == Node::Kind::call)
      values.push_back(n.function->apply(arguments));
    else
      values.push_back(n.kind == Node::Kind::time ? Taylor::time(Interval(from, to), order)
                                                  : Taylor::constant(n.number, order));
  }
  return values.back();
}

}  // namespace brink
