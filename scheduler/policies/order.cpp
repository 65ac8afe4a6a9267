#include "brink/scheduler/policies/order.h"

#include <algorithm>
#include <cmath>

#include "brink/scheduler/first_contact/canonical_time.h"

namespace brink {

namespace {

/// By the option `order`; ties go by index, and so does an order that takes contacts together, which only
/// needs one of them to begin with.
std::size_t first_by(Kernel& kernel, const std::vector<Certificate>& group) {
  const Order order = kernel.order();
  const auto least = [&](auto key) {
    return static_cast<std::size_t>(
        std::min_element(group.begin(), group.end(),
                         [&](const Certificate& a, const Certificate& b) { return key(a) < key(b); }) -
        group.begin());
  };
  // Without the time: within one instant times differ by roundings alone, and must not decide.
  const auto by_index = [](const Certificate& c) {
    return std::tuple(c.kind, c.pair.order(), c.contact.site, c.contact.sample);
  };
  if (order == Order::closing_speed)
    return least([&](const auto& c) { return std::tuple(-c.contact.closing_speed, by_index(c)); });
  if (order == Order::depth)
    return least([&](const auto& c) { return std::tuple(c.contact.gap, by_index(c)); });
  if (order == Order::random) return kernel.draw(group.size());
  return least(by_index);
}

/// A step of an island as the next event: of the island whose step ends first.
Certificate end_of_step(const KernelView& kernel, double time) {
  Certificate c;
  c.kind = Certificate::Kind::island;
  c.time = time;
  c.pair.body = kernel.next_island();
  return c;
}

}  // namespace

std::size_t first_by_order(Kernel& kernel, const std::vector<Certificate>& group) {
  // Nothing is drawn where there is no choice: the policies have the same numbers only if they draw as
  // often.
  return group.size() == 1 ? 0 : first_by(kernel, group);
}

Certificate at_its_time(const KernelView& kernel, Certificate c, double earliest) {
  if (kernel.points_meet_wires()) c.time = c.contact.time = earliest;
  return c;
}

std::optional<Certificate> take_earliest(Kernel& kernel, Agenda& agenda, double last) {
  std::vector<Certificate> group;
  const double step = kernel.next_step();
  // A contact at the very end of a step comes before the step; one that comes after it waits. With a
  // contact in hand its instant is completed, whatever ends in it.
  const auto latest = [&] {
    return group.empty() ? std::min(step, last) : group.front().time + same_instant(group.front().time);
  };
  while (!agenda.empty() && agenda.earliest().time <= latest()) {
    const Certificate c = agenda.pop();
    if (kernel.fresh(c))
      group.push_back(c);
    else
      kernel.note_stale();
  }
  kernel.note_queue_operations(agenda.take_operations());
  if (group.empty() && std::isfinite(step) && step <= last) return end_of_step(kernel, step);
  if (group.empty()) return std::nullopt;
  // a search that stopped is gone on with first: the instant may have more contacts, and only of all is one chosen, or drawn
  const auto open = std::find_if(group.begin(), group.end(),
                                 [](const Certificate& c) { return c.kind == Certificate::Kind::undecided; });
  const std::size_t chosen =
      open != group.end() ? static_cast<std::size_t>(open - group.begin()) : first_by_order(kernel, group);
  const Certificate first = at_its_time(kernel, group[chosen], group.front().time);
  // The others wait: the response may make them stale, or leave them as they are.
  for (std::size_t i = 0; i < group.size(); ++i)
    if (i != chosen) agenda.insert(group[i]);
  return first;
}

}  // namespace brink
