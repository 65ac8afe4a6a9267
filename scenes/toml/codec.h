#pragma once
/// Codecs: how one kind of value is read from TOML, checked, and written as JSON. Internal to the scene
/// reader.

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "brink/core/base/geometry.h"
#include "brink/scenes/toml/document.h"

namespace brink {

using Json = nlohmann::ordered_json;

/// Numbers of a scene stay within these, so that squares and products of what is given stay finite.
inline constexpr double kLargest = 1e15;

/// The starting value of a V that is read: Eigen leaves Vec2{} without a value.
template <class V>
V blank() {
  if constexpr (std::is_same_v<V, Vec2>)
    return Vec2::Zero();
  else
    return V{};
}

/// Reads a value; on a fault tells the document, naming `key`, and returns false.
template <class V>
struct Codec {
  std::string type;  ///< for people: what is allowed
  std::function<bool(const toml::node&, TomlDocument&, const std::string& key, V&)> read;
  std::function<Json(const V&)> write;
};

/// Which numbers are allowed. Always finite.
struct Range {
  double low = -kLargest, high = kLargest;
  bool open_low = false;  ///< low itself is not allowed
  std::string unit;
  std::string text() const;
  bool holds(double x) const { return (open_low ? x > low : x >= low) && x <= high; }
};
Range any(std::string unit = "");
Range positive(std::string unit = "", double low = 0.0);
Range not_negative(std::string unit = "");
Range between(double low, double high, std::string unit = "");

Codec<double> number(Range range = {});
Codec<std::int64_t> integer(std::int64_t low, std::int64_t high);
/// Two integers, called [first, second] in messages.
Codec<std::array<std::int64_t, 2>> two_integers(std::int64_t low, std::int64_t high,
                                                const std::string& names);
Codec<bool> flag();
Codec<std::string> text(std::string type = "string");
/// One of `allowed`; those of `later` are known to the format but not available yet, and the fault says so.
Codec<std::string> choice(std::vector<std::string> allowed, std::vector<std::string> later = {});
/// One of what `allowed()` gives when the file is read.
Codec<std::string> open_choice(std::function<std::vector<std::string>()> allowed);
/// A formula: a string, or a number meaning itself.
Codec<std::string> formula_text();
Codec<Vec2> point(std::string unit = "m");
/// The same, both numbers within the range.
Codec<Vec2> point(Range range);
Codec<std::vector<Vec2>> points(std::size_t least, std::size_t most = 1'000'000, std::string unit = "m");
/// Strings; one string alone stands for a list of one.
Codec<std::vector<std::string>> names(std::vector<std::string> allowed = {});

/// "`key`: what is wrong; given ..., allowed: ...".
std::string fault_text(const std::string& key, const std::string& wrong, const std::string& what_was_given,
                       const std::string& allowed);

}  // namespace brink
