#include "brink/scheduler/kernel/endings.h"

#include <algorithm>
#include <cmath>

#include "brink/scheduler/first_contact/canonical_time.h"

namespace brink {

namespace {

/// In an instant of so many the next are taken together, however many bodies there are: it takes seconds.
constexpr std::uint64_t kLongestInstant = 200000;
/// So many collisions in an instant are nothing unusual.
constexpr std::uint64_t kPlainInstant = 2000;
/// Of bodies that collide again within this part of the time that it is, so many collisions in a row come to no end.
constexpr double kHardlyLater = 1e-11;
constexpr std::uint64_t kMostCrawling = 20000;

}  // namespace

std::uint64_t Endings::endless() const {
  const std::uint64_t bodies = bodies_.count() + 2;  // a row may have ends yet to be reached
  // twenty times the n^2 / 2 of a row
  return kPlainInstant + std::min(10 * bodies * bodies, kLongestInstant);
}

bool Endings::is_crawling() const { return crawling_ > kMostCrawling; }

/// From the collision on with which the instant has passed its bound, until the clock leaves it; where instants follow each other
/// without end, until one comes later.
bool Endings::collapsed(double now) const {
  const double since = now - instant_;
  return (in_instant_ > endless() && since <= 2.0 * same_instant(now)) ||
         (is_crawling() && since <= kHardlyLater * std::abs(now));
}

/// As collided() has it, before that counts.
bool Endings::is_plain(double now) const {
  if (is_crawling()) return false;
  return in_instant_ < kPlainInstant || now - instant_ > 2.0 * same_instant(now);
}

/// An instant is counted from its first collision. Twice the length of one instant: times on either side of it may
/// differ by as much.
void Endings::count_in_instant(const PairKey& pair, double now) {
  if (now - instant_ > 2.0 * same_instant(now)) {
    instant_ = now;
    in_instant_ = 0;
    bodies_.clear();
  }
  ++in_instant_;
  bodies_.add(pair);
}

/// Instants that follow each other as closely as the clock can tell, and never stop: neither is a series of bounces
/// that has a limit, nor are they of one instant.
bool Endings::crawls(const Outcome& o, double now) {
  if (o.since_last > kHardlyLater * std::abs(now)) crawling_ = 0;
  return crawls_on(o.since_last > 2.0 * same_instant(now));
}

bool Endings::crawls_on(bool once_more) {
  crawling_ += once_more;
  return crawling_ > 2 * kMostCrawling;
}

/// The series of bounces first: what comes to its limit is taken over by an island, or ends the run. But where one crawls that
/// comes to a limit over and over, islands do not pass it.
std::optional<Ending> Endings::collided(const Outcome& o, double now, BounceLoss loss, double rounding) {
  const auto begins_together = [this, crawled = is_crawling()] { return !crawled && is_crawling(); };
  bool is_endless = crawls(o, now);
  // a bounce that ends its series is not counted: what comes of it is no collision of this instant
  if (!o.contact.seen && !is_endless)
    if (const auto zeno = zeno_.collided({o.pair, o.contact}, now, o.contact.closing_speed, loss,
                                         o.since_last, o.contact.sink < 0.0, o.limit, rounding)) {
      is_endless = crawls_on(o.since_last <= kHardlyLater * std::abs(now));
      if (!is_endless && !begins_together())
        return Ending{Ending::Kind::zeno, zeno->limit_time, zeno->bounces};
    }
  count_in_instant(o.pair, now);
  if (is_endless) return Ending{Ending::Kind::endless_group, now, crawling_};
  // likewise, of instants that hardly follow each other
  if (begins_together()) return Ending{Ending::Kind::group, now, crawling_};
  if (in_instant_ <= kPlainInstant) return std::nullopt;
  // as many again may be taken together
  if (in_instant_ > 2 * endless()) return Ending{Ending::Kind::endless_group, now, in_instant_};
  // told once, where the bound is passed: the count grows by one at a time
  if (in_instant_ == endless() + 1) return Ending{Ending::Kind::group, now, in_instant_};
  return std::nullopt;
}

void Endings::restore(Saved saved) {
  instant_ = saved.instant;
  in_instant_ = saved.in_instant;
  crawling_ = saved.crawling;
  bodies_.restore(saved.bodies, saved.often);
  zeno_.restore(std::move(saved.bounces));
}

}  // namespace brink
