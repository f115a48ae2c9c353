// Symbolic states with the members of groups in other places. A set that holds states up to permutations covers what
// permutations lead into it. Which permutations are tried is a guess: members are sorted by what is known of them, as
// the search for certificates does; those of a cyclic orbit come to every place. All that are tried are sound, because
// each one maps the program onto itself, which the caller must have proved of its groups.
// tachk.meaning.judge.arrangements is the same in Python.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "certificates/zones.hpp"
#include "program/program.hpp"

namespace tachk::certificates {

class Arrangements final {
 public:
  using Slots = std::vector<std::int32_t>;

  explicit Arrangements(const std::vector<program::Interchangeable>& groups) : groups_(groups) {
    for (const program::Interchangeable& group : groups) {
      if (!group.cyclic) ways_ = 2;
      Tables& own = tables_.emplace_back(group.slots.front().size());
      for (const program::Interchangeable::Name& name : group.names)
        for (std::size_t role = 0; role < own.size(); ++role)
          if (group.slots.front()[role] == name.slot) own[role].push_back(name.table);
    }
  }

  // True if `covers(slots, zone)` is true of some arrangement of a symbolic state.
  template <class Covers>
  bool some(Slots slots, Zone zone, Covers&& covers) const {
    std::vector<std::size_t> turns(groups_.size(), 0);
    while (true) {
      for (int way = 0; way < ways_; ++way) {
        for (std::size_t group = 0; group < groups_.size(); ++group)
          if (!groups_[group].cyclic) place(groups_[group], sorted(group, slots, zone, way == 1), slots, zone);
        if (covers(slots, zone)) return true;
      }
      bool turned = false;
      for (std::size_t group = 0; group < groups_.size() && !turned; ++group) {
        if (!groups_[group].cyclic) continue;
        place(groups_[group], moved_on(groups_[group].slots.size()), slots, zone);
        turns[group] = (turns[group] + 1) % groups_[group].slots.size();
        turned = turns[group] > 0;
      }
      if (!turned) return false;
    }
  }
  bool none() const { return groups_.empty(); }

 private:
  using Order = std::vector<std::size_t>;  // which member comes to each place
  using Facts = std::vector<std::int64_t>;
  using Tables = std::vector<std::vector<std::uint32_t>>;  // of the slots of a member, those of which they hold names

  static Order moved_on(std::size_t members) {
    Order order(members);
    for (std::size_t place = 0; place < members; ++place) order[place] = (place + members - 1) % members;
    return order;
  }

  static void place(const program::Interchangeable& group, const Order& order, Slots& slots, Zone& zone) {
    const Slots before = slots;
    std::vector<std::size_t> source(zone.n);
    std::iota(source.begin(), source.end(), std::size_t{0});
    for (std::size_t place = 0; place < order.size(); ++place) {
      for (std::size_t role = 0; role < group.slots[place].size(); ++role)
        slots[group.slots[place][role]] = before[group.slots[order[place]][role]];
      for (std::size_t role = 0; role < group.clocks[place].size(); ++role)
        source[group.clocks[place][role]] = group.clocks[order[place]][role];
    }
    for (const program::Interchangeable::Name& name : group.names) {
      const std::vector<std::int32_t>& table = group.tables[name.table];
      const auto named =
          static_cast<std::size_t>(std::find(table.begin(), table.end(), slots[name.slot]) - table.begin());
      if (named == table.size()) continue;
      const auto comes = std::find(order.begin(), order.end(), named) - order.begin();
      slots[name.slot] = table[static_cast<std::size_t>(comes)];
    }
    Zone moved = zone;
    for (std::size_t i = 0; i < zone.n; ++i)
      for (std::size_t j = 0; j < zone.n; ++j) moved.at(i, j) = zone.at(source[i], source[j]);
    zone = std::move(moved);
  }

  static constexpr std::int64_t behind = std::int64_t{1} << 40;  // larger than all numbers in states

  Order sorted(std::size_t number, const Slots& slots, const Zone& zone, bool columns_first) const {
    const program::Interchangeable& group = groups_[number];
    std::vector<Facts> facts(group.slots.size());
    for (std::size_t member = 0; member < facts.size(); ++member) facts[member] = plain(number, member, slots);
    for (std::size_t member = 0; member < facts.size(); ++member) {
      facts[member].push_back(first_named(group, member, slots));
      add_names(number, member, slots, facts[member]);
      for (const std::uint16_t clock : group.clocks[member]) add_sums(zone, clock, columns_first, facts[member]);
    }
    Order order(facts.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t one, std::size_t other) { return facts[one] < facts[other]; });
    return order;
  }
  Facts plain(std::size_t number, std::size_t member, const Slots& slots) const {
    Facts facts;
    const auto& own = groups_[number].slots[member];
    for (std::size_t role = 0; role < own.size(); ++role)
      if (tables_[number][role].empty()) facts.push_back(slots[own[role]]);
    return facts;
  }
  // Which slot outside of the members names one first.
  static std::int64_t first_named(const program::Interchangeable& group, std::size_t member, const Slots& slots) {
    std::int64_t place = 0;
    for (const program::Interchangeable::Name& name : group.names) {
      const auto holds = [&](const auto& own) { return std::find(own.begin(), own.end(), name.slot) != own.end(); };
      if (std::any_of(group.slots.begin(), group.slots.end(), holds)) continue;
      if (slots[name.slot] == group.tables[name.table][member]) return place;
      ++place;
    }
    return behind;
  }
  // The member that a member names: itself, another one, or none.
  void add_names(std::size_t number, std::size_t member, const Slots& slots, Facts& facts) const {
    const program::Interchangeable& group = groups_[number];
    for (std::size_t role = tables_[number].size(); role-- > 0;) {
      if (tables_[number][role].empty()) continue;
      std::int64_t held = slots[group.slots[member][role]];
      for (const std::uint32_t table : tables_[number][role]) {
        const auto& names = group.tables[table];
        const auto named = std::find(names.begin(), names.end(), slots[group.slots[member][role]]) - names.begin();
        if (named < static_cast<std::ptrdiff_t>(names.size()))
          held = named == static_cast<std::ptrdiff_t>(member) ? -behind : behind;
      }
      facts.push_back(held);
    }
  }
  // The sums of the bounds of a clock against the others, and of the others against it: either may come first, for an
  // abstraction may leave a difference in one of them only.
  static void add_sums(const Zone& zone, std::size_t clock, bool columns_first, Facts& facts) {
    std::int64_t row = 0, column = 0;
    for (std::size_t other = 0; other < zone.n; ++other) {
      row += std::clamp(zone.at(clock, other), -behind, behind);
      column += std::clamp(zone.at(other, clock), -behind, behind);
    }
    facts.push_back(columns_first ? column : row);
    facts.push_back(columns_first ? row : column);
  }

  const std::vector<program::Interchangeable>& groups_;
  int ways_ = 1;  // in which members are sorted
  std::vector<Tables> tables_;
};

}  // namespace tachk::certificates
