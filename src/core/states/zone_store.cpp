#include "states/zone_store.hpp"

namespace tachk::states {

ZoneStore::ZoneStore(const zones::ZoneOperations& operations, int dimension,
                     const std::vector<zones::ZoneOperations>& smaller, const rows::Forms& forms)
    : has_one_(smaller.empty()), uses_(sizeof(Use)), places_(sizeof(Place)) {
  for (std::size_t each = 0; each < smaller.size(); ++each)
    by_dimension_.emplace_back(smaller[each], static_cast<int>(each), forms, small_block);
  by_dimension_.emplace_back(operations, dimension, forms, small_block);
}

std::uint32_t ZoneStore::add(ZoneView zone) {
  const std::uint32_t record = of_dimension(zone.dimension).add(zone.data);
  if (has_one()) {
    if (record == uses_.size()) uses_.append();
    return record;
  }
  std::uint32_t number = uses_.size();
  if (free_.empty()) {
    uses_.append();
    places_.append();
  } else {
    number = free_.back();
    free_.pop_back();
  }
  *reinterpret_cast<Place*>(places_[number]) = {static_cast<std::uint32_t>(zone.dimension), record};
  return number;
}

std::uint32_t ZoneStore::intern(ZoneView zone) {
  const std::uint64_t hash_value = hash(zone);
  const std::uint32_t found = index_.find(hash_value, [&](std::uint32_t number) { return equals(number, zone); });
  if (found != HashIndex::absent) {
    ++use(found).count;
    return found;
  }
  const std::uint32_t number = add(zone);
  use(number) = {1, static_cast<std::uint32_t>(hash_value >> 32)};
  index_.insert(hash_value, number);
  return number;
}

void ZoneStore::release(std::uint32_t number) {
  if (--use(number).count != 0) return;
  index_.erase(use(number).upper_hash, number);
  holder(number).remove(record(number));
  if (!has_one()) free_.push_back(number);
}

std::size_t ZoneStore::bytes() const {
  std::size_t sum = uses_.bytes() + places_.bytes() + index_.bytes() + free_.capacity() * sizeof(std::uint32_t);
  for (const rows::ZonesOfDimension& each : by_dimension_) sum += each.bytes();
  return sum;
}

}  // namespace tachk::states
