#include "states/antichain.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace tachk::states {

using zones::Extent;

namespace {

constexpr std::size_t largest_leaf = 64;
constexpr std::size_t growth = 4;  // so much room for entries is added at a time

int widest_component(const Extent& least, const Extent& most) {
  int widest = 0;
  for (int k = 1; k < Extent::count; ++k)
    if (most.sums[k] - least.sums[k] > most.sums[widest] - least.sums[widest]) widest = k;
  return widest;
}

template <class Entry>
void append_to(std::vector<Entry>& entries, Entry entry) {
  if (entries.size() == entries.capacity()) entries.reserve(entries.size() + growth);
  entries.push_back(std::move(entry));
}

}  // namespace

Antichain::Antichain() : root_{{}, {}, std::make_unique<Group>()}, bytes_(root_.group->bytes()) {}

void Antichain::add(const Extent& extent, std::uint32_t number, std::uint32_t first_waiting,
                    const ExtentOf& extent_of) {
  ++size_;
  if (number >= first_waiting) {
    if (waiting_.size() == waiting_.capacity())
      waiting_.erase(waiting_.begin(), std::lower_bound(waiting_.begin(), waiting_.end(), first_waiting));
    waiting_.push_back(number);
  }
  if (root_.group->empty()) {
    root_.least = root_.most = extent;
    root_.group->grid = ExtentGrid(extent, extent);
  }
  std::optional<Part> half = add_to(root_, extent, number, extent_of);
  if (!half) return;
  auto top = std::make_unique<Group>();
  top->parts.push_back(std::exchange(root_, {{}, {}, nullptr}));
  top->parts.push_back(std::move(*half));
  bytes_ += top->bytes();
  root_.group = std::move(top);
  fit(root_);
}

void Antichain::measure_anew(const ExtentOf& extent_of) {
  Antichain fresh;
  for_each([&](std::uint32_t number) { fresh.add(extent_of(number), number, UINT32_MAX, extent_of); });
  fresh.waiting_ = std::move(waiting_);
  *this = std::move(fresh);
}

std::optional<Antichain::Part> Antichain::add_to(Part& part, const Extent& extent, std::uint32_t number,
                                                 const ExtentOf& extent_of) {
  Group& group = *part.group;
  const bool widens = !part.most.may_include(extent) || !extent.may_include(part.least);
  if (widens) {
    part.least.lower_to(extent);
    part.most.raise_to(extent);
  }
  Part* best = nullptr;
  std::uint32_t least_widening = UINT32_MAX;
  for (Part& inner : group.parts) {
    const std::uint32_t widening = extent.distance(inner.least, inner.most);
    if (widening >= least_widening) continue;
    best = &inner;
    least_widening = widening;
  }
  std::optional<Part> half;
  if (best != nullptr && !(half = add_to(*best, extent, number, extent_of))) return std::nullopt;
  bytes_ -= group.bytes();
  if (half)
    append_to(group.parts, std::move(*half));
  else
    append_member(part, extent, number, widens);
  half = divided(part, extent_of);
  bytes_ += group.bytes();
  return half;
}

void Antichain::append_member(Part& leaf, const Extent& extent, std::uint32_t number, bool widens) {
  Group& group = *leaf.group;
  if (widens && !group.grid.spans(leaf.least, leaf.most)) {
    const ExtentGrid wider(leaf.least, leaf.most, group.grid);
    if (!group.members.empty()) {
      const ExtentGrid::Change change(group.grid, wider);
      for (Member& member : group.members) member.code = change(member.code);
    }
    group.grid = wider;
  }
  append_to(group.members, Member{group.grid.code(extent), number});
}

std::optional<Antichain::Part> Antichain::divided(Part& part, const ExtentOf& extent_of) {
  Group& group = *part.group;
  if (group.members.size() < largest_leaf && group.parts.size() < most_parts) return std::nullopt;
  const int k = widest_component(part.least, part.most);
  Part half{{}, {}, std::make_unique<Group>()};
  half.group->grid = group.grid;
  give_off(group.members, half.group->members, [k](const Member& member) { return int{member.code.sums[k]}; });
  give_off(group.parts, half.group->parts, [k](const Part& inner) { return inner.least.sums[k] + inner.most.sums[k]; });
  for (Part* each : {&part, &half}) {
    fit(*each);
    if (each->group->parts.empty()) refine(*each, extent_of);
  }
  bytes_ += half.group->bytes();
  return half;
}

template <class Entry, class Place>
void Antichain::give_off(std::vector<Entry>& entries, std::vector<Entry>& half, Place place) {
  const auto middle = entries.begin() + static_cast<std::ptrdiff_t>(entries.size() / 2);
  std::nth_element(entries.begin(), middle, entries.end(),
                   [&](const Entry& a, const Entry& b) { return place(a) < place(b); });
  half.assign(std::move_iterator(middle), std::move_iterator(entries.end()));
  entries.erase(middle, entries.end());
  entries.shrink_to_fit();
}

void Antichain::refine(Part& leaf, const ExtentOf& extent_of) {
  Group& group = *leaf.group;
  if (!ExtentGrid(leaf.least, leaf.most).is_finer_than(group.grid)) return;
  std::vector<Extent> extents;
  for (const Member& member : group.members) extents.push_back(extent_of(member.number));
  leaf.least = leaf.most = extents.front();
  for (const Extent& extent : extents) {
    leaf.least.lower_to(extent);
    leaf.most.raise_to(extent);
  }
  group.grid = ExtentGrid(leaf.least, leaf.most);
  for (std::size_t n = 0; n < extents.size(); ++n) group.members[n].code = group.grid.code(extents[n]);
}

void Antichain::fit(Part& part) {
  const Group& group = *part.group;
  if (!group.parts.empty()) {
    part.least = group.parts.front().least;
    part.most = group.parts.front().most;
    for (const Part& inner : group.parts) {
      part.least.lower_to(inner.least);
      part.most.raise_to(inner.most);
    }
  } else if (!group.members.empty()) {
    ExtentCode least = group.members.front().code;
    ExtentCode most = least;
    for (const Member& member : group.members) {
      least.lower_to(member.code);
      most.raise_to(member.code);
    }
    part.least = group.grid.least(least);
    part.most = group.grid.most(most);
  }
}

void Antichain::lower_root() {
  bytes_ -= root_.group->bytes();
  Part only = std::move(root_.group->parts.front());
  root_ = std::move(only);
}

}  // namespace tachk::states
