#pragma once
/// Vectors of what every body has: their memory is asked for in large pages where the system gives them, and
/// fetched before it is needed.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace brink {

/// As std::allocator, aligned to cache lines. Blocks of some megabytes ask for large pages: at 1e5 bodies
/// which are met in no order, finding the page costs as much as the memory behind it.
template <class T>
struct LargeAllocator {
  using value_type = T;
  static constexpr std::size_t kLine = 64;         ///< bytes
  static constexpr std::size_t kLarge = 4u << 20;  ///< bytes; below, pages of the usual size do
  static constexpr std::size_t kPage = 4096;

  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) {}  // NOLINT: as every allocator

  T* allocate(std::size_t n) {
    const std::size_t bytes = n * sizeof(T);
    void* const block = ::operator new (bytes, std::align_val_t{kLine});
#ifdef __linux__
    if (bytes >= kLarge) {
      const auto first = (reinterpret_cast<std::uintptr_t>(block) + kPage - 1) / kPage * kPage;
      const auto last = (reinterpret_cast<std::uintptr_t>(block) + bytes) / kPage * kPage;
      madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);  // a wish; refused is no fault
    }
#endif
    return static_cast<T*>(block);
  }
  void deallocate(T* block, std::size_t) { ::operator delete (block, std::align_val_t{kLine}); }
  bool operator==(const LargeAllocator&) const { return true; }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

/// Starts to fetch a cache line; returns at once.
inline void prefetch_line(const void* line) {
  __builtin_prefetch(line);
  // To GCC a function that fetches and does nothing else does nothing: it would leave out the calls of it.
  asm volatile("" : : "r"(line));
}
/// Starts to fetch all cache lines of *what; returns at once.
template <class T>
inline void prefetch(const T* what) {
  for (std::size_t byte = 0; byte < sizeof(T); byte += 64)
    prefetch_line(reinterpret_cast<const char*>(what) + byte);
}

}  // namespace brink
