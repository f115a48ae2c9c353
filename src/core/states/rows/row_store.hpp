// Rows of zones held once each, by number, with a count of the zones that have them. Zones of one search have few
// different rows: most clocks are compared with the same constants and have been reset at the same times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "states/memory.hpp"
#include "zones/zone_ref.hpp"

namespace tachk::states::rows {

class RowStore {
 public:
  explicit RowStore(std::size_t row_bytes);

  // The numbers of rows that lie one behind the other, for one more zone.
  void intern(const std::byte* rows, int count, std::uint32_t* numbers);
  // One zone fewer has the row. Its memory is used again once none has.
  void release(std::uint32_t number);

  zones::ZoneRows zone(const std::uint32_t* numbers) const { return {rows_.blocks(), numbers, rows_.shift()}; }
  // How many different ones there are.
  std::size_t size() const { return rows_.size() - free_.size(); }
  // The bytes of one row, as a rule.
  std::size_t bytes_each() const { return row_bytes_ + sizeof(std::uint32_t) + sizeof(std::uint64_t) * 3 / 2; }
  std::size_t bytes() const {
    return rows_.bytes() + counts_.bytes() + index_.bytes() + free_.capacity() * sizeof(std::uint32_t);
  }

 private:
  std::uint64_t hash(const std::byte* row) const;
  bool equal(const std::byte* row, const std::byte* other) const;
  std::uint32_t intern(const std::byte* row, std::uint64_t hash_value);
  std::uint32_t& count(std::uint32_t number) { return *reinterpret_cast<std::uint32_t*>(counts_[number]); }

  std::size_t row_bytes_;  // a multiple of 16
  RecordPool rows_;
  RecordPool counts_;
  HashIndex index_;
  std::vector<std::uint32_t> free_;
  std::vector<std::uint64_t> hashes_;  // of the rows that are being looked up
};

}  // namespace tachk::states::rows
