#pragma once
/// Arrays of numbers for a page: small, and without network. Each array's bytes are sorted by significance, all is
/// deflated (zlib) and written in base64.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace brink {

class PageNumbers {
 public:
  void add(const std::string& name, std::span<const double> values) { take(name, "f64", values); }
  void add(const std::string& name, std::span<const std::int32_t> values) { take(name, "i32", values); }

  /// [name, kind, count] of each, in order.
  const nlohmann::ordered_json& arrays() const { return arrays_; }
  /// `quick`: less small, for what is soon asked for again. @throws IoError where memory does not suffice.
  std::string text(bool quick = false) const;

 private:
  template <class T>
  void take(const std::string& name, const char* kind, std::span<const T> values);

  nlohmann::ordered_json arrays_ = nlohmann::ordered_json::array();
  std::vector<unsigned char> bytes_;
};

}  // namespace brink
