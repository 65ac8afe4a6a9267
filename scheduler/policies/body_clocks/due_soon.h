#pragma once
/// Who of a queue is due soon: told in lots, a little before their time.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "brink/scheduler/events/event_queue.h"

namespace brink {

/// Goes along a queue, ahead of it. Whoever is put into the queue behind it is not told: what is told is a guess in any
/// case. How far it goes is chosen so that a lot is some dozens; where little of it is of use, it rests.
class DueSoon {
 public:
  explicit DueSoon(std::size_t lot = 32) : lot_(lot) {}

  /// Until when all have been told, but for those who have come since [s].
  double end() const { return told_; }
  /// True when half of the last lot is over.
  bool is_time(double now) const { return now >= next_; }
  /// Calls tell(entry) for the next lot, the first due first. It says whether that was of use.
  template <class Tell>
  void look(const EventQueue& queue, Tell&& tell) {
    const double now = queue.time(), from = std::max(told_, now);
    told_ = from + span_;
    lot_of_.clear();
    queue.visit_until(told_, [&](const EventQueue::Entry& e) {
      if (e.time >= from && lot_of_.size() < 8 * lot_) lot_of_.push_back(e);
    });
    std::sort(lot_of_.begin(), lot_of_.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
    std::size_t used = 0;
    for (const EventQueue::Entry& e : lot_of_) used += tell(e) ? 1 : 0;
    next_ = told_ - 0.5 * span_;
    if (used * kOfUse < lot_of_.size()) {
      next_ = told_ + kRest * span_;
      told_ = 0.0;
    }
    choose_span(now);
  }

 private:
  static constexpr std::size_t kOfUse = 4;  ///< one in so many at least
  static constexpr double kRest = 64.0;     ///< lots

  /// Of the next lot; where the last was too small it is larger, where too large smaller.
  void choose_span(double now) {
    const double wanted = static_cast<double>(lot_), had = static_cast<double>(lot_of_.size());
    span_ *= std::clamp(wanted / (had + 1.0), 0.25, 4.0);
    span_ = std::clamp(span_, 1e-14 * (1.0 + now), 1e3);
  }

  std::size_t lot_;
  double span_ = 1e-9;  ///< [s]
  double told_ = 0.0;   ///< until then [s]
  double next_ = 0.0;   ///< when to look again [s]
  std::vector<EventQueue::Entry> lot_of_;
};

}  // namespace brink
