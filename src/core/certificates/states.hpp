// The discrete states of a certificate, each once, found by their content.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "program/program.hpp"

namespace tachk::certificates {

class States {
 public:
  static constexpr std::uint32_t none = UINT32_MAX;

  explicit States(const Program& program) : table_(1024) {
    for (std::uint32_t slot = 0; slot < program.state_slots; ++slot) {
      const auto low = static_cast<std::uint32_t>(program.slots[slot].low);
      const std::uint32_t width = static_cast<std::uint32_t>(program.slots[slot].high) - low;
      if (width > 0) (width < 256 ? narrow_ : wide_).push_back({slot, low});
    }
    room_.resize(1 + narrow_.size() + 4 * wide_.size());
  }

  std::size_t size() const { return packed_.size() / room_.size(); }

  // The number of a state, or none; of each there may be two, a ranked one and another.
  std::uint32_t find(const std::int32_t* slots, bool ranked) const {
    pack(slots, ranked);
    return table_[place(hash())].number;
  }
  // Adds a state, whose number is the size before; false if it is there already.
  bool add(const std::int32_t* slots, bool ranked) {
    if (2 * size() >= table_.size()) grow();
    pack(slots, ranked);
    Entry& entry = table_[place(hash())];
    if (entry.number != none) return false;
    entry = {hash(), static_cast<std::uint32_t>(size())};
    packed_.insert(packed_.end(), room_.begin(), room_.end());
    return true;
  }
  // Writes the slots of a state, but not those that have always the same value; whether it is ranked.
  bool read(std::size_t number, std::int32_t* slots) const {
    const char* bytes = packed_.data() + number * room_.size();
    const bool ranked = *bytes++ != 0;
    for (const Place& place : narrow_)
      slots[place.slot] = static_cast<std::int32_t>(place.low + static_cast<unsigned char>(*bytes++));
    for (const Place& place : wide_) {
      std::memcpy(slots + place.slot, bytes, 4);
      bytes += 4;
    }
    return ranked;
  }

 private:
  struct Place {
    std::uint32_t slot;
    std::uint32_t low;
  };
  struct Entry {
    std::uint32_t hash = 0;
    std::uint32_t number = none;
  };

  void pack(const std::int32_t* slots, bool ranked) const {
    char* bytes = room_.data();
    *bytes++ = static_cast<char>(ranked);
    for (const Place& place : narrow_)
      *bytes++ = static_cast<char>(static_cast<std::uint32_t>(slots[place.slot]) - place.low);
    for (const Place& place : wide_) {
      std::memcpy(bytes, slots + place.slot, 4);
      bytes += 4;
    }
  }
  std::uint32_t hash() const {
    return static_cast<std::uint32_t>(std::hash<std::string_view>{}({room_.data(), room_.size()}));
  }
  // Where in the table the packed state is, or belongs.
  std::size_t place(std::uint32_t hash) const {
    for (std::size_t at = hash;; ++at) {
      const Entry& entry = table_[at %= table_.size()];
      if (entry.number == none) return at;
      if (entry.hash == hash && !std::memcmp(&packed_[entry.number * room_.size()], room_.data(), room_.size()))
        return at;
    }
  }
  void grow() {
    std::vector<Entry> larger(2 * table_.size());
    for (const Entry& entry : table_)
      if (entry.number != none) {
        std::size_t at = entry.hash % larger.size();
        while (larger[at].number != none) at = (at + 1) % larger.size();
        larger[at] = entry;
      }
    table_ = std::move(larger);
  }

  std::vector<Place> narrow_, wide_;  // slots in a byte, and in four; those that can change at all
  mutable std::vector<char> room_;    // a state to be found or added
  std::vector<char> packed_;
  std::vector<Entry> table_;  // open addressing; at least half of it is empty
};

}  // namespace tachk::certificates
