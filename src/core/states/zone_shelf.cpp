#include "states/zone_shelf.hpp"

#include <cstring>
#include <utility>

namespace tachk {

ZoneShelf::ZoneShelf(const ZoneOperations& operations, int dimension, std::uint32_t rows_after,
                     std::size_t least_block_bytes)
    : operations_(operations),
      dimension_(dimension),
      least_block_bytes_(least_block_bytes),
      records_(operations.bytes, least_block_bytes),
      next_look_(rows_after) {
  if (rows_after != 0) return;
  records_ = RecordPool(list_bytes(), least_block_bytes_);
  rows_.emplace(operations_.row_bytes);
}

std::uint32_t ZoneShelf::add(ConstZoneRef zone) {
  if (free_.empty() && next_look_ != 0 && records_.size() == next_look_) reconsider();
  std::uint32_t record = records_.size();
  if (free_.empty()) {
    records_.append();
  } else {
    record = free_.back();
    free_.pop_back();
  }
  put(record, zone);
  return record;
}

void ZoneShelf::put(std::uint32_t record, ConstZoneRef zone) {
  if (!rows_) {
    std::memcpy(records_[record], zone.bytes, operations_.bytes);
    return;
  }
  auto* const numbers = reinterpret_cast<std::uint32_t*>(records_[record]);
  for (int i = 0; i < dimension_; ++i)
    numbers[i] = rows_->intern(zone.bytes + static_cast<std::size_t>(i) * operations_.row_bytes);
}

void ZoneShelf::remove(std::uint32_t record) {
  if (rows_) {
    const auto* const numbers = reinterpret_cast<const std::uint32_t*>(records_[record]);
    for (int i = 0; i < dimension_; ++i) rows_->release(numbers[i]);
  }
  free_.push_back(record);
}

bool ZoneShelf::equals(std::uint32_t record, ConstZoneRef zone) const {
  return rows_ ? operations_.rows.equal(rows(record), zone, dimension_)
               : std::memcmp(records_[record], zone.bytes, operations_.bytes) == 0;
}

bool ZoneShelf::covers(std::uint32_t record, ConstZoneRef inner, const ClockBounds* bounds) const {
  if (bounds == nullptr)
    return rows_ ? operations_.rows.include(rows(record), inner, dimension_)
                 : operations_.includes(whole(record), inner, dimension_);
  return rows_ ? operations_.rows.simulate(rows(record), inner, dimension_, *bounds)
               : operations_.simulates(whole(record), inner, dimension_, *bounds);
}

bool ZoneShelf::is_covered(std::uint32_t record, ConstZoneRef outer, const ClockBounds* bounds) const {
  if (bounds == nullptr)
    return rows_ ? operations_.rows.lie_in(rows(record), outer, dimension_)
                 : operations_.includes(outer, whole(record), dimension_);
  return rows_ ? operations_.rows.are_simulated(rows(record), outer, dimension_, *bounds)
               : operations_.simulates(outer, whole(record), dimension_, *bounds);
}

ConstZoneRef ZoneShelf::read(std::uint32_t record, ZoneRef buffer) const {
  if (!rows_) return whole(record);
  operations_.rows.assemble(buffer, rows(record), dimension_);
  return buffer;
}

// Only called when no record is free.
void ZoneShelf::reconsider() {
  next_look_ *= 4;
  const std::size_t zones = records_.size();
  const std::size_t whole_bytes = zones * operations_.bytes;
  const auto bytes_by = [&](const RowStore& rows) { return zones * list_bytes() + rows.size() * rows.bytes_each(); };
  if (rows_) {
    if (bytes_by(*rows_) > whole_bytes) hold_whole();
    return;
  }
  RowStore rows(operations_.row_bytes);
  RecordPool lists(list_bytes(), least_block_bytes_);
  for (std::uint32_t record = 0; record < zones; ++record) {
    auto* const numbers = reinterpret_cast<std::uint32_t*>(lists[lists.append()]);
    for (int i = 0; i < dimension_; ++i)
      numbers[i] = rows.intern(records_[record] + static_cast<std::size_t>(i) * operations_.row_bytes);
  }
  if (bytes_by(rows) > whole_bytes / 4 * 3) return;  // lists cost time, too
  records_ = std::move(lists);
  rows_ = std::move(rows);
}

void ZoneShelf::hold_whole() {
  RecordPool zones(operations_.bytes, least_block_bytes_);
  for (std::uint32_t record = 0; record < records_.size(); ++record)
    operations_.rows.assemble({zones[zones.append()]}, rows(record), dimension_);
  records_ = std::move(zones);
  rows_.reset();
}

std::size_t ZoneShelf::bytes() const {
  return records_.bytes() + (rows_ ? rows_->bytes() : 0) + free_.capacity() * sizeof(std::uint32_t);
}

}  // namespace tachk
