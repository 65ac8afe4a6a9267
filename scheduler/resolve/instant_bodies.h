#pragma once
/// Which bodies have collided within one instant: nearly always two, in a group without end thousands of
/// times the same few.

#include <algorithm>
#include <set>
#include <vector>

#include "brink/scheduler/events/agenda.h"

namespace brink {

class InstantBodies {
 public:
  void clear() {
    first_.clear();
    if (!all_.empty()) all_.clear();
  }
  void add(const PairKey& pair) {
    add(pair.body);
    if (!pair.with_site()) add(pair.other_body);
  }
  void add(int body) {
    if (all_.empty() && first_.size() < kFirst) return first_.push_back(body);
    if (all_.empty()) all_.insert(first_.begin(), first_.end());
    all_.insert(body);
  }
  /// How many: exact once they have collided often.
  std::size_t count() const { return all_.empty() ? first_.size() : all_.size(); }
  /// As they were added, those that came first; then ascending.
  std::vector<int> list() const { return all_.empty() ? first_ : std::vector<int>(all_.begin(), all_.end()); }
  void restore(const std::vector<int>& list, bool often) {
    first_ = list;
    all_.clear();
    if (often) all_.insert(list.begin(), list.end());
  }
  bool often() const { return !all_.empty(); }

 private:
  static constexpr std::size_t kFirst = 2000;  ///< kept as they come, which costs next to nothing
  std::vector<int> first_;
  std::set<int> all_;
};

}  // namespace brink
