// Zones held once each, by number, with a count of those who need them. Zones may have several dimensions, where those
// of a model with many clocks leave out clocks that do not matter.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "states/memory.hpp"
#include "zones/zone.hpp"

namespace tachk {

struct ZoneView {
  ConstZoneRef data;
  int dimension;
};

class ZoneStore {
 public:
  // `smaller`: the operations for each dimension below this one; empty if there are no such zones.
  ZoneStore(const ZoneOperations& operations, int dimension, std::vector<ZoneOperations> smaller);

  const ZoneOperations& operations(int dimension) const {
    return dimension == dimension_ ? operations_ : smaller_[static_cast<std::size_t>(dimension)];
  }

  // The number of the zone, for one more who needs it; `hash_value`: its hash.
  std::uint32_t intern(ZoneView zone, std::uint64_t hash_value);
  std::uint32_t intern(ZoneView zone) { return intern(zone, hash(zone)); }
  std::uint64_t hash(ZoneView zone) const { return operations(zone.dimension).hash(zone.data, zone.dimension); }
  // One fewer needs the zone. Its memory is used again once nobody does.
  void release(std::uint32_t number);

  ConstZoneRef operator[](std::uint32_t number) const {
    if (smaller_.empty()) return {whole_[number]};
    const Place place = places_[number];
    return {(*pools_[place.dimension])[place.record]};
  }
  ZoneView view(std::uint32_t number) const {
    return {(*this)[number], smaller_.empty() ? dimension_ : static_cast<int>(places_[number].dimension)};
  }
  // Half of the hash of a zone.
  std::uint32_t upper_hash(std::uint32_t number) const { return uses_[number].upper_hash; }
  std::uint32_t upper_hash(ZoneView zone) const { return static_cast<std::uint32_t>(hash(zone) >> 32); }
  bool equals(std::uint32_t number, ZoneView zone) const;
  std::size_t bytes() const;

 private:
  struct Use {
    std::uint32_t count;
    std::uint32_t upper_hash;
  };
  struct Place {
    std::uint32_t dimension;
    std::uint32_t record;
  };

  std::uint32_t fresh(int dimension);
  std::byte* record(std::uint32_t number);

  ZoneOperations operations_;
  int dimension_;
  std::vector<ZoneOperations> smaller_;
  RecordPool whole_;                                // if all have one dimension
  std::vector<std::unique_ptr<RecordPool>> pools_;  // else by dimension
  std::vector<std::vector<std::uint32_t>> free_;    // numbers to be used again, by dimension, or one
  std::vector<Use> uses_;
  std::vector<Place> places_;  // only with several dimensions
  HashIndex index_;
  std::size_t pool_bytes_ = 0;
};

}  // namespace tachk
