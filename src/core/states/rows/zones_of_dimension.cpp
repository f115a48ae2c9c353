#include "states/rows/zones_of_dimension.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "zones/zone_buffer.hpp"

namespace tachk::states::rows {

ZonesOfDimension::ZonesOfDimension(const zones::ZoneOperations& operations, int dimension, const Forms& forms,
                                   std::size_t least_block_bytes)
    : operations_(operations),
      dimension_(dimension),
      forms_(forms),
      least_block_bytes_(least_block_bytes),
      records_(operations.bytes, least_block_bytes),
      next_review_(can_reduce() ? std::min(forms.rows_after, forms.reduced_after) : forms.rows_after) {
  if (can_reduce() && forms.reduced_after == 0) {
    records_ = RecordPool(sizeof(std::uint32_t), least_block_bytes_);
    reduced_.emplace(operations_, dimension_);
  } else if (forms.rows_after == 0) {
    next_review_ = 0;
    records_ = RecordPool(list_bytes(), least_block_bytes_);
    rows_.emplace(operations_.row_bytes);
  }
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
  if (reduced_) {
    number(record) = reduced_->add(zone);
    return;
  }
  if (!rows_) {
    std::memcpy(records_[record], zone.bytes, operations_.bytes);
    return;
  }
  rows_->intern(zone.bytes, dimension_, reinterpret_cast<std::uint32_t*>(records_[record]));
}

void ZonesOfDimension::remove(std::uint32_t record) {
  if (reduced_) reduced_->remove(number(record));
  if (rows_) {
    const auto* const numbers = reinterpret_cast<const std::uint32_t*>(records_[record]);
    for (int i = 0; i < dimension_; ++i) rows_->release(numbers[i]);
  }
  free_.push_back(record);
}

// Only called when no record is free.
void ZonesOfDimension::reconsider() {
  next_review_ *= 4;
  if (reduced_) return;
  if (records_.size() >= forms_.rows_after) reconsider_rows();
  if (can_reduce() && records_.size() >= forms_.reduced_after && reduced_is_small()) hold_reduced();
  if (rows_) before_ = {records_.size(), rows_->size()};
}

// What records take is seen from some of them. Of the rows that have come of late half count, since the more zones
// there are, the fewer rows are new. At first more has to be saved, since little is known of that.
bool ZonesOfDimension::reduced_is_small() const {
  constexpr std::uint32_t sample = 64;
  constexpr std::uint32_t most_rows =
      20;  // the time to reduce zones grows with the square of what rows have constraints
  ReducedZones reduced(operations_, dimension_);
  zones::ZoneBuffer buffer(operations_);
  const std::uint32_t zones = records_.size();
  const std::uint32_t step = std::max(zones / sample, 1u);
  std::size_t record_bytes = 0;
  std::uint32_t samples = 0;
  std::uint32_t rows = 0;
  for (std::uint32_t record = 0; record < zones; record += step, ++samples) {
    const ReducedZones::Size size = reduced.size_of(read(record, buffer.get()));
    record_bytes += size.bytes;
    rows += size.rows;
  }
  if (rows > most_rows * samples) return false;
  const std::size_t reduced_bytes = record_bytes / samples + sizeof(std::uint32_t);
  const std::size_t times = zones < 16 * std::uint64_t{forms_.reduced_after} ? 4 : 2;
  if (!rows_) return times * reduced_bytes <= operations_.bytes;
  const std::size_t fresh = rows_->size() - std::min(rows_->size(), before_.rows);
  const std::size_t fresh_bytes = fresh * rows_->bytes_each() / (zones - before_.zones);
  return times * reduced_bytes <= list_bytes() + fresh_bytes / 2;
}

void ZonesOfDimension::hold_reduced() {
  ReducedZones reduced(operations_, dimension_);
  zones::ZoneBuffer buffer(operations_);
  RecordPool numbers(sizeof(std::uint32_t), least_block_bytes_);
  for (std::uint32_t record = 0; record < records_.size(); ++record) {
    const std::uint32_t number = reduced.add(read(record, buffer.get()));
    std::memcpy(numbers[numbers.append()], &number, sizeof number);
  }
  records_ = std::move(numbers);
  reduced_.emplace(std::move(reduced));
  rows_.reset();
}

void ZonesOfDimension::reconsider_rows() {
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
    if (record == zones / 2) before_ = {record, rows.size()};
    rows.intern(records_[record], dimension_, reinterpret_cast<std::uint32_t*>(lists[lists.append()]));
  }
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
  return records_.bytes() + (rows_ ? rows_->bytes() : 0) + (reduced_ ? reduced_->bytes() : 0) +
         free_.capacity() * sizeof(std::uint32_t);
}

}  // namespace tachk::states::rows
