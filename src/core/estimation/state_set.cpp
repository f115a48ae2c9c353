#include "estimation/state_set.hpp"

#include <algorithm>
#include <utility>

namespace tachk::estimation {

std::size_t StateSet::KeyHash::operator()(const Key& key) const {
  std::uint64_t hash = key.size();
  for (const std::int32_t number : key) hash = (hash ^ static_cast<std::uint32_t>(number)) * 0x9E3779B97F4A7C15u;
  return static_cast<std::size_t>(hash ^ hash >> 32);
}

void StateSet::add(const symbolic::ZoneGraph& graph, const std::int32_t* slots,
                   const std::vector<std::uint32_t>& positions, zones::ConstZoneRef zone, std::uint32_t lead,
                   const std::vector<bool>& taken) {
  const zones::ZoneOperations& operations = graph.operations();
  const int dimension = graph.program().dimension();
  Key key(slots, slots + graph.program().state_slots);
  for (const std::uint32_t position : positions) key.push_back(static_cast<std::int32_t>(position));
  std::vector<std::uint32_t>& same = places_[std::move(key)];
  for (const std::uint32_t other : same)
    if (operations.includes(nodes_[other].zone.get(), zone, dimension)) return;
  std::erase_if(same, [&](std::uint32_t other) {
    const bool covers = operations.includes(zone, nodes_[other].zone.get(), dimension);
    if (covers) nodes_[other].covered = true;
    return covers;
  });
  same.push_back(static_cast<std::uint32_t>(nodes_.size()));
  nodes_.push_back(
      {{slots, slots + graph.program().slots.size()}, positions, zones::ZoneBuffer(operations), lead, taken, false});
  nodes_.back().zone.assign(zone);
}

}  // namespace tachk::estimation
