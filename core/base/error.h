#pragma once
/// The caller's mistake: thrown by the library with the parameter, the value given and what is allowed.

#include <stdexcept>
#include <string>

namespace brink {

class BadInput : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// A file could not be read or written, or a device (GL context, database) refused to open.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace brink
