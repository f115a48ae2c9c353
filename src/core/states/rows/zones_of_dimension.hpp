// The zones of one dimension, in records that are used again. Few of them are held whole. Once there are many, they are
// held as lists of rows if that takes less memory, or in reduced form if that takes far less, since it takes time to
// restore them. That is looked at again whenever their number has grown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "states/memory.hpp"
#include "states/rows/reduced_zones.hpp"
#include "states/rows/row_store.hpp"
#include "zones/zone.hpp"

namespace tachk::states::rows {

// At how many zones it is looked at first whether they are held so; 0: they always are, reduced ones where there is
// such a form.
struct Forms {
  std::uint32_t rows_after = 1024;
  std::uint32_t reduced_after = 1024;
};

class ZonesOfDimension {
 public:
  ZonesOfDimension(const zones::ZoneOperations& operations, int dimension, const Forms& forms,
                   std::size_t least_block_bytes);

  const zones::ZoneOperations& operations() const { return operations_; }
  int dimension() const { return dimension_; }

  // The record of one more zone.
  std::uint32_t add(zones::ConstZoneRef zone);
  void remove(std::uint32_t record);

  bool equals(std::uint32_t record, zones::ConstZoneRef zone) const {
    if (reduced_) return reduced_->equals(number(record), zone);
    return rows_ ? operations_.rows.equal(rows(record), zone, dimension_)
                 : std::memcmp(records_[record], zone.bytes, operations_.bytes) == 0;
  }
  // True if the zone of a record contains this one; with `bounds` (may be null), simulates it.
  bool covers(std::uint32_t record, zones::ConstZoneRef inner, const zones::ClockBounds* bounds) const {
    if (reduced_) return reduced_->covers(number(record), inner, bounds);
    if (bounds == nullptr)
      return rows_ ? operations_.rows.include(rows(record), inner, dimension_)
                   : operations_.includes(whole(record), inner, dimension_);
    return rows_ ? operations_.rows.simulate(rows(record), inner, dimension_, *bounds)
                 : operations_.simulates(whole(record), inner, dimension_, *bounds);
  }
  // The other way round.
  bool is_covered(std::uint32_t record, zones::ConstZoneRef outer, const zones::ClockBounds* bounds) const {
    if (reduced_) return reduced_->is_covered(number(record), outer, bounds);
    if (bounds == nullptr)
      return rows_ ? operations_.rows.lie_in(rows(record), outer, dimension_)
                   : operations_.includes(outer, whole(record), dimension_);
    return rows_ ? operations_.rows.are_simulated(rows(record), outer, dimension_, *bounds)
                 : operations_.simulates(outer, whole(record), dimension_, *bounds);
  }
  // The zone itself, or a copy in `buffer`.
  zones::ConstZoneRef read(std::uint32_t record, zones::ZoneRef buffer) const {
    if (reduced_) return reduced_->read(number(record), buffer);
    if (!rows_) return whole(record);
    operations_.rows.assemble(buffer, rows(record), dimension_);
    return buffer;
  }

  bool by_rows() const { return rows_.has_value(); }
  bool in_reduced_form() const { return reduced_.has_value(); }
  std::size_t bytes() const;

 private:
  std::size_t list_bytes() const { return static_cast<std::size_t>(dimension_) * sizeof(std::uint32_t); }
  zones::ConstZoneRef whole(std::uint32_t record) const { return {records_[record]}; }
  zones::ZoneRows rows(std::uint32_t record) const {
    return rows_->zone(reinterpret_cast<const std::uint32_t*>(records_[record]));
  }
  std::uint32_t& number(std::uint32_t record) { return *reinterpret_cast<std::uint32_t*>(records_[record]); }
  std::uint32_t number(std::uint32_t record) const { return *reinterpret_cast<const std::uint32_t*>(records_[record]); }
  bool can_reduce() const { return operations_.reductions.most_bytes != 0; }
  void put(std::uint32_t record, zones::ConstZoneRef zone);
  // Holds the zones another way if that takes less memory.
  void reconsider();
  // Whether they are whole or lists of rows.
  void reconsider_rows();
  void hold_whole();
  // Whether zones take far less memory in reduced form, and not much time.
  bool reduced_is_small() const;
  void hold_reduced();

  zones::ZoneOperations operations_;
  int dimension_;
  Forms forms_;
  std::size_t least_block_bytes_;
  RecordPool records_;            // zones, or lists of the numbers of their rows, or numbers of reduced zones
  std::optional<RowStore> rows_;  // if they are lists
  struct {
    std::size_t zones = 0;
    std::size_t rows = 0;
  } before_;  // when their number was a part of what it is now
  std::optional<ReducedZones> reduced_;
  std::vector<std::uint32_t> free_;
  std::uint64_t next_review_;  // at how many records; 0: never
};

}  // namespace tachk::states::rows
