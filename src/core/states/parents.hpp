// The parents of nodes, by number. Neighbours have parents close to each other where states are explored in the order
// in which they came: of each 64 nodes the least parent is kept, and of each node how far it is from that, in as many
// bits as the furthest one needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "states/memory.hpp"

namespace tachk::states {

class Parents {
 public:
  // The parent of the next node; UINT32_MAX if it has none.
  void append(std::uint32_t parent) {
    last_[size_++ % group_size] = parent + 1;
    if (size_ % group_size == 0) pack();
  }
  std::uint32_t operator[](std::uint32_t node) const;

  std::size_t bytes() const { return groups_.bytes() + words_.bytes(); }

 private:
  static constexpr std::uint32_t group_size = 64;  // nodes; as many words of 64 bits as each has bits

  struct Group {
    std::uint32_t least;
    std::uint32_t first_word;
  };

  void pack();
  const Group& group(std::uint32_t number) const { return *reinterpret_cast<const Group*>(groups_[number]); }
  std::uint64_t word(std::uint32_t number) const { return *reinterpret_cast<const std::uint64_t*>(words_[number]); }

  // Numbers larger by one than those of the parents, so that none is 0.
  std::array<std::uint32_t, group_size> last_;  // of the nodes behind the last full group
  RecordPool groups_{sizeof(Group)};
  RecordPool words_{sizeof(std::uint64_t)};
  std::uint32_t size_ = 0;
};

}  // namespace tachk::states
