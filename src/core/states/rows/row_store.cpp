#include "states/rows/row_store.hpp"

#include <cstring>

#include "zones/contract.hpp"

namespace tachk::states::rows {
namespace {

__extension__ typedef unsigned __int128 Wide;

}  // namespace

RowStore::RowStore(std::size_t row_bytes)
    : row_bytes_(row_bytes), rows_(row_bytes), counts_(sizeof(std::uint32_t), small_block / 4) {}

// Two words at a time, so that no multiplication waits for another one.
std::uint64_t RowStore::hash(const std::byte* row) const {
  std::uint64_t hash = row_bytes_;
  for (std::size_t at = 0; at < row_bytes_; at += 2 * sizeof(std::uint64_t)) {
    std::uint64_t words[2];
    std::memcpy(words, row + at, sizeof(words));
    const auto product =
        static_cast<Wide>(words[0] ^ (0x9E3779B97F4A7C15u + (at << 32))) * (words[1] ^ 0xD6E8FEB86659FD93u);
    hash ^= static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
  }
  return hash * 0xC2B2AE3D27D4EB4Fu;
}

// Rows are too short for a call of memcmp to pay.
bool RowStore::equal(const std::byte* row, const std::byte* other) const {
  std::uint64_t difference = 0;
  for (std::size_t at = 0; at < row_bytes_; at += 2 * sizeof(std::uint64_t)) {
    std::uint64_t a[2];
    std::uint64_t b[2];
    std::memcpy(a, row + at, sizeof(a));
    std::memcpy(b, other + at, sizeof(b));
    difference |= (a[0] ^ b[0]) | (a[1] ^ b[1]);
  }
  return difference == 0;
}

void RowStore::intern(const std::byte* rows, int count, std::uint32_t* numbers) {
  hashes_.clear();
  for (int i = 0; i < count; ++i) {
    hashes_.push_back(hash(rows + static_cast<std::size_t>(i) * row_bytes_));
    index_.prefetch(hashes_.back());
  }
  for (int i = 0; i < count; ++i)
    numbers[i] = intern(rows + static_cast<std::size_t>(i) * row_bytes_, hashes_[static_cast<std::size_t>(i)]);
}

std::uint32_t RowStore::intern(const std::byte* row, std::uint64_t hash_value) {
  const std::uint32_t found = index_.find(hash_value, [&](std::uint32_t number) { return equal(rows_[number], row); });
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

}  // namespace tachk::states::rows
