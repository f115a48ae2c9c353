#include "states/arrivals.hpp"

#include <cstring>

namespace tachk {

bool Arrivals::covers(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds) const {
  return any(discrete, [&](std::uint32_t n) { return share_.zones().covers(arrivals_[n].zone, zone, bounds); });
}

std::size_t Arrivals::count(std::uint32_t discrete) const {
  std::size_t count = share_.count(discrete);
  any(discrete, [&](std::uint32_t) {
    ++count;
    return false;
  });
  return count;
}

std::size_t Arrivals::unite(std::uint32_t discrete, ZoneView zone, std::uint32_t first, ZoneRef united,
                            std::vector<std::uint32_t>& parts, std::vector<std::uint32_t>& own) {
  std::memcpy(united.bytes, zone.data.bytes, share_.zones().operations(zone.dimension).bytes);
  std::size_t looked = 0;
  const auto look = [&](std::uint32_t other) {
    ++looked;
    return share_.unite(united, zone.dimension, other);
  };
  for (std::size_t before = SIZE_MAX; before != parts.size() + own.size();) {
    before = parts.size() + own.size();
    any(discrete, [&](std::uint32_t n) {
      if (look(arrivals_[n].zone)) own.push_back(n);
      return false;
    });
    share_.for_each_waiting(discrete, first, parts, look);
  }
  return looked;
}

void Arrivals::add(std::uint64_t order, std::uint32_t discrete, ZoneView zone, bool subsumption,
                   const ClockBounds* bounds) {
  const std::size_t covered_before = share_.covered().size();
  if (subsumption) {
    share_.thin_out(discrete, zone, bounds);
    any(discrete, [&](std::uint32_t n) {
      Arrival& arrival = arrivals_[n];
      if (!share_.zones().is_covered(arrival.zone, zone, bounds)) return false;
      arrival.zone = share_.give_up(arrival.zone);
      arrival.covered = true;
      --added_;
      return false;
    });
  }
  const std::uint32_t zone_number = share_.intern(zone);
  if (!subsumption) {
    const bool equal = share_.holds(discrete, zone, zone_number) ||
                       any(discrete, [&](std::uint32_t n) { return arrivals_[n].zone == zone_number; });
    if (equal) return share_.release(zone_number);
  }
  std::uint32_t& latest = latest_[place(discrete)];
  arrivals_.push_back({order, discrete, zone_number, latest, false});
  latest = static_cast<std::uint32_t>(arrivals_.size() - 1);
  added_ += 1 - static_cast<std::int64_t>(share_.covered().size() - covered_before);
}

void Arrivals::settle(Nodes& nodes, std::span<const std::uint32_t> numbers) {
  for (std::size_t n = 0; n < arrivals_.size(); ++n) {
    const Arrival& arrival = arrivals_[n];
    latest_[place(arrival.discrete)] = none;
    nodes[numbers[n]] = {arrival.discrete | Nodes::mark, arrival.zone};
    if (!arrival.covered) share_.append(arrival.discrete, numbers[n]);
  }
  arrivals_.clear();
  added_ = 0;
}

}  // namespace tachk
