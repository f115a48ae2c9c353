#include "reachability/cover_parts.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace tachk::reachability {

using zones::Raw;
using zones::raw_zero;
using zones::unbounded_entry;

namespace {

Raw sum(Raw a, Raw b) { return a == unbounded_entry || b == unbounded_entry ? unbounded_entry : a + b - ((a | b) & 1); }

}  // namespace

CoverParts::CoverParts(symbolic::ZoneGraph& graph) : graph_(graph) {}

void CoverParts::add(states::PassedList& list, std::uint32_t node, std::int64_t rank) {
  if (lists_.empty() || lists_.back() != &list) lists_.push_back(&list);
  entries_.push_back({lists_.size() - 1, node, rank});
}

std::size_t CoverParts::groups() {
  if (!first_.empty()) return first_.size();
  std::stable_sort(entries_.begin(), entries_.end(), [&](const Entry& a, const Entry& b) {
    return std::make_tuple(a.list, discrete(a)) < std::make_tuple(b.list, discrete(b));
  });
  for (std::size_t at = 0; at < entries_.size(); ++at)
    if (at == 0 || entries_[at].list != entries_[at - 1].list || discrete(entries_[at]) != discrete(entries_[at - 1]))
      first_.push_back(at);
  return first_.size();
}

CoverPart CoverParts::part(std::size_t first, std::size_t zones) {
  const std::size_t all = groups();
  symbolic::SymbolicState state = graph_.blank();
  CoverPart part;
  for (std::size_t group = first; group < all && (group == first || part.constraints.size() < zones); ++group) {
    const std::size_t end = group + 1 < all ? first_[group + 1] : entries_.size();
    states::PassedList& list = *lists_[entries_[first_[group]].list];
    list.unpack(entries_[first_[group]].node, state.slots.data());
    part.discretes.insert(part.discretes.end(), state.slots.begin(),
                          state.slots.begin() + graph_.program().state_slots);
    part.zones.push_back(static_cast<std::int64_t>(end - first_[group]));
    for (std::size_t at = first_[group]; at < end; ++at) {
      part.ranks.push_back(entries_[at].rank);
      append(list.zone(entries_[at].node, state.zone).data, part);
    }
  }
  return part;
}

// The minimal constraints of Larsen, Larsson, Pettersson and Yi 1997: clocks at fixed distances form classes; a cycle
// through each class, and between the first members of classes what does not follow through a third one.
void CoverParts::append(zones::ConstZoneRef zone, CoverPart& part) const {
  const program::Program& program = graph_.program();
  const auto n = static_cast<std::size_t>(program.dimension());
  std::vector<Raw> entries(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      entries[i * n + j] =
          graph_.operations().entry(zone, program.dimension(), static_cast<int>(i), static_cast<int>(j));
  const auto at = [&](std::size_t i, std::size_t j) { return entries[i * n + j]; };
  std::vector<std::size_t> original(n);  // of each clock its number in the program as it was given
  std::iota(original.begin(), original.end(), 0);
  for (std::size_t clock = 1; clock < program.clock_numbers.size(); ++clock)
    if (program.clock_numbers[clock] != 0) original[program.clock_numbers[clock]] = clock;
  const auto width = static_cast<std::size_t>(program.numbered_clocks()) + 1;
  std::int64_t written = 0;
  const auto add = [&](std::size_t i, std::size_t j) {
    if (i == 0 && at(i, j) == raw_zero) return;
    part.places.push_back(static_cast<std::int64_t>(original[i] * width + original[j]));
    part.bounds.push_back(2 * zones::raw_value(at(i, j)) * program.time_unit + (at(i, j) & 1));
    ++written;
  };
  std::vector<std::size_t> first(n);  // of each clock the first member of its class
  for (std::size_t i = 0; i < n; ++i) {
    first[i] = i;
    std::size_t last = i;
    for (std::size_t j = 0; j < i; ++j)
      if (sum(at(i, j), at(j, i)) == raw_zero) {
        if (first[i] == i) first[i] = j;
        last = j;
      }
    if (last == i) continue;
    add(last, i);  // one way round from each member to the next, the way back from the last one to the first
    bool is_last = true;
    for (std::size_t j = i + 1; j < n; ++j) is_last &= sum(at(i, j), at(j, i)) != raw_zero;
    if (is_last) add(i, first[i]);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j || first[i] != i || first[j] != j || at(i, j) == unbounded_entry) continue;
      bool follows = false;
      for (std::size_t k = 0; k < n && !follows; ++k)
        follows = k != i && k != j && first[k] == k && sum(at(i, k), at(k, j)) <= at(i, j);
      if (!follows) add(i, j);
    }
  part.constraints.push_back(written);
}

}  // namespace tachk::reachability
