// A long antichain of zones, found by their extents in a tree of groups (A. Guttman, "R-trees: a dynamic index
// structure for spatial searching", SIGMOD 1984). A group whose extremes show that none of its members is in question
// is skipped. The tree knows the zones by number; they live elsewhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "states/extent_grid.hpp"
#include "zones/extent.hpp"

namespace tachk::states {

class Antichain {
 public:
  using ExtentOf = std::function<zones::Extent(std::uint32_t)>;

  Antichain();

  // The numbers of members rise. Those that are `first_waiting` or larger are remembered as waiting. `extent_of` gives
  // the extents of other members, which are known roughly only.
  void add(const zones::Extent& extent, std::uint32_t number, std::uint32_t first_waiting, const ExtentOf& extent_of);

  // Visits the members that wait, with numbers from `first` on, the newest first; and perhaps some that are removed.
  template <class Visit>
  void for_each_waiting(std::uint32_t first, Visit visit) const {
    for (auto number = waiting_.rbegin(); number != waiting_.rend() && *number >= first; ++number) visit(*number);
  }

  // Gives each member a new extent.
  void measure_anew(const ExtentOf& extent_of);

  // True if `accept(number)` is true of a member whose extent may include this one, as far as that is known. Adds to
  // `examined` how many extents it looks at.
  template <class Accept>
  bool any_above(const zones::Extent& extent, Accept accept, std::uint64_t& examined) const {
    return root_.most.may_include(extent) && any_above(root_, extent, accept, examined);
  }

  // Removes the members whose extents this one may include, as far as that is known, and for which `covered(number)` is
  // true.
  template <class Covered>
  void remove_below(const zones::Extent& extent, Covered covered) {
    if (!extent.may_include(root_.least)) return;
    remove_below(root_, extent, covered);
    while (root_.group->parts.size() == 1) lower_root();
  }

  template <class Visit>
  void for_each(Visit visit) const {
    for_each(*root_.group, visit);
  }

  std::size_t bytes() const { return bytes_ + waiting_.capacity() * sizeof(std::uint32_t); }
  std::size_t size() const { return size_; }

 private:
  static constexpr std::size_t most_parts = 128;
  static constexpr std::size_t cache_line = 64;

  struct Group;
  struct Member {
    ExtentCode code;  // in the grid of its group
    std::uint32_t number;
  };
  struct Part {
    zones::Extent least;  // componentwise, of all members
    zones::Extent most;
    std::unique_ptr<Group> group;
  };
  struct Group {
    std::vector<Member> members;  // of a leaf
    std::vector<Part> parts;      // of an inner group
    ExtentGrid grid;

    bool empty() const { return members.empty() && parts.empty(); }
    std::size_t bytes() const {
      return sizeof(Group) + members.capacity() * sizeof(Member) + parts.capacity() * sizeof(Part);
    }
  };

  // Calls visit(part) for each part of a group that is `in_question`, until it is true of one. Groups lie all over the
  // memory: they are fetched while the others are looked at.
  template <class PartOfGroup, class InQuestion, class Visit>
  static bool any_of_parts(std::span<PartOfGroup> parts, InQuestion in_question, Visit visit) {
    PartOfGroup* open[most_parts];
    std::size_t count = 0;
    for (PartOfGroup& inner : parts) {
      if (!in_question(inner)) continue;
      fetch(inner.group.get(), sizeof(Group));
      open[count++] = &inner;
    }
    for (std::size_t n = 0; n < count; ++n) {
      if (n + 1 < count) fetch(open[n + 1]->group->members.data(), 2 * cache_line);
      if (visit(*open[n])) return true;
    }
    return false;
  }

  template <class Accept>
  static bool any_above(const Part& part, const zones::Extent& extent, Accept& accept, std::uint64_t& examined) {
    const Group& group = *part.group;
    examined += group.members.size() + group.parts.size();
    if (group.members.empty())
      return any_of_parts(
          std::span(group.parts), [&](const Part& inner) { return inner.most.may_include(extent); },
          [&](const Part& inner) { return any_above(inner, extent, accept, examined); });
    const ExtentCode code = group.grid.code(extent.nearest(part.least, part.most));
    for (const Member& member : group.members)
      if (member.code.may_include(code) && accept(member.number)) return true;
    return false;
  }

  static void fetch(const void* data, std::size_t bytes) {
    for (std::size_t at = 0; at < bytes; at += cache_line) __builtin_prefetch(static_cast<const char*>(data) + at);
  }

  // True if something was removed.
  template <class Covered>
  bool remove_below(Part& part, const zones::Extent& extent, Covered& covered) {
    Group& group = *part.group;
    std::size_t removed = 0;
    if (!group.members.empty()) {
      const ExtentCode code = group.grid.code(extent.nearest(part.least, part.most));
      removed = std::erase_if(
          group.members, [&](const Member& member) { return code.may_include(member.code) && covered(member.number); });
      size_ -= removed;
    }
    any_of_parts(
        std::span(group.parts), [&](const Part& inner) { return extent.may_include(inner.least); },
        [&](Part& inner) {
          removed += remove_below(inner, extent, covered);
          return false;
        });
    if (removed == 0) return false;
    std::erase_if(group.parts, [&](const Part& inner) {
      if (!inner.group->empty()) return false;
      bytes_ -= inner.group->bytes();
      return true;
    });
    fit(part);
    return true;
  }

  template <class Visit>
  static void for_each(const Group& group, Visit& visit) {
    for (const Member& member : group.members) visit(member.number);
    for (const Part& part : group.parts) for_each(*part.group, visit);
  }

  // Adds a member to a part; a group that is full gives off half of its own as a part of its own.
  std::optional<Part> add_to(Part& part, const zones::Extent& extent, std::uint32_t number, const ExtentOf& extent_of);
  // Adds a member to a leaf, whose bounds it lies within, and `widens` if it has not before.
  static void append_member(Part& leaf, const zones::Extent& extent, std::uint32_t number, bool widens);
  // Divides what is in a group in the middle of its widest component.
  std::optional<Part> divided(Part& part, const ExtentOf& extent_of);
  template <class Entry, class Place>
  static void give_off(std::vector<Entry>& entries, std::vector<Entry>& half, Place place);
  // Gives the members of a leaf a finer grid if there is one.
  static void refine(Part& leaf, const ExtentOf& extent_of);
  // Bounds of what is in a group.
  static void fit(Part& part);
  void lower_root();

  Part root_;
  std::size_t bytes_;
  std::size_t size_ = 0;
  std::vector<std::uint32_t> waiting_;  // in order; some at the front do not wait any more
};

}  // namespace tachk::states
