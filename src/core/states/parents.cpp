#include "states/parents.hpp"

#include <algorithm>
#include <bit>

namespace tachk::states {

void Parents::pack() {
  const auto [least, most] = std::minmax_element(last_.begin(), last_.end());
  const auto bits = static_cast<unsigned>(std::bit_width(*most - *least));
  *reinterpret_cast<Group*>(groups_[groups_.append()]) = {*least, words_.size()};
  std::uint64_t packed = 0;
  unsigned used = 0;  // bits of it
  for (const std::uint32_t number : last_) {
    const std::uint64_t value = number - *least;
    packed |= value << used;
    used += bits;
    if (used < 64) continue;
    *reinterpret_cast<std::uint64_t*>(words_[words_.append()]) = packed;
    used -= 64;
    packed = used == 0 ? 0 : value >> (bits - used);
  }
}

std::uint32_t Parents::operator[](std::uint32_t node) const {
  const std::uint32_t number = node / group_size;
  const std::uint32_t place = node % group_size;
  if (number == groups_.size()) return last_[place] - 1;
  const auto [least, first] = group(number);
  const std::uint32_t bits = (number + 1 < groups_.size() ? group(number + 1).first_word : words_.size()) - first;
  if (bits == 0) return least - 1;
  const std::uint32_t at = first + place * bits / 64;
  const std::uint32_t shift = place * bits % 64;
  std::uint64_t value = word(at) >> shift;
  if (shift + bits > 64) value |= word(at + 1) << (64 - shift);
  return least + static_cast<std::uint32_t>(value & ((std::uint64_t{1} << bits) - 1)) - 1;
}

}  // namespace tachk::states
