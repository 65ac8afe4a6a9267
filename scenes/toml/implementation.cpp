// toml++ is compiled once, here; every other file sees declarations only (TOML_HEADER_ONLY=0).
//
// Of some texts that are no TOML it asserts what does not hold; in release builds it tells the compiler to assume
// it, which is undefined behaviour. Such a text is a fault like any other: the assertion throws, and
// TomlDocument says where.
#include "brink/scenes/toml/not_toml.h"

#if defined(__clang__)
#pragma clang diagnostic ignored "-Wexceptions"  // some assertions stand in functions that may not throw
#elif defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wterminate"
#endif
#undef NDEBUG
#define TOML_ASSERT(condition)        \
  ((condition) ? static_cast<void>(0) \
               : throw brink::NotToml("expected a key of letters, digits, - and _, or one in quotes"))
#define TOML_IMPLEMENTATION
#include <toml++/toml.h>
