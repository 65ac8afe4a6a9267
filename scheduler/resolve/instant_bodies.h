#pragma once
/// Which bodies have collided within one instant: nearly always two, in a group without end thousands of
/// times the same few.

#include <array>
#include <cstddef>
#include <set>
#include <vector>

#include "brink/scheduler/events/agenda.h"

namespace brink {

class InstantBodies {
 public:
  void clear() {
    first_count_ = 0;
    if (!more_.empty()) more_.clear();
    if (!all_.empty()) all_.clear();
  }
  void add(const PairKey& pair) {
    if (count() == 0) {  // of most instants that is all
      first_ = {pair.body, pair.other_body};
      first_count_ = pair.with_site() ? 1 : 2;
      return;
    }
    add(pair.body);
    if (!pair.with_site()) add(pair.other_body);
  }
  /// How many: exact once they have collided often.
  std::size_t count() const { return all_.empty() ? first_count_ + more_.size() : all_.size(); }
  /// As they were added, those that came first; then ascending.
  std::vector<int> list() const {
    if (!all_.empty()) return {all_.begin(), all_.end()};
    std::vector<int> list(first_.begin(), first_.begin() + first_count_);
    list.insert(list.end(), more_.begin(), more_.end());
    return list;
  }
  void restore(const std::vector<int>& list, bool often) {
    clear();
    if (often)
      all_.insert(list.begin(), list.end());
    else
      more_ = list;
  }
  bool often() const { return !all_.empty(); }

 private:
  static constexpr std::size_t kFirst = 2000;  ///< kept as they come, which costs next to nothing

  void add(int body) {
    if (all_.empty() && count() < kFirst) return more_.push_back(body);
    if (all_.empty()) {
      const std::vector<int> before = list();
      all_.insert(before.begin(), before.end());
    }
    all_.insert(body);
  }

  std::array<int, 2> first_{};  ///< of the instant's first collision
  std::ptrdiff_t first_count_ = 0;
  std::vector<int> more_;
  std::set<int> all_;
};

}  // namespace brink
