// Zones held once each, by number, with a count of those who need them. Zones may have several dimensions, where those
// of a model with many clocks leave out clocks that do not matter.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "states/memory.hpp"
#include "states/rows/zones_of_dimension.hpp"
#include "zones/zone.hpp"

namespace tachk::states {

struct ZoneView {
  zones::ConstZoneRef data;
  int dimension;
};

class ZoneStore {
 public:
  // `smaller`: the operations for each dimension below this one; empty if there are no such zones.
  ZoneStore(const zones::ZoneOperations& operations, int dimension, const std::vector<zones::ZoneOperations>& smaller,
            const rows::Forms& forms);

  const zones::ZoneOperations& operations(int dimension) const { return of_dimension(dimension).operations(); }

  // The number of the zone, for one more who needs it; `hash_value`: its hash.
  std::uint32_t intern(ZoneView zone);
  std::uint64_t hash(ZoneView zone) const { return operations(zone.dimension).hash(zone.data, zone.dimension); }
  // One node fewer needs the zone. Its memory is used again once no node does.
  void release(std::uint32_t number);

  // True if a zone contains another one of its dimension; with `bounds` (may be null), simulates it.
  bool covers(std::uint32_t number, ZoneView inner, const zones::ClockBounds* bounds = nullptr) const {
    return holder(number).covers(record(number), inner.data, bounds);
  }
  // The other way round.
  bool is_covered(std::uint32_t number, ZoneView outer, const zones::ClockBounds* bounds = nullptr) const {
    return holder(number).is_covered(record(number), outer.data, bounds);
  }
  bool equals(std::uint32_t number, ZoneView zone) const {
    const rows::ZonesOfDimension& held = holder(number);
    return held.dimension() == zone.dimension && held.equals(record(number), zone.data);
  }
  // The zone itself, or a copy in `buffer`.
  ZoneView read(std::uint32_t number, zones::ZoneRef buffer) const {
    const rows::ZonesOfDimension& held = holder(number);
    return {held.read(record(number), buffer), held.dimension()};
  }
  // Half of the hash of a zone.
  std::uint32_t upper_hash(std::uint32_t number) const { return use(number).upper_hash; }
  std::uint32_t upper_hash(ZoneView zone) const { return static_cast<std::uint32_t>(hash(zone) >> 32); }
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

  bool has_one() const { return has_one_; }
  rows::ZonesOfDimension& of_dimension(int dimension) {
    return by_dimension_[has_one() ? 0 : static_cast<std::size_t>(dimension)];
  }
  const rows::ZonesOfDimension& of_dimension(int dimension) const {
    return by_dimension_[has_one() ? 0 : static_cast<std::size_t>(dimension)];
  }
  Place place(std::uint32_t number) const { return *reinterpret_cast<const Place*>(places_[number]); }
  rows::ZonesOfDimension& holder(std::uint32_t number) {
    return has_one() ? by_dimension_[0] : by_dimension_[place(number).dimension];
  }
  const rows::ZonesOfDimension& holder(std::uint32_t number) const {
    return has_one() ? by_dimension_[0] : by_dimension_[place(number).dimension];
  }
  std::uint32_t record(std::uint32_t number) const { return has_one() ? number : place(number).record; }
  Use& use(std::uint32_t number) { return *reinterpret_cast<Use*>(uses_[number]); }
  const Use& use(std::uint32_t number) const { return *reinterpret_cast<const Use*>(uses_[number]); }
  std::uint32_t add(ZoneView zone);

  bool has_one_;                                      // dimension
  std::vector<rows::ZonesOfDimension> by_dimension_;  // one, whose records are the zones, or one for each dimension
  RecordPool uses_;                                   // of each zone
  RecordPool places_;                                 // of each zone; only with several dimensions
  std::vector<std::uint32_t> free_;                   // numbers to be used again; only with several dimensions
  HashIndex index_;
};

}  // namespace tachk::states
