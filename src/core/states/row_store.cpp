#include "states/row_store.hpp"

#include <cstring>

#include "zones/contract.hpp"

namespace tachk {
namespace {

constexpr std::size_t small_block = std::size_t{1} << 15;

}  // namespace

RowStore::RowStore(std::size_t row_bytes)
    : row_bytes_(row_bytes), rows_(row_bytes, small_block), counts_(sizeof(std::uint32_t), small_block / 4) {}

std::uint64_t RowStore::hash(const std::byte* row) const {
  std::uint64_t hash = 0x9E3779B97F4A7C15u;
  for (std::size_t at = 0; at < row_bytes_; at += sizeof(std::uint64_t)) {
    std::uint64_t word;
    std::memcpy(&word, row + at, sizeof(word));
    hash = (hash ^ word) * 0xD6E8FEB86659FD93u;
    hash ^= hash >> 32;
  }
  return hash * 0xD6E8FEB86659FD93u;
}

std::uint32_t RowStore::intern(const std::byte* row) {
  const std::uint64_t hash_value = hash(row);
  const std::uint32_t found =
      index_.find(hash_value, [&](std::uint32_t number) { return std::memcmp(rows_[number], row, row_bytes_) == 0; });
  if (found != HashIndex::absent) {
    ++count(found);
    return found;
  }
  std::uint32_t fresh = rows_.size();
  if (free_.empty()) {
    rows_.append();
    counts_.append();
  } else {
    fresh = free_.back();
    free_.pop_back();
  }
  std::memcpy(rows_[fresh], row, row_bytes_);
  count(fresh) = 1;
  index_.insert(hash_value, fresh);
  return fresh;
}

void RowStore::release(std::uint32_t number) {
  TACHK_EXPECT(count(number) > 0);
  if (--count(number) != 0) return;
  index_.erase(static_cast<std::uint32_t>(hash(rows_[number]) >> 32), number);
  free_.push_back(number);
}

}  // namespace tachk
