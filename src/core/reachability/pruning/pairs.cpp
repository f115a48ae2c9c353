#include "reachability/pruning/pairs.hpp"

#include <algorithm>
#include <utility>

namespace tachk::reachability::pruning {

using program::Location;
using zones::Atom;
using zones::Raw;

Intervals::Intervals(std::uint16_t clock, std::vector<std::int64_t> constants)
    : clock_(clock), constants_(std::move(constants)) {
  constants_.push_back(0);
  std::erase_if(constants_, [](std::int64_t constant) { return constant < 0; });
  std::sort(constants_.begin(), constants_.end());
  constants_.erase(std::unique(constants_.begin(), constants_.end()), constants_.end());
}

std::size_t Intervals::of(std::int64_t value) const {
  if (clock_ == 0) return 0;
  const auto above = std::upper_bound(constants_.begin(), constants_.end(), value);
  const auto last = static_cast<std::size_t>(above - constants_.begin()) - 1;
  return constants_[last] == value ? 2 * last : 2 * last + 1;
}

bool Intervals::satisfies(std::size_t interval, const std::vector<Atom>& atoms) const {
  if (clock_ == 0) return true;
  const std::int64_t low = constants_[interval / 2];
  const bool is_point = interval % 2 == 0;
  return std::all_of(atoms.begin(), atoms.end(), [&](const Atom& atom) {
    const bool strict = (atom.raw & 1) == 0;
    const Raw bound = zones::raw_value(atom.raw);
    if (atom.left == clock_ && atom.right == 0) return low < bound || (is_point && !strict && low == bound);
    if (atom.left == 0 && atom.right == clock_) return low > -bound || (low == -bound && (!is_point || !strict));
    return true;
  });
}

std::vector<Atom> Intervals::atoms(std::size_t first, std::size_t last) const {
  std::vector<Atom> atoms;
  if (clock_ == 0) return atoms;
  if (first > 0) atoms.push_back({0, clock_, zones::raw_bound(-constants_[first / 2], first % 2 != 0)});
  if (last + 1 < size()) {
    const bool is_point = last % 2 == 0;
    atoms.push_back({clock_, 0, zones::raw_bound(constants_[last / 2 + (is_point ? 0 : 1)], !is_point)});
  }
  return atoms;
}

namespace {

// The pairs that a step leads to from an interval in which it is possible: calls visit(interval).
template <class Visit>
void for_each_entered(const View& view, const EdgeWithEffects& step, std::size_t interval, Visit&& visit) {
  const std::uint16_t clock = view.intervals.clock();
  const Location& target = view.locations()[static_cast<std::size_t>(step.edge->target)];
  const auto enter = [&](std::size_t entered) {
    if (view.intervals.satisfies(entered, target.invariant.atoms)) visit(entered);
  };
  const auto& clocks = step.effects->clocks;
  const auto last =
      clock == 0 ? clocks.rend()
                 : std::find_if(clocks.rbegin(), clocks.rend(), [&](const auto& each) { return each.clock == clock; });
  if (last == clocks.rend()) return enter(interval);
  if (last->value) return enter(view.intervals.of(*last->value));
  for (std::size_t any = 0; any < view.intervals.size(); ++any) enter(any);
}

bool is_possible(const View& view, const EdgeWithEffects& step, std::size_t interval) {
  const Location& source = view.locations()[static_cast<std::size_t>(step.edge->source)];
  return view.intervals.satisfies(interval, step.edge->guard.atoms) &&
         view.intervals.satisfies(interval, source.invariant.atoms);
}

// True if time may pass in a location up to an interval.
bool may_wait(const View& view, std::size_t location, std::size_t interval) {
  const Location& place = view.locations()[location];
  return !place.urgent && !place.committed && view.intervals.satisfies(interval, place.invariant.atoms);
}

}  // namespace

PairSet backward(const View& view, PairSet pairs) {
  const std::size_t intervals = view.intervals.size();
  std::vector<std::size_t> open;  // locations of which there are more pairs than have been looked at
  std::vector<bool> is_open(view.locations().size(), true);
  for (std::size_t location = 0; location < view.locations().size(); ++location) open.push_back(location);
  while (!open.empty()) {
    const std::size_t location = open.back();
    open.pop_back();
    is_open[location] = false;
    for (std::size_t interval = intervals - 1; interval > 0; --interval)
      if (pairs[view.number(location, interval)] && may_wait(view, location, interval))
        pairs[view.number(location, interval - 1)] = true;
    for (const EdgeWithEffects& step : view.steps->to[location])
      for (std::size_t interval = 0; interval < intervals; ++interval) {
        const auto before = static_cast<std::size_t>(step.edge->source);
        const std::size_t source = view.number(before, interval);
        if (pairs[source] || !is_possible(view, step, interval)) continue;
        for_each_entered(view, step, interval, [&](std::size_t entered) {
          if (pairs[view.number(location, entered)]) pairs[source] = true;
        });
        if (!pairs[source] || is_open[before]) continue;
        is_open[before] = true;
        open.push_back(before);
      }
  }
  return pairs;
}

bool may_leave(const View& view, const PairSet& pairs) {
  const std::size_t intervals = view.intervals.size();
  std::int64_t start = 0;
  for (const zones::ClockReset& each : view.program->starts)
    if (each.clock == view.intervals.clock()) start = each.value;
  PairSet seen(pairs.size(), false);
  std::vector<std::pair<std::size_t, std::size_t>> open;
  const auto reach = [&](std::size_t location, std::size_t interval) {
    if (seen[view.number(location, interval)]) return;
    seen[view.number(location, interval)] = true;
    open.emplace_back(location, interval);
  };
  reach(static_cast<std::size_t>(view.program->slots[view.process].initial), view.intervals.of(start));
  while (!open.empty()) {
    const auto [location, interval] = open.back();
    open.pop_back();
    if (!pairs[view.number(location, interval)]) return true;
    if (interval + 1 < intervals && may_wait(view, location, interval + 1)) reach(location, interval + 1);
    for (const EdgeWithEffects& step : view.steps->from[location])
      if (is_possible(view, step, interval))
        for_each_entered(view, step, interval,
                         [&](std::size_t entered) { reach(static_cast<std::size_t>(step.edge->target), entered); });
  }
  return false;
}

}  // namespace tachk::reachability::pruning
