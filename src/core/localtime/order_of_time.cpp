#include "localtime/order_of_time.hpp"

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace tachk::localtime {

using program::Condition;
using symbolic::Path;
using symbolic::Semantics;
using zones::Raw;
using zones::raw_zero;

namespace {

// A time, and how many times something arbitrarily small is added to it.
struct Instant {
  Raw value = 0;
  std::int64_t margin = 0;

  auto operator<=>(const Instant&) const = default;
};

Instant after(Instant instant, Raw raw) {
  return {instant.value + zones::raw_value(raw), instant.margin - (1 - (raw & 1))};
}

// time[later] - time[earlier] < or <= c.
struct Difference {
  std::size_t later;
  std::size_t earlier;
  Raw raw;
};

class Timing {
 public:
  Timing(Semantics& semantics, const Agents& agents)
      : semantics_(semantics),
        program_(semantics.program()),
        agents_(agents),
        last_(agents.count, 0),
        resets_(static_cast<std::size_t>(program_.dimension()), Reset{0, 0}) {
    for (const program::Slot& slot : program_.slots) slots_.push_back(slot.initial);
    for (const zones::ClockReset& start : program_.starts) resets_[start.clock].value = start.value;
  }

  void take(const symbolic::Edges& edges) {
    const std::size_t now = ++moment_;
    for (const std::uint32_t edge : edges) {
      for (const std::uint32_t agent : agents_.of_edge[edge]) differences_.push_back({last_[agent], now, raw_zero});
      leave(program_.edges[edge].process, now);
      atoms_.clear();
      semantics_.resolve(program_.edges[edge].guard, slots_.data(), atoms_);
      require(now);
    }
    semantics_.apply(edges, slots_.data(), effect_);
    std::copy_n(effect_.slots.begin(), slots_.size(), slots_.begin());
    for (const zones::ClockReset& reset : effect_.resets) resets_[reset.clock] = {now, reset.value};
    for (const std::uint32_t edge : edges) {
      for (const std::uint32_t agent : agents_.of_edge[edge]) last_[agent] = now;
      invariant(program_.edges[edge].process, now);
    }
  }

  // All processes are where they are at the end, and the condition holds there.
  void end(const Condition& condition) {
    const std::size_t now = ++moment_;
    for (const std::size_t last : last_) differences_.push_back({last, now, raw_zero});
    for (std::size_t process = 0; process < program_.processes.size(); ++process) leave(process, now);
    atoms_.clear();
    semantics_.resolve(condition, slots_.data(), atoms_);
    require(now);
  }

  bool holds(const Condition& condition) { return semantics_.holds(condition, slots_.data()); }

  // The numbers of the actions, from 0, in the order of a solution.
  std::optional<std::vector<std::size_t>> order() const {
    std::vector<Instant> times(moment_ + 1);
    for (std::size_t round = 0; relax(times); ++round)
      if (round > times.size()) return std::nullopt;
    std::vector<std::size_t> order(moment_ - 1);  // without the beginning and the end
    std::iota(order.begin(), order.end(), std::size_t{1});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
    for (std::size_t& number : order) --number;
    return order;
  }

 private:
  struct Reset {
    std::size_t moment;
    std::int32_t value;
  };

  bool relax(std::vector<Instant>& times) const {
    bool changed = false;
    for (const auto [later, earlier, raw] : differences_) {
      const Instant most = after(times[earlier], raw);
      if (times[later] <= most) continue;
      times[later] = most;
      changed = true;
    }
    return changed;
  }

  // The constraints `atoms_` on the clocks at a moment.
  void require(std::size_t now) {
    for (const zones::Atom& atom : atoms_) {
      if (atom.left == atom.right) {
        if (atom.raw < raw_zero) differences_.push_back({now, now, atom.raw});
        continue;
      }
      const Reset left = atom.left == 0 ? Reset{now, 0} : resets_[atom.left];
      const Reset right = atom.right == 0 ? Reset{now, 0} : resets_[atom.right];
      differences_.push_back({right.moment, left.moment, atom.raw - 2 * (Raw{left.value} - Raw{right.value})});
    }
  }

  void invariant(std::size_t process, std::size_t now) {
    atoms_.clear();
    semantics_.resolve(semantics_.location(process, slots_.data()).invariant, slots_.data(), atoms_);
    require(now);
  }

  // A process has stayed where it is until now.
  void leave(std::size_t process, std::size_t now) {
    invariant(process, now);
    if (semantics_.location(process, slots_.data()).urgent) differences_.push_back({now, last_[process], raw_zero});
  }

  Semantics& semantics_;
  const program::Program& program_;
  const Agents& agents_;
  std::vector<std::int32_t> slots_;
  std::vector<std::size_t> last_;  // of each agent, the moment of its last action; the beginning is moment 0
  std::vector<Reset> resets_;      // of each clock, the last one
  std::size_t moment_ = 0;
  std::vector<Difference> differences_;
  std::vector<zones::Atom> atoms_;
  symbolic::Effect effect_;
};

}  // namespace

std::optional<Path> in_order_of_time(Semantics& semantics, const Agents& agents, const Path& actions,
                                     const Condition& end) {
  Timing timing(semantics, agents);
  for (const symbolic::Edges& edges : actions) timing.take(edges);
  if (!timing.holds(end)) return std::nullopt;
  timing.end(end);
  const auto order = timing.order();
  if (!order) return std::nullopt;
  Path ordered;
  for (const std::size_t number : *order) ordered.push_back(actions[number]);
  return ordered;
}

}  // namespace tachk::localtime
