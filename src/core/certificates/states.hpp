// The discrete states of a certificate, each once, found by their content.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <unordered_map>
#include <vector>

#include "program/program.hpp"

namespace tachk::certificates {

class States {
 public:
  static constexpr std::uint32_t none = UINT32_MAX;

  explicit States(const Program& program) {
    for (std::uint32_t slot = 0; slot < program.state_slots; ++slot) {
      const auto low = static_cast<std::uint32_t>(program.slots[slot].low);
      const std::uint32_t width = static_cast<std::uint32_t>(program.slots[slot].high) - low;
      if (width > 0) (width < 256 ? narrow_ : wide_).push_back({slot, low});
    }
    room_.resize(1 + narrow_.size() + 4 * wide_.size());
  }

  std::size_t size() const { return packed_.size(); }

  // The number of a state, or none; of each there may be two, a ranked one and another.
  std::uint32_t find(const std::int32_t* slots, bool ranked) const {
    pack(slots, ranked);
    const auto found = numbers_.find(room_);
    return found == numbers_.end() ? none : found->second;
  }
  // Adds a state, whose number is the size before; false if it is there already.
  bool add(const std::int32_t* slots, bool ranked) {
    pack(slots, ranked);
    const auto [entry, fresh] = numbers_.emplace(room_, static_cast<std::uint32_t>(size()));
    if (fresh) packed_.push_back(&entry->first);
    return fresh;
  }
  // Writes the slots of a state, but not those that have always the same value.
  void read(std::size_t number, std::int32_t* slots) const {
    const char* bytes = packed_[number]->data() + 1;
    for (const Place& place : narrow_)
      slots[place.slot] = static_cast<std::int32_t>(place.low + static_cast<unsigned char>(*bytes++));
    for (const Place& place : wide_) {
      std::memcpy(slots + place.slot, bytes, 4);
      bytes += 4;
    }
  }

 private:
  struct Place {
    std::uint32_t slot;
    std::uint32_t low;
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

  std::vector<Place> narrow_, wide_;  // slots in a byte, and in four; those that can change at all
  mutable std::string room_;          // a state to be found or added
  std::unordered_map<std::string, std::uint32_t> numbers_;
  std::vector<const std::string*> packed_;  // of each number
};

}  // namespace tachk::certificates
