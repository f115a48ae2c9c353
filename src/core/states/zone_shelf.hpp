// The zones of one dimension, in records that are used again. Few of them are held whole. Once there are many, they are
// held as lists of rows if that takes less memory, which is looked at again whenever their number has grown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "states/memory.hpp"
#include "states/row_store.hpp"
#include "zones/zone.hpp"

namespace tachk {

class ZoneShelf {
 public:
  // `rows_after`: at how many zones it is looked at first; 0: they always are lists of rows.
  ZoneShelf(const ZoneOperations& operations, int dimension, std::uint32_t rows_after, std::size_t least_block_bytes);

  const ZoneOperations& operations() const { return operations_; }
  int dimension() const { return dimension_; }

  // The record of one more zone.
  std::uint32_t add(ConstZoneRef zone);
  void remove(std::uint32_t record);

  bool equals(std::uint32_t record, ConstZoneRef zone) const;
  // Whether the zone of a record contains this one; with `bounds` (may be null), simulates it.
  bool covers(std::uint32_t record, ConstZoneRef inner, const ClockBounds* bounds) const;
  // The other way round.
  bool is_covered(std::uint32_t record, ConstZoneRef outer, const ClockBounds* bounds) const;
  // The zone itself, or a copy in `buffer`.
  ConstZoneRef read(std::uint32_t record, ZoneRef buffer) const;

  bool by_rows() const { return rows_.has_value(); }
  std::size_t bytes() const;

 private:
  std::size_t list_bytes() const { return static_cast<std::size_t>(dimension_) * sizeof(std::uint32_t); }
  ConstZoneRef whole(std::uint32_t record) const { return {records_[record]}; }
  ZoneRows rows(std::uint32_t record) const {
    return rows_->zone(reinterpret_cast<const std::uint32_t*>(records_[record]));
  }
  void put(std::uint32_t record, ConstZoneRef zone);
  // Holds the zones the other way if that takes less memory.
  void reconsider();
  void hold_whole();

  ZoneOperations operations_;
  int dimension_;
  std::size_t least_block_bytes_;
  RecordPool records_;            // zones, or lists of the numbers of their rows
  std::optional<RowStore> rows_;  // if they are lists
  std::vector<std::uint32_t> free_;
  std::uint64_t next_look_;  // at how many records; 0: never
};

}  // namespace tachk
