#include "symbolic/representative.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace tachk::symbolic {

using program::Interchangeable;
using zones::ZoneBuffer;

namespace {

constexpr std::int64_t nowhere = std::int64_t{1} << 40;  // behind all places
constexpr std::int64_t itself = -nowhere;

void rotate(std::vector<std::uint32_t>& places, std::size_t by) {
  for (std::size_t place = 0; place < places.size(); ++place)
    places[place] = static_cast<std::uint32_t>((place + by) % places.size());
}

}  // namespace

Arrangement inverse(const Arrangement& arrangement) {
  Arrangement result = arrangement;
  for (std::size_t group = 0; group < arrangement.size(); ++group)
    for (std::uint32_t place = 0; place < arrangement[group].size(); ++place)
      result[group][arrangement[group][place]] = place;
  return result;
}

Arrangement composed(const Arrangement& first, const Arrangement& second) {
  Arrangement result = second;
  for (std::size_t group = 0; group < second.size(); ++group)
    for (std::uint32_t& place : result[group]) place = first[group][place];
  return result;
}

Representatives::Representatives(const program::Program& program, const zones::ZoneOperations& operations)
    : dimension_(program.dimension()),
      operations_(operations),
      active_(!program.interchangeable.empty()),
      rows_(static_cast<std::size_t>(dimension_)),
      columns_(static_cast<std::size_t>(dimension_)),
      slots_(program.state_slots),
      scratch_(operations) {
  for (const Interchangeable& parts : program.interchangeable) {
    Group& group = groups_.emplace_back(Group{parts, {}, {}, {}, MemberNames(parts), {}});
    if (parts.cyclic)
      group.turns.emplace(parts);
    else
      sums_count_ = true;
    group.names_own.resize(parts.slots.front().size());
    group.own_tables.resize(parts.slots.front().size());
    for (const Interchangeable::Name& name : parts.names) {
      bool own = false;
      for (const std::vector<std::uint32_t>& slots : parts.slots)
        for (std::size_t role = 0; role < slots.size(); ++role)
          if (slots[role] == name.slot) {
            own = group.names_own[role] = true;
            group.own_tables[role] = name.table;
          }
      if (!own) group.shared.push_back(name);
    }
    std::vector<std::uint32_t>& places = identity_.emplace_back(parts.slots.size());
    std::iota(places.begin(), places.end(), 0);
  }
  arrangement_ = identity_;
}

// For each member its location and what it holds, who names it first, whom it names, and where its clocks stand.
void Representatives::describe(const Group& group, const std::int32_t* slots) {
  const std::size_t members = group.parts.slots.size();
  const std::size_t roles = group.parts.slots.front().size();
  const std::size_t clocks = group.parts.clocks.front().size();
  width_ = roles + 1 + 2 * clocks;
  facts_.assign(members * width_, nowhere);
  for (std::size_t member = 0; member < members; ++member) {
    std::int64_t* facts = facts_.data() + member * width_;
    std::size_t named = roles;
    std::size_t fact = 0;
    for (std::size_t role = 0; role < roles; ++role) {
      const std::int32_t value = slots[group.parts.slots[member][role]];
      if (!group.names_own[role]) {
        facts[fact++] = value;
        continue;
      }
      const std::int32_t other = group.known.member(group.own_tables[role], value);
      facts[named--] = other < 0 ? value : other == static_cast<std::int32_t>(member) ? itself : nowhere;
    }
    // `named` is now where the first place that names the member comes: behind all that is plain.
    facts[named] = nowhere;
    for (std::size_t clock = 0; clock < clocks; ++clock) {
      const std::uint16_t number = group.parts.clocks[member][clock];
      facts[roles + 1 + 2 * clock] = rows_[number];
      facts[roles + 2 + 2 * clock] = columns_[number];
    }
  }
  const std::size_t first = static_cast<std::size_t>(std::count(group.names_own.begin(), group.names_own.end(), false));
  for (std::size_t place = group.shared.size(); place-- > 0;) {
    const std::int32_t member = group.known.member(group.shared[place].table, slots[group.shared[place].slot]);
    if (member >= 0) facts_[static_cast<std::size_t>(member) * width_ + first] = static_cast<std::int64_t>(place);
  }
}

// Finds the order of a group as described.
void Representatives::order(std::size_t group) {
  const std::int64_t* facts = facts_.data();
  const std::size_t width = width_;
  const auto precedes = [facts, width](std::uint32_t one, std::uint32_t other) {
    const std::int64_t* left = facts + one * width;
    const std::int64_t* right = facts + other * width;
    return std::lexicographical_compare(left, left + width, right, right + width);
  };
  std::vector<std::uint32_t>& places = arrangement_[group];
  std::iota(places.begin(), places.end(), 0);
  if (!std::is_sorted(places.begin(), places.end(), precedes)) std::stable_sort(places.begin(), places.end(), precedes);
}

