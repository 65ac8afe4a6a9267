#pragma once
/// Contacts that were found and wait for their turn.

#include <utility>
#include <vector>

#include "brink/scheduler/events/agenda.h"

namespace brink {

/// At most one contact for each body. Nearly every contact is met as soon as it is found: the last one found
/// lies apart, and only what must wait takes room, which is used again.
class FoundContacts {
 public:
  explicit FoundContacts(std::size_t bodies) : place_(bodies, kNowhere) {}

  void set(int body, const Certificate& c) {
    if (last_of_ != body) put_aside();
    last_ = c;
    last_of_ = body;
  }
  /// @pre set for that body since it was forgotten.
  const Certificate& of(int body) const { return body == last_of_ ? last_ : waiting_[place_[body]]; }
  void forget(int body) {
    if (body == last_of_) last_of_ = kNowhere;
    if (const int place = std::exchange(place_[body], kNowhere); place != kNowhere) free_.push_back(place);
  }

 private:
  static constexpr int kNowhere = -1;

  /// The last contact makes way for another.
  void put_aside() {
    if (last_of_ == kNowhere) return;
    int& place = place_[last_of_];
    if (place == kNowhere && free_.empty()) {
      place = static_cast<int>(waiting_.size());
      waiting_.emplace_back();
    } else if (place == kNowhere) {
      place = free_.back();
      free_.pop_back();
    }
    waiting_[place] = last_;
  }

  Certificate last_;
  int last_of_ = kNowhere;
  std::vector<Certificate> waiting_;
  std::vector<int> free_;   ///< places in waiting_
  std::vector<int> place_;  ///< of each body's
};

}  // namespace brink
