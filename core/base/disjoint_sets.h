#pragma once
/// Disjoint sets that only ever grow together.

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

namespace brink {

/// Of bodies, say, that are joined directly or through others. Each set knows its members. Uniting costs the
/// size of the smaller set.
class DisjointSets {
 public:
  /// Everyone of 0 .. n - 1 by itself.
  void reset(int n) {
    set_of_.resize(n);
    std::iota(set_of_.begin(), set_of_.end(), 0);
    members_.resize(n);
    for (int k = 0; k < n; ++k) members_[k].assign(1, k);
  }
  void unite(int a, int b) {
    int to = set_of_[a], from = set_of_[b];
    if (to == from) return;
    if (members_[to].size() < members_[from].size()) std::swap(to, from);
    for (const int k : members_[from]) set_of_[k] = to;
    members_[to].insert(members_[to].end(), members_[from].begin(), members_[from].end());
    members_[from].clear();
  }
  /// Everyone in the set that holds k, in no particular order.
  std::span<const int> of(int k) const { return members_[set_of_[k]]; }

 private:
  std::vector<int> set_of_;
  std::vector<std::vector<int>> members_;
};

}  // namespace brink
