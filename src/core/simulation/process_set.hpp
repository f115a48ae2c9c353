// Sets of processes that are small where there are few processes, and gone through in the order of their numbers.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tachk::simulation {

class ProcessSet {
 public:
  explicit ProcessSet(std::size_t processes) : words_((processes + 63) / 64) {}

  void add(std::size_t process) { words_[process / 64] |= bit(process); }
  void remove(std::size_t process) { words_[process / 64] &= ~bit(process); }
  void add(const ProcessSet& other) {
    for (std::size_t word = 0; word < words_.size(); ++word) words_[word] |= other.words_[word];
  }
  void clear() { words_.assign(words_.size(), 0); }

  // Calls visit(process) for each. What is removed or added meanwhile may be visited or not, but for the one at hand.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t word = 0; word < words_.size(); ++word)
      for (std::uint64_t left = words_[word]; left != 0; left &= left - 1)
        visit(word * 64 + static_cast<std::size_t>(std::countr_zero(left)));
  }

 private:
  static std::uint64_t bit(std::size_t process) { return std::uint64_t{1} << (process % 64); }

  std::vector<std::uint64_t> words_;
};

}  // namespace tachk::simulation
