// What one thread has found of the states of one batch.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "states/store.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk {

// A successor that no stored state covers, not abstracted yet: most of them are found several times in one batch.
struct Found {
  std::uint64_t order;     // the place of its state in the batch, and in the lower half its own in the harvest
  std::uint64_t hash;      // of its discrete state
  ConstZoneRef zone;       // as the step leads to it
  std::uint32_t discrete;  // HashIndex::absent where that discrete state is not known
  std::uint32_t key;       // where the key of an unknown one begins
  std::uint32_t slots;     // where its slots begin, as far as they are kept
  std::uint32_t coverer;   // the stored state that covers it; no_node as a rule
  bool known;              // whether all parts of its discrete state are
};

// What is told of a state besides its successors.
struct alignas(64) Expansion {
  std::uint32_t finder = 0;
  std::uint32_t transitions = 0;
  std::size_t first_edge = 0;  // of those taken
  std::size_t last_edge = 0;
  bool done = false;
  bool eventful = false;  // a goal may be reached, or there may be an error: one thread is to expand it
};

class Harvest final {
 public:
  // Forgets everything, but for the memory.
  void clear() {
    block_ = used_ = bytes_ = 0;
    slots_.clear();
    keys_.clear();
    found.clear();
    edges.clear();
    for (std::vector<std::uint32_t>& share : shares) share.clear();
  }

  // Asks for the memory of what was found.
  void prefetch(std::uint32_t number, std::size_t bytes) const {
    const Found& next = found[number];
    for (std::size_t n = 0; n < bytes; n += 64) __builtin_prefetch(next.zone.bytes + n);
    __builtin_prefetch(slots_.data() + next.slots);
  }
  ConstZoneRef keep(ConstZoneRef zone, std::size_t bytes) {
    const std::size_t rounded = (bytes + 63) / 64 * 64;
    if (block_ < blocks_.size() && used_ + rounded > block_bytes) {
      ++block_;
      used_ = 0;
    }
    if (block_ == blocks_.size()) blocks_.emplace_back(std::max(block_bytes, rounded));
    std::byte* const place = blocks_[block_].get() + used_;
    std::memcpy(place, zone.bytes, bytes);
    used_ += rounded;
    bytes_ += rounded;
    // Another thread has read what was here in the last batch: asks early for what is going to be written next.
    for (std::size_t n = 0; n < rounded && used_ + n < block_bytes; n += 64)
      __builtin_prefetch(blocks_[block_].get() + used_ + n, 1);
    __builtin_prefetch(reinterpret_cast<const std::byte*>(slots_.data() + slots_.size()) + 128, 1);
    __builtin_prefetch(reinterpret_cast<const std::byte*>(found.data() + found.size()) + 128, 1);
    return {place};
  }
  std::uint32_t keep(const std::int32_t* slots, std::size_t count) {
    const std::size_t first = slots_.size();
    slots_.insert(slots_.end(), slots, slots + count);
    return static_cast<std::uint32_t>(first);
  }
  std::uint32_t keep(const std::vector<std::uint64_t>& key) {
    const std::size_t first = keys_.size();
    keys_.insert(keys_.end(), key.begin(), key.end());
    return static_cast<std::uint32_t>(first);
  }
  std::int32_t* slots(std::uint32_t first) { return slots_.data() + first; }
  const std::uint64_t* key(std::uint32_t first) const { return keys_.data() + first; }
  std::size_t bytes() const { return bytes_ + slots_.size() * sizeof(std::int32_t); }

  std::vector<Found> found;
  std::vector<std::vector<std::uint32_t>> shares;  // of each share of the stored states, which were found
  std::vector<std::uint32_t> edges;                // that were taken

 private:
  static constexpr std::size_t block_bytes = std::size_t{1} << 16;

  std::vector<AlignedBytes> blocks_;
  std::size_t block_ = 0;
  std::size_t used_ = 0;   // of that block
  std::size_t bytes_ = 0;  // of all
  std::vector<std::int32_t> slots_;
  std::vector<std::uint64_t> keys_;
};

}  // namespace tachk
