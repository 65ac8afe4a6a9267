#include "brink/scheduler/policies/policy.h"

#include <fmt/core.h>

#include <deque>
#include <mutex>

#include "brink/core/base/error.h"

namespace brink {

namespace {

struct Entry {
  std::string name, summary;
  PolicyMaker make;
  bool added = false;
};

/// Every policy, Brink's own first. Entries stay where they are and are never taken out.
class Registry {
 public:
  static Registry& get() {
    static Registry registry;
    return registry;
  }

  /// Checked and added under one lock, so that of two threads with one name the second fails.
  void add(Entry entry) {
    const std::lock_guard lock(mutex_);
    if (entry.name.empty()) throw BadInput("register_policy: a policy needs a name");
    if (!entry.make) throw BadInput(fmt::format("register_policy: \"{}\" has no maker", entry.name));
    if (find(entry.name)) throw BadInput(fmt::format("register_policy: \"{}\" is taken", entry.name));
    entries_.push_back(std::move(entry));
  }

  /// Empty if there is none of that name.
  PolicyMaker maker(std::string_view name) {
    const std::lock_guard lock(mutex_);
    const Entry* entry = find(name);
    // A copy, to be called without the lock: a maker may ask for policies itself.
    return entry ? entry->make : PolicyMaker();
  }

  bool is_added(std::string_view name) {
    const std::lock_guard lock(mutex_);
    const Entry* entry = find(name);
    return entry && entry->added;
  }

  std::vector<Choice> choices() {
    const std::lock_guard lock(mutex_);
    std::vector<Choice> all;
    for (const Entry& e : entries_) all.push_back({e.name, e.summary});
    return all;
  }

 private:
  /// @pre the lock is held.
  const Entry* find(std::string_view name) const {
    for (const Entry& e : entries_)
      if (e.name == name) return &e;
    return nullptr;
  }

  std::mutex mutex_;
  // A deque: the names and summaries that choices() gives out stay where they are as others are added.
  std::deque<Entry> entries_{
      {"body_clocks",
       "every body keeps its own time; a collision advances two (Lubachevsky 1991; Mirtich & Canny 1995)",
       make_body_clocks},
      {"global_backup",
       "all advance together to a horizon, all back up to the earliest contact (Baraff 1997)",
       make_global_backup},
      {"island_backup", "the same inside each group of bodies that could meet before the horizon",
       make_island_backup},
      {"timewarp",
       "bodies run ahead of what is certain; a late contact rolls back only what it touched (Mirtich 2000)",
       make_timewarp},
      {"fixed_step", "no backing up: step, push overlaps apart, resolve; approximate (the naive baseline)",
       make_fixed_step},
  };
};

}  // namespace

std::vector<Choice> policies() { return Registry::get().choices(); }

std::vector<std::string> exact_policies() {
  std::vector<std::string> names;
  for (const Choice& c : policies())
    // only a policy itself can say
    if (!make_policy(c.name)->approximate()) names.emplace_back(c.name);
  return names;
}

void register_policy(const std::string& name, const std::string& summary, PolicyMaker make) {
  Registry::get().add({name, summary, std::move(make), true});
}

bool is_added_policy(std::string_view name) { return Registry::get().is_added(name); }

std::unique_ptr<Policy> make_policy(std::string_view name, std::string_view detector) {
  const PolicyMaker make = Registry::get().maker(name);
  if (!make) throw BadInput(fmt::format("policy \"{}\" is not known; see policies()", name));
  // the name was looked up all the same: one that is unknown fails with any detector
  if (detector == "depth") return name == "fixed_step" ? make_classic_fixed_step() : make_classic_backup();
  std::unique_ptr<Policy> policy = make();
  if (!policy) throw BadInput(fmt::format("policy \"{}\": its maker made none", name));
  return policy;
}

}  // namespace brink
