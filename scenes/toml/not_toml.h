#pragma once
/// What toml++ takes for granted of a text, and does not hold.

#include <stdexcept>

namespace brink {

/// Thrown where toml++ would assert: it parses some texts that are no TOML under an assumption that they are.
class NotToml : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace brink
