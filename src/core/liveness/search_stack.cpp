#include "liveness/search_stack.hpp"

#include <cstring>

namespace tachk::liveness {

using states::no_node;
using states::ZoneView;

namespace {

// Of a record that holds zones of fewer clocks, too, whose rows may be read in larger vectors than those of the others.
std::size_t aligned(std::size_t bytes) { return (bytes + 31) / 32 * 32; }

}  // namespace

SearchStack::SearchStack(const symbolic::ZoneGraph& graph)
    : operations_(graph.operations()),
      smaller_(graph.smaller_operations()),
      dimension_(graph.program().dimension()),
      zones_(aligned(graph.operations().bytes)) {}

std::vector<std::uint32_t> SearchStack::path() const {
  std::vector<std::uint32_t> path;
  for (std::uint32_t number = 0; number < size(); ++number)
    if (states_[number].open) path.push_back(number);
  return path;
}

void SearchStack::push(std::uint32_t discrete, ZoneView zone) {
  const std::uint32_t number = size();
  while (zones_.size() <= number) zones_.append();
  std::memcpy(zones_[number], zone.data.bytes, operations(zone.dimension).bytes);
  states_.push_back({discrete, no_node, zone.dimension, false});
}

void SearchStack::open_top() {
  State& state = states_.back();
  state.open = true;
  if (newest_.size() <= state.discrete) newest_.resize(state.discrete + 1, no_node);
  state.below = newest_[state.discrete];
  newest_[state.discrete] = size() - 1;
  ++depth_;
}

void SearchStack::pop() {
  const State& state = states_.back();
  if (state.open) {
    newest_[state.discrete] = state.below;
    --depth_;
  }
  states_.pop_back();
}

bool SearchStack::holds(std::uint32_t number, ZoneView zone) const {
  return states_[number].dimension == zone.dimension &&
         std::memcmp(zones_[number], zone.data.bytes, operations(zone.dimension).bytes) == 0;
}

std::uint32_t SearchStack::find_below(std::uint32_t discrete, ZoneView zone, bool subsumption) const {
  if (discrete >= newest_.size()) return no_node;
  const zones::ZoneOperations& its = operations(zone.dimension);
  for (std::uint32_t number = newest_[discrete]; number != no_node; number = states_[number].below) {
    const zones::ConstZoneRef held{zones_[number]};
    const bool inside = subsumption ? its.includes(zone.data, held, zone.dimension)
                                    : std::memcmp(zone.data.bytes, held.bytes, its.bytes) == 0;
    if (inside) return number;
  }
  return no_node;
}

}  // namespace tachk::liveness
