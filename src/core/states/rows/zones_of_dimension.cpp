#include "states/rows/zones_of_dimension.hpp"

#include <cstring>
#include <utility>

namespace tachk::states::rows {

ZonesOfDimension::ZonesOfDimension(const zones::ZoneOperations& operations, int dimension, std::uint32_t rows_after,
                                   std::size_t least_block_bytes)
    : operations_(operations),
      dimension_(dimension),
      least_block_bytes_(least_block_bytes),
      records_(operations.bytes, least_block_bytes),
      next_review_(rows_after) {
  if (rows_after != 0) return;
  records_ = RecordPool(list_bytes(), least_block_bytes_);
  rows_.emplace(operations_.row_bytes);
}

std::uint32_t ZonesOfDimension::add(zones::ConstZoneRef zone) {
  if (free_.empty() && next_review_ != 0 && records_.size() == next_review_) reconsider();
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

void ZonesOfDimension::put(std::uint32_t record, zones::ConstZoneRef zone) {
  if (!rows_) {
    std::memcpy(records_[record], zone.bytes, operations_.bytes);
    return;
  }
  rows_->intern(zone.bytes, dimension_, reinterpret_cast<std::uint32_t*>(records_[record]));
}

void ZonesOfDimension::remove(std::uint32_t record) {
  if (rows_) {
    const auto* const numbers = reinterpret_cast<const std::uint32_t*>(records_[record]);
    for (int i = 0; i < dimension_; ++i) rows_->release(numbers[i]);
  }
  free_.push_back(record);
}

// Only called when no record is free.
void ZonesOfDimension::reconsider() {
  next_review_ *= 4;
  const std::size_t zones = records_.size();
  const std::size_t whole_bytes = zones * operations_.bytes;
  const auto bytes_by = [&](const RowStore& rows) { return zones * list_bytes() + rows.size() * rows.bytes_each(); };
  if (rows_) {
    if (bytes_by(*rows_) > whole_bytes) hold_whole();
    return;
  }
  RowStore rows(operations_.row_bytes);
  RecordPool lists(list_bytes(), least_block_bytes_);
  for (std::uint32_t record = 0; record < zones; ++record)
    rows.intern(records_[record], dimension_, reinterpret_cast<std::uint32_t*>(lists[lists.append()]));
  if (bytes_by(rows) > whole_bytes / 4 * 3) return;  // lists cost time, too
  records_ = std::move(lists);
  rows_ = std::move(rows);
}

void ZonesOfDimension::hold_whole() {
  RecordPool zones(operations_.bytes, least_block_bytes_);
  for (std::uint32_t record = 0; record < records_.size(); ++record)
    operations_.rows.assemble({zones[zones.append()]}, rows(record), dimension_);
  records_ = std::move(zones);
  rows_.reset();
}

std::size_t ZonesOfDimension::bytes() const {
  return records_.bytes() + (rows_ ? rows_->bytes() : 0) + free_.capacity() * sizeof(std::uint32_t);
}

}  // namespace tachk::states::rows
