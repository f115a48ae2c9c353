// Which interchangeable process a number names.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"

namespace tachk::symbolic {

class MemberNames final {
 public:
  explicit MemberNames(const program::Interchangeable& group) {
    for (const std::vector<std::int32_t>& table : group.tables) {
      const auto [least, largest] = std::minmax_element(table.begin(), table.end());
      std::vector<std::int32_t>& member_of = member_of_.emplace_back();
      member_of.assign(static_cast<std::size_t>(*largest - *least) + 1, -1);
      for (std::size_t member = 0; member < table.size(); ++member)
        member_of[static_cast<std::size_t>(table[member] - *least)] = static_cast<std::int32_t>(member);
      least_.push_back(*least);
    }
  }

  // The member that a number names in a table; -1: none.
  std::int32_t member(std::size_t table, std::int32_t number) const {
    const std::int64_t place = std::int64_t{number} - least_[table];
    if (place < 0 || place >= static_cast<std::int64_t>(member_of_[table].size())) return -1;
    return member_of_[table][static_cast<std::size_t>(place)];
  }

 private:
  std::vector<std::int32_t> least_;                   // of each table the smallest number
  std::vector<std::vector<std::int32_t>> member_of_;  // of each table, by number less the smallest one
};

}  // namespace tachk::symbolic
