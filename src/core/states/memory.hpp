// Arrays and hash tables that grow without moving what they hold, or moving little of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

namespace tachk {

// Records of a fixed number of bytes, numbered from 0, aligned to 64 bytes per block. Addresses are stable.
class RecordPool {
 public:
  explicit RecordPool(std::size_t record_bytes, std::size_t least_block_bytes = std::size_t{1} << 18)
      : record_bytes_(record_bytes) {
    while ((std::size_t{1} << shift_) * record_bytes_ < least_block_bytes && shift_ < 20) ++shift_;
  }

  std::uint32_t size() const { return size_; }
  std::size_t bytes() const { return blocks_.size() * block_bytes(); }

  std::byte* operator[](std::uint32_t number) {
    return blocks_[number >> shift_].get() + (number & mask()) * record_bytes_;
  }
  const std::byte* operator[](std::uint32_t number) const {
    return blocks_[number >> shift_].get() + (number & mask()) * record_bytes_;
  }

  std::uint32_t append() {
    if ((size_ & mask()) == 0) {
      const std::size_t rounded = (block_bytes() + 63) / 64 * 64;
      void* block = std::aligned_alloc(64, rounded == 0 ? 64 : rounded);
      if (block == nullptr) throw std::bad_alloc();
      blocks_.emplace_back(static_cast<std::byte*>(block));
    }
    return size_++;
  }

 private:
  struct Free {
    void operator()(std::byte* block) const { std::free(block); }
  };
  std::uint32_t mask() const { return (std::uint32_t{1} << shift_) - 1; }
  std::size_t block_bytes() const { return record_bytes_ << shift_; }

  std::size_t record_bytes_;
  unsigned shift_ = 4;
  std::uint32_t size_ = 0;
  std::vector<std::unique_ptr<std::byte, Free>> blocks_;
};

// An open-addressing index from hashes to record numbers; the records themselves live elsewhere. An entry is the upper
// half of the hash and the number, and its place is that half scaled to the table: growing goes through the table in
// order and needs no record.
class HashIndex {
 public:
  static constexpr std::uint32_t absent = UINT32_MAX;

  HashIndex() : entries_(std::size_t{1} << bits_, empty) {}

  std::size_t bytes() const { return entries_.size() * sizeof(std::uint64_t); }

  // Asks for the memory that `find` will look at first.
  void prefetch(std::uint64_t hash) const { __builtin_prefetch(&entries_[hash >> (64 - bits_)]); }

  // The number of the record with this hash for which `equal(number)` is true, or `absent`.
  template <class Equal>
  std::uint32_t find(std::uint64_t hash, Equal equal) const {
    for (std::size_t place = hash >> (64 - bits_);; place = (place + 1) & (entries_.size() - 1)) {
      const std::uint64_t entry = entries_[place];
      if (entry == empty) return absent;
      if ((entry ^ hash) >> 32 == 0 && equal(static_cast<std::uint32_t>(entry)))
        return static_cast<std::uint32_t>(entry);
    }
  }

  // Adds a record that `find` has not found.
  void insert(std::uint64_t hash, std::uint32_t number) {
    if (3 * (used_ + 1) > 2 * entries_.size()) {
      ++bits_;
      std::vector<std::uint64_t> old(std::size_t{1} << bits_, empty);
      old.swap(entries_);
      for (const std::uint64_t entry : old)
        if (entry != empty) put(entry);
    }
    put((hash >> 32 << 32) | number);
    ++used_;
  }

  // Removes a record that is in the index. `upper_hash` is the upper half of its hash.
  void erase(std::uint32_t upper_hash, std::uint32_t number) {
    const std::size_t mask = entries_.size() - 1;
    const std::uint64_t gone = std::uint64_t{upper_hash} << 32 | number;
    std::size_t place = gone >> (64 - bits_);
    while (entries_[place] != gone) place = (place + 1) & mask;
    // Those behind it move up as far as the places that are theirs allow, so that `find` meets no gap on its way.
    for (std::size_t next = (place + 1) & mask; entries_[next] != empty; next = (next + 1) & mask) {
      const std::size_t home = entries_[next] >> (64 - bits_);
      if (((next - home) & mask) < ((next - place) & mask)) continue;
      entries_[place] = entries_[next];
      place = next;
    }
    entries_[place] = empty;
    --used_;
  }

 private:
  static constexpr std::uint64_t empty = UINT64_MAX;

  void put(std::uint64_t entry) {
    std::size_t place = entry >> (64 - bits_);
    while (entries_[place] != empty) place = (place + 1) & (entries_.size() - 1);
    entries_[place] = entry;
  }

  unsigned bits_ = 10;
  std::vector<std::uint64_t> entries_;
  std::size_t used_ = 0;
};

}  // namespace tachk
