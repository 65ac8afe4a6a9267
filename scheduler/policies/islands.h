#pragma once
/// Bodies that could meet one another before a horizon, directly or through others.

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

namespace brink {

/// Disjoint sets of bodies that only ever grow together; each knows its members. Uniting costs the size of
/// the smaller set.
class Islands {
 public:
  /// Every body of 0 .. n - 1 by itself.
  void reset(int n) {
    island_of_.resize(n);
    std::iota(island_of_.begin(), island_of_.end(), 0);
    members_.resize(n);
    for (int k = 0; k < n; ++k) members_[k].assign(1, k);
  }
  void unite(int a, int b) {
    int to = island_of_[a], from = island_of_[b];
    if (to == from) return;
    if (members_[to].size() < members_[from].size()) std::swap(to, from);
    for (const int k : members_[from]) island_of_[k] = to;
    members_[to].insert(members_[to].end(), members_[from].begin(), members_[from].end());
    members_[from].clear();
  }
  /// All bodies of the island that holds `body`, in no particular order.
  std::span<const int> of(int body) const { return members_[island_of_[body]]; }

 private:
  std::vector<int> island_of_;
  std::vector<std::vector<int>> members_;
};

}  // namespace brink
