#include "states/zone_store.hpp"

#include <cstring>
#include <utility>

namespace tachk {

ZoneStore::ZoneStore(const ZoneOperations& operations, int dimension, std::vector<ZoneOperations> smaller)
    : operations_(operations), dimension_(dimension), smaller_(std::move(smaller)), whole_(operations.bytes) {
  free_.resize(smaller_.empty() ? 1 : static_cast<std::size_t>(dimension) + 1);
  if (!smaller_.empty()) pools_.resize(free_.size());
}

bool ZoneStore::equals(std::uint32_t number, ZoneView zone) const {
  const ZoneView held = view(number);
  return held.dimension == zone.dimension &&
         std::memcmp(held.data.bytes, zone.data.bytes, operations(zone.dimension).bytes) == 0;
}

std::byte* ZoneStore::record(std::uint32_t number) {
  return smaller_.empty() ? whole_[number] : (*pools_[places_[number].dimension])[places_[number].record];
}

std::uint32_t ZoneStore::fresh(int dimension) {
  const std::size_t place = smaller_.empty() ? 0 : static_cast<std::size_t>(dimension);
  std::vector<std::uint32_t>& free = free_[place];
  if (!free.empty()) {
    const std::uint32_t number = free.back();
    free.pop_back();
    return number;
  }
  constexpr std::size_t small_block = std::size_t{1} << 15;
  if (!smaller_.empty() && !pools_[place])
    pools_[place] = std::make_unique<RecordPool>(operations(dimension).bytes, small_block);
  RecordPool& pool = smaller_.empty() ? whole_ : *pools_[place];
  pool_bytes_ -= pool.bytes();
  const std::uint32_t appended = pool.append();
  pool_bytes_ += pool.bytes();
  const auto number = static_cast<std::uint32_t>(uses_.size());
  uses_.emplace_back();
  if (!smaller_.empty()) places_.push_back({static_cast<std::uint32_t>(dimension), appended});
  return number;
}

std::uint32_t ZoneStore::intern(ZoneView zone, std::uint64_t hash_value) {
  const std::uint32_t found = index_.find(hash_value, [&](std::uint32_t number) { return equals(number, zone); });
  if (found != HashIndex::absent) {
    ++uses_[found].count;
    return found;
  }
  const std::uint32_t number = fresh(zone.dimension);
  uses_[number] = {1, static_cast<std::uint32_t>(hash_value >> 32)};
  std::memcpy(record(number), zone.data.bytes, operations(zone.dimension).bytes);
  index_.insert(hash_value, number);
  return number;
}

void ZoneStore::release(std::uint32_t number) {
  if (--uses_[number].count != 0) return;
  index_.erase(uses_[number].upper_hash, number);
  free_[smaller_.empty() ? 0 : places_[number].dimension].push_back(number);
}

std::size_t ZoneStore::bytes() const {
  return pool_bytes_ + uses_.capacity() * sizeof(Use) + places_.capacity() * sizeof(Place) + index_.bytes();
}

}  // namespace tachk