bool Representatives::sort(std::int32_t* slots, ZoneBuffer& zone) {
  if (sums_count_) operations_.sum_up(zone.get(), dimension_, rows_.data(), columns_.data());
  bool moves = false;
  for (std::size_t group = 0; group < groups_.size(); ++group) {
    if (groups_[group].turns) {
      turn(group, slots, zone);
    } else {
      describe(groups_[group], slots);
      order(group);
    }
    if (arrangement_[group] == identity_[group]) continue;
    move_slots(groups_[group], arrangement_[group], slots);
    moves = true;
  }
  if (moves) move_clocks(arrangement_, zone);
  return moves;
}

// Of the rotations that make the slots least, the one that also makes the zone least.
void Representatives::turn(std::size_t group, const std::int32_t* slots, ZoneBuffer& zone) {
  Arrangement alone = identity_;
  std::vector<std::uint32_t>& places = alone[group];
  const std::vector<std::size_t>& least = groups_[group].turns->least(slots);
  rotate(places, least.front());
  arrangement_[group] = places;
  if (least.size() == 1) return;
  ZoneBuffer best(operations_);
  for (std::size_t candidate = 0; candidate < least.size(); ++candidate) {
    rotate(places, least[candidate]);
    rename_clocks(alone, zone.get());
    if (candidate != 0 && std::memcmp(scratch_.get().bytes, best.get().bytes, operations_.bytes) >= 0) continue;
    std::swap(best, scratch_);
    arrangement_[group] = places;
  }
}

void Representatives::arrange(const Arrangement& arrangement, std::int32_t* slots, ZoneBuffer& zone) {
  arrange(arrangement, slots);
  move_clocks(arrangement, zone);
}

void Representatives::arrange(const Arrangement& arrangement, std::int32_t* slots) {
  for (std::size_t group = 0; group < groups_.size(); ++group) move_slots(groups_[group], arrangement[group], slots);
}

std::vector<Arrangement> Representatives::generators() const {
  std::vector<Arrangement> found;
  for (std::size_t group = 0; group < groups_.size(); ++group) {
    const std::size_t members = identity_[group].size();
    for (std::size_t member = 0; member + 1 < members; ++member) {
      Arrangement& each = found.emplace_back(identity_);
      if (groups_[group].turns)
        rotate(each[group], 1);
      else
        std::swap(each[group][member], each[group][member + 1]);
      if (groups_[group].turns) break;
    }
  }
  return found;
}

std::vector<std::uint32_t> Representatives::slot_sources(const Arrangement& arrangement) const {
  std::vector<std::uint32_t> sources(slots_);
  std::iota(sources.begin(), sources.end(), 0U);
  for (std::size_t group = 0; group < groups_.size(); ++group) {
    const std::vector<std::vector<std::uint32_t>>& slots = groups_[group].parts.slots;
    for (std::size_t place = 0; place < slots.size(); ++place)
      for (std::size_t role = 0; role < slots[place].size(); ++role)
        sources[slots[place][role]] = slots[arrangement[group][place]][role];
  }
  return sources;
}

std::vector<std::uint16_t> Representatives::clock_sources(const Arrangement& arrangement) const {
  std::vector<std::uint16_t> sources(static_cast<std::size_t>(dimension_));
  std::iota(sources.begin(), sources.end(), std::uint16_t{0});
  for (std::size_t group = 0; group < groups_.size(); ++group) {
    const std::vector<std::vector<std::uint16_t>>& clocks = groups_[group].parts.clocks;
    for (std::size_t place = 0; place < clocks.size(); ++place)
      for (std::size_t clock = 0; clock < clocks[place].size(); ++clock)
        sources[clocks[place][clock]] = clocks[arrangement[group][place]][clock];
  }
  return sources;
}

void Representatives::move_slots(const Group& group, const std::vector<std::uint32_t>& from, std::int32_t* slots) {
  const std::size_t members = from.size();
  moved_.resize(members);
  for (std::size_t role = 0; role < group.names_own.size(); ++role) {
    for (std::size_t place = 0; place < members; ++place) moved_[place] = slots[group.parts.slots[from[place]][role]];
    for (std::size_t place = 0; place < members; ++place) slots[group.parts.slots[place][role]] = moved_[place];
  }
  places_.resize(members);
  for (std::uint32_t place = 0; place < members; ++place) places_[from[place]] = place;
  for (const Interchangeable::Name& name : group.parts.names) {
    const std::int32_t member = group.known.member(name.table, slots[name.slot]);
    if (member >= 0) slots[name.slot] = group.parts.tables[name.table][places_[static_cast<std::size_t>(member)]];
  }
}

void Representatives::move_clocks(const Arrangement& arrangement, ZoneBuffer& zone) {
  rename_clocks(arrangement, zone.get());
  std::swap(scratch_, zone);
}

void Representatives::rename_clocks(const Arrangement& arrangement, zones::ConstZoneRef zone) {
  operations_.rename(scratch_.get(), zone, dimension_, clock_sources(arrangement).data());
}

}  // namespace tachk::symbolic
