// Arrays and hash tables that grow without moving what they hold, or moving little of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace tachk::states {

// Bytes of a block: little beside what a search takes that stores some ten thousand states.
inline constexpr std::size_t small_block = std::size_t{1} << 15;

// Records of a fixed number of bytes, numbered from 0, aligned to 64 bytes per block. Addresses are stable.
class RecordPool {
 public:
  explicit RecordPool(std::size_t record_bytes, std::size_t least_block_bytes = small_block)
      : record_bytes_(record_bytes) {
    while ((std::size_t{1} << shift_) * record_bytes_ < least_block_bytes && shift_ < 20) ++shift_;
  }

  std::uint32_t size() const { return size_; }
  std::size_t bytes() const { return blocks_.size() * block_bytes(); }
  // Where the blocks are, of 2^shift records each.
  const std::byte* const* blocks() const { return addresses_.data(); }
  unsigned shift() const { return shift_; }

  std::byte* operator[](std::uint32_t number) {
    return blocks_[number >> shift_].get() + (number & mask()) * record_bytes_;
  }
  const std::byte* operator[](std::uint32_t number) const {
    return blocks_[number >> shift_].get() + (number & mask()) * record_bytes_;
  }

  std::uint32_t append() {
    if ((size_ & mask()) == 0) {
      blocks_.emplace_back(static_cast<std::byte*>(::operator new(block_bytes(), alignment)));
      addresses_.push_back(blocks_.back().get());
    }
    return size_++;
  }

 private:
  static constexpr std::align_val_t alignment{64};
  struct Free {
    void operator()(std::byte* block) const { ::operator delete(block, alignment); }
  };
  std::uint32_t mask() const { return (std::uint32_t{1} << shift_) - 1; }
  std::size_t block_bytes() const { return record_bytes_ << shift_; }

  std::size_t record_bytes_;
  unsigned shift_ = 4;
  std::uint32_t size_ = 0;
  std::vector<std::unique_ptr<std::byte, Free>> blocks_;
  std::vector<const std::byte*> addresses_;
};

// An open-addressing index from hashes to record numbers; the records themselves live elsewhere. An entry is the upper
// half of the hash and the number, and its place is that half scaled to the table: growing goes through the table in
// order and needs no record. It consists of segments that grow one at a time and by a quarter, so that neither what is
// free nor what is moved takes much memory.
class HashIndex {
 public:
  static constexpr std::uint32_t absent = UINT32_MAX;

  HashIndex() {
    for (Segment& segment : segments_) segment = Segment(least_places);
  }

  std::size_t bytes() const {
    std::size_t places = 0;
    for (const Segment& segment : segments_) places += segment.size;
    return places * sizeof(std::uint64_t);
  }

  // Asks for the memory that `find` will look at first.
  void prefetch(std::uint64_t hash) const {
    const Segment& segment = segments_[hash >> segment_shift];
    __builtin_prefetch(&segment.entries[segment.home(hash)]);
  }

  // The number of the record with this hash for which `equal(number)` is true, or `absent`.
  template <class Equal>
  std::uint32_t find(std::uint64_t hash, Equal equal) const {
    const Segment& segment = segments_[hash >> segment_shift];
    for (std::uint32_t place = segment.home(hash);; place = segment.behind(place)) {
      const std::uint64_t entry = segment.entries[place];
      if (entry == empty) return absent;
      if ((entry ^ hash) >> 32 == 0 && equal(static_cast<std::uint32_t>(entry)))
        return static_cast<std::uint32_t>(entry);
    }
  }

  // Adds a record that `find` has not found.
  void insert(std::uint64_t hash, std::uint32_t number) {
    Segment& segment = segments_[hash >> segment_shift];
    if (4 * (std::uint64_t{segment.used} + 1) > 3 * std::uint64_t{segment.size}) {
      Segment larger(segment.size + segment.size / 4);
      for (std::uint32_t place = 0; place < segment.size; ++place)
        if (segment.entries[place] != empty) larger.put(segment.entries[place]);
      segment = std::move(larger);
    }
    segment.put((hash >> 32 << 32) | number);
  }

  // Removes a record that is in the index. `upper_hash` is the upper half of its hash.
  void erase(std::uint32_t upper_hash, std::uint32_t number) {
    const std::uint64_t gone = std::uint64_t{upper_hash} << 32 | number;
    Segment& segment = segments_[gone >> segment_shift];
    std::uint32_t place = segment.home(gone);
    while (segment.entries[place] != gone) place = segment.behind(place);
    // Those behind it move up as far as the places that are theirs allow, so that `find` meets no gap on its way.
    for (std::uint32_t next = segment.behind(place); segment.entries[next] != empty; next = segment.behind(next)) {
      const std::uint32_t home = segment.home(segment.entries[next]);
      if (segment.distance(home, next) < segment.distance(place, next)) continue;
      segment.entries[place] = segment.entries[next];
      place = next;
    }
    segment.entries[place] = empty;
    --segment.used;
  }

 private:
  static constexpr std::uint64_t empty = UINT64_MAX;
  static constexpr unsigned segment_bits = 6;
  static constexpr unsigned segment_shift = 64 - segment_bits;
  static constexpr std::uint32_t least_places = 16;

  struct Segment {
    std::unique_ptr<std::uint64_t[]> entries;
    std::uint32_t size = 0;
    std::uint32_t used = 0;

    Segment() = default;
    explicit Segment(std::uint32_t places) : entries(new std::uint64_t[places]), size(places) {
      std::fill_n(entries.get(), places, empty);
    }
    // Where an entry with this upper half belongs: in the order of the halves.
    std::uint32_t home(std::uint64_t entry) const {
      const auto rest = static_cast<std::uint32_t>(entry >> 32 << segment_bits);
      return static_cast<std::uint32_t>(std::uint64_t{rest} * size >> 32);
    }
    std::uint32_t behind(std::uint32_t place) const { return place + 1 == size ? 0 : place + 1; }
    std::uint32_t distance(std::uint32_t from, std::uint32_t to) const {
      return to >= from ? to - from : to + size - from;
    }
    void put(std::uint64_t entry) {
      std::uint32_t place = home(entry);
      while (entries[place] != empty) place = behind(place);
      entries[place] = entry;
      ++used;
    }
  };

  std::array<Segment, std::size_t{1} << segment_bits> segments_;
};

}  // namespace tachk::states
