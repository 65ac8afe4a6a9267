/// All readers keep to one form: on a fault they tell the document key, value and what is allowed, and
/// return false; they go on as far as they can, so that one run of the program tells every fault of a
/// file. What they have read into `out` until then means nothing.
#include "brink/scenes/toml/codec.h"

#include <algorithm>
#include <cmath>

namespace brink {
namespace {

/// Tells that the value of `key` is of a type that is not allowed, at its place.
void wrong_type(const toml::node& node, TomlDocument& doc, const std::string& key,
                const std::string& allowed) {
  doc.faults().add(doc.where(node), fault_text(key, "wrong type", given(node), allowed));
}

// A finite number within kLargest, from a TOML float or integer.
// In the range of `key`: most ranges end at kLargest, those of masses and strengths farther away.
bool read_number(const toml::node& node, TomlDocument& doc, const std::string& key, const Range& range,
                 double& out) {
  if (!node.is_number()) return wrong_type(node, doc, key, range.text()), false;
  out = node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
  // A range ends at finite numbers, and every comparison with NaN is false: so what is not finite is out
  // of range, and only the message tells the two apart.
  if (range.holds(out)) return true;
  const char* wrong = std::isfinite(out) ? "out of range" : "not a finite number";
  doc.faults().add(doc.where(node), fault_text(key, wrong, given(node), range.text()));
  return false;
}

/// [x, y], each within `range`; the fault of a part stands at that part.
bool read_point(const toml::node& node, TomlDocument& doc, const std::string& key, const Range& range,
                Vec2& out) {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != 2)
    return wrong_type(node, doc, key, "two numbers [x, y]" + (range.unit.empty() ? "" : " in " + range.unit)),
           false;
  // Both are read though the first is wrong: both faults are told.
  // @post both are finite where true is returned.
  const bool x = read_number((*array)[0], doc, key, range, out.x());
  const bool y = read_number((*array)[1], doc, key, range, out.y());
  return x && y;
}

Json point_json(const Vec2& p) { return Json::array({p.x(), p.y()}); }

/// Texts end at a NUL for whatever is written in C: a formula, a name shown or stored would be cut there.
bool read_string(const toml::node& node, TomlDocument& doc, const std::string& key, std::string& out) {
  out = node.as_string()->get();
  const std::size_t nul = out.find('\0');
  if (nul == std::string::npos) return true;
  doc.faults().add(
      doc.where(node),
      fault_text(key, "holds a NUL character",
                 in_quotes(out) + " (character " + std::to_string(nul + 1) + ")", "text without"));
  return false;
}

// Lists of words are short: looked through one by one.
bool holds(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// A word of `allowed`, any text where that is empty. A word of `later` is told as one that is to come,
/// not as a mistake.
bool read_name(const toml::node& node, TomlDocument& doc, const std::string& key,
               const std::vector<std::string>& allowed, const std::vector<std::string>& later,
               std::string& out) {
  const auto* string = node.as_string();
  const std::string what = allowed.empty() ? "a string" : "one of " + listed(allowed);
  if (string == nullptr) return wrong_type(node, doc, key, what), false;
  if (!read_string(node, doc, key, out)) return false;
  if (allowed.empty() || holds(allowed, out)) return true;
  const char* wrong = holds(later, out) ? "not available in this release" : "not known";
  doc.faults().add(doc.where(node), fault_text(key, wrong, in_quotes(out), what));
  return false;
}

}  // namespace

std::string fault_text(const std::string& key, const std::string& wrong, const std::string& what_was_given,
                       const std::string& allowed) {
  return key + ": " + wrong + "; given " + what_was_given + ", allowed: " + allowed;
}

// An end at kLargest or beyond is no limit that anybody meets: it is named only where there is no
// other.
std::string Range::text() const {
  std::string text = "a number";
  if (low > -kLargest) text += (open_low ? " > " : " >= ") + number_text(low);
  if (high < kLargest) text += (low > -kLargest ? " and <= " : " <= ") + number_text(high);
  if (low <= -kLargest && high >= kLargest) text += " of at most " + number_text(kLargest);
  return unit.empty() ? text : text + " in " + unit;
}

Range any(std::string unit) { return {-kLargest, kLargest, false, std::move(unit)}; }
// Open at 0 alone: a least value that is given is itself allowed.
Range positive(std::string unit, double low) { return {low, kLargest, low == 0.0, std::move(unit)}; }
Range not_negative(std::string unit) { return {0.0, kLargest, false, std::move(unit)}; }
Range between(double low, double high, std::string unit) { return {low, high, false, std::move(unit)}; }

Codec<double> number(Range range) {
  const std::string type = range.text();
  return {type,
          [range](const toml::node& node, TomlDocument& doc, const std::string& key, double& out) {
            return read_number(node, doc, key, range, out);
          },
          [](const double& x) { return Json(x); }};
}

// Whole numbers of TOML only: 3.0 is refused, as whoever writes it means a measure and not a number of
// things.
Codec<std::int64_t> integer(std::int64_t low, std::int64_t high) {
  const std::string type = high == std::numeric_limits<std::int64_t>::max()
                               ? "an integer >= " + std::to_string(low)
                               : "an integer from " + std::to_string(low) + " to " + std::to_string(high);
  return {type,
          [=](const toml::node& node, TomlDocument& doc, const std::string& key, std::int64_t& out) {
            if (!node.is_integer()) return wrong_type(node, doc, key, type), false;
            out = node.as_integer()->get();
            if (out >= low && out <= high) return true;
            doc.faults().add(doc.where(node), fault_text(key, "out of range", given(node), type));
            return false;
          },
          [](const std::int64_t& x) { return Json(x); }};
}

Codec<std::array<std::int64_t, 2>> two_integers(std::int64_t low, std::int64_t high,
                                                const std::string& names) {
  const std::string type = names + ", integers from " + std::to_string(low) + " to " + std::to_string(high);
  return {type,
          [=](const toml::node& node, TomlDocument& doc, const std::string& key,
              std::array<std::int64_t, 2>& out) {
            const toml::array* array = node.as_array();
            if (array == nullptr || array->size() != 2) return wrong_type(node, doc, key, type), false;
            // The range of both is the same; the fault of one names that one's value.
            const Codec<std::int64_t> one = integer(low, high);
            const bool first = one.read((*array)[0], doc, key, out[0]);
            return one.read((*array)[1], doc, key, out[1]) && first;
          },
          [](const std::array<std::int64_t, 2>& x) { return Json(x); }};
}

Codec<bool> flag() {
  return {"true or false",
          [](const toml::node& node, TomlDocument& doc, const std::string& key, bool& out) {
            if (!node.is_boolean()) return wrong_type(node, doc, key, "true or false"), false;
            out = node.as_boolean()->get();
            return true;
          },
          [](const bool& x) { return Json(x); }};
}

Codec<std::string> text(std::string type) {
  return {type,
          [type](const toml::node& node, TomlDocument& doc, const std::string& key, std::string& out) {
            if (!node.is_string()) return wrong_type(node, doc, key, "a " + type), false;
            return read_string(node, doc, key, out);
          },
          [](const std::string& x) { return Json(x); }};
}

// What is allowed already is not told as yet to come.
Codec<std::string> choice(std::vector<std::string> allowed, std::vector<std::string> later) {
  std::erase_if(later, [&](const std::string& word) { return holds(allowed, word); });
  const std::string type = listed(allowed);
  return {type,
          [=](const toml::node& node, TomlDocument& doc, const std::string& key, std::string& out) {
            return read_name(node, doc, key, allowed, later, out);
          },
          [](const std::string& x) { return Json(x); }};
}

// The list for people is that of now; a policy that a program registers later is allowed all the same.
// So `allowed` is asked at each reading and not once.
Codec<std::string> open_choice(std::function<std::vector<std::string>()> allowed) {
  return {listed(allowed()),
          [=](const toml::node& node, TomlDocument& doc, const std::string& key, std::string& out) {
            return read_name(node, doc, key, allowed(), {}, out);
          },
          [](const std::string& x) { return Json(x); }};
}

// Only that it is a text or a number: whether it is a formula is told where it is built, with the
// variables that it may have (build_forces.cpp).
Codec<std::string> formula_text() {
  return {"a formula in a string, or a number",
          [](const toml::node& node, TomlDocument& doc, const std::string& key, std::string& out) {
            if (node.is_string()) return out = node.as_string()->get(), true;  // Formula looks for NULs
            double value = 0.0;
            if (!node.is_number())
              return wrong_type(node, doc, key, "a formula in a string, or a number"), false;
            if (!read_number(node, doc, key, any(), value)) return false;
            // The shortest text of the number, which the formula's parser reads back as the same
            // double.
            out = number_text(value);
            return true;
          },
          [](const std::string& x) { return Json(x); }};
}

Codec<Vec2> point(std::string unit) { return point(any(std::move(unit))); }

Codec<Vec2> point(Range range) {
  return {"[x, y]" + (range.unit.empty() ? "" : " in " + range.unit),
          [range](const toml::node& node, TomlDocument& doc, const std::string& key, Vec2& out) {
            return read_point(node, doc, key, range, out);
          },
          point_json};
}

// least == most asks for so many and no others: then a wrong number is a wrong type. Else too many are
// told apart, as the list is what it should be, but long.
Codec<std::vector<Vec2>> points(std::size_t least, std::size_t most, std::string unit) {
  const Range range = any(std::move(unit));
  std::string type = least == most ? std::to_string(least) : std::to_string(least) + " or more";
  type += " points [[x, y], ...] in " + range.unit;
  return {type,
          [=](const toml::node& node, TomlDocument& doc, const std::string& key, std::vector<Vec2>& out) {
            const toml::array* array = node.as_array();
            if (array == nullptr || array->size() < least || (array->size() > most && least == most))
              return wrong_type(node, doc, key, type), false;
            if (array->size() > most) {
              doc.faults().add(doc.where(node), fault_text(key, "too many points", given(node),
                                                           "at most " + std::to_string(most) + " points"));
              return false;
            }
            // Every element is read, whatever those before it are: all faults are told.
            bool good = true;
            for (const toml::node& element : *array) {
              out.emplace_back(Vec2::Zero());
              good = read_point(element, doc, key, range, out.back()) && good;
            }
            return good;
          },
          [](const std::vector<Vec2>& x) {
            Json json = Json::array();
            for (const Vec2& p : x) json.push_back(point_json(p));
            return json;
          }};
}

Codec<std::vector<std::string>> names(std::vector<std::string> allowed) {
  const std::string type = "strings" + (allowed.empty() ? "" : " of " + listed(allowed));
  return {type,
          [allowed = std::move(allowed), type](const toml::node& node, TomlDocument& doc,
                                               const std::string& key, std::vector<std::string>& out) {
            // `touching = "floor"` in place of `["floor"]`.
            if (node.is_string()) return read_name(node, doc, key, allowed, {}, out.emplace_back());
            const toml::array* array = node.as_array();
            if (array == nullptr) return wrong_type(node, doc, key, "an array of " + type), false;
            bool good = true;
            for (const toml::node& element : *array)
              good = read_name(element, doc, key, allowed, {}, out.emplace_back()) && good;
            return good;
          },
          [](const std::vector<std::string>& x) { return Json(x); }};
}

}  // namespace brink
