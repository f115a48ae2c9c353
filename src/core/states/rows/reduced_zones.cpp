#include "states/rows/reduced_zones.hpp"

#include <cstring>

#include "zones/reduced.hpp"

namespace tachk::states::rows {

using zones::ClockBounds;
using zones::ConstZoneRef;

ReducedZones::ReducedZones(const zones::ZoneOperations& operations, int dimension)
    : operations_(operations),
      dimension_(dimension),
      units_(unit_bytes, small_block),
      record_(operations.reductions.most_bytes + unit_bytes),
      zone_(operations) {}

std::size_t ReducedZones::reduce(ConstZoneRef zone) {
  return (operations_.reductions.reduce(record_.data(), zone, dimension_) + unit_bytes - 1) / unit_bytes;
}

ReducedZones::Size ReducedZones::size_of(ConstZoneRef zone) {
  const std::size_t count = reduce(zone);
  return {count * unit_bytes, zones::ReducedHeader::rows_of(record_.data())};
}

std::uint32_t ReducedZones::take(std::size_t count) {
  if (count < free_.size() && !free_[count].empty()) {
    const std::uint32_t first = free_[count].back();
    free_[count].pop_back();
    return first;
  }
  const std::uint32_t of_block = std::uint32_t{1} << units_.shift();
  const std::uint32_t rest = of_block - (units_.size() & (of_block - 1));
  if (rest < count)  // no record lies in two blocks
    for (std::uint32_t n = 0; n < rest; ++n) units_.append();
  const std::uint32_t first = units_.size();
  for (std::size_t n = 0; n < count; ++n) units_.append();
  return first;
}

std::uint32_t ReducedZones::add(ConstZoneRef zone) {
  const std::size_t count = reduce(zone);
  const std::uint32_t number = take(count);
  std::memcpy(units_[number], record_.data(), count * unit_bytes);
  return number;
}

void ReducedZones::remove(std::uint32_t number) {
  const std::size_t count = (zones::ReducedHeader::of(units_[number]).record_bytes() + unit_bytes - 1) / unit_bytes;
  if (free_.size() <= count) free_.resize(count + 1);
  free_[count].push_back(number);
}

bool ReducedZones::equals(std::uint32_t number, ConstZoneRef zone) const {
  return operations_.reductions.include(units_[number], zone, dimension_) &&
         std::memcmp(restored(number).bytes, zone.bytes, operations_.bytes) == 0;
}

bool ReducedZones::covers(std::uint32_t number, ConstZoneRef inner, const ClockBounds* bounds) const {
  const std::byte* const record = units_[number];
  if (bounds == nullptr) return operations_.reductions.include(record, inner, dimension_);
  return operations_.reductions.may_simulate(record, inner, dimension_, *bounds) &&
         operations_.simulates(restored(number), inner, dimension_, *bounds);
}

bool ReducedZones::is_covered(std::uint32_t number, ConstZoneRef outer, const ClockBounds* bounds) const {
  const std::byte* const record = units_[number];
  if (bounds == nullptr)
    return operations_.reductions.may_lie_in(record, outer, dimension_) &&
           operations_.includes(outer, restored(number), dimension_);
  return operations_.reductions.may_be_simulated(record, outer, dimension_, *bounds) &&
         operations_.simulates(outer, restored(number), dimension_, *bounds);
}

std::size_t ReducedZones::bytes() const {
  std::size_t sum = units_.bytes() + record_.capacity() + operations_.bytes;
  for (const std::vector<std::uint32_t>& each : free_) sum += sizeof(each) + each.capacity() * sizeof(std::uint32_t);
  return sum;
}

}  // namespace tachk::states::rows
