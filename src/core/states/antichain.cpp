#include "states/antichain.hpp"

#include <iterator>
#include <utility>

namespace tachk::states {

using zones::Extent;

namespace {

constexpr std::size_t group_size = 32;

int widest_component(const Extent& least, const Extent& most) {
  int widest = 0;
  for (int k = 1; k < Extent::count; ++k)
    if (most.sums[k] - least.sums[k] > most.sums[widest] - least.sums[widest]) widest = k;
  return widest;
}

}  // namespace

Antichain::Antichain() : root_{{}, {}, std::make_unique<Group>()}, bytes_(root_.group->bytes()) {}

void Antichain::add(const Extent& extent, std::uint32_t number, std::uint32_t first_waiting) {
  ++size_;
  if (number >= first_waiting) {
    if (waiting_.size() == waiting_.capacity())
      waiting_.erase(waiting_.begin(), std::lower_bound(waiting_.begin(), waiting_.end(), first_waiting));
    waiting_.push_back(number);
  }
  if (root_.group->empty()) root_.least = root_.most = extent;
  std::optional<Part> half = add_to(root_, {extent, number});
  if (!half) return;
  auto top = std::make_unique<Group>();
  top->parts.push_back(std::exchange(root_, {{}, {}, nullptr}));
  top->parts.push_back(std::move(*half));
  bytes_ += top->bytes();
  root_.group = std::move(top);
  fit(root_);
}

std::optional<Antichain::Part> Antichain::add_to(Part& part, const Member& member) {
  part.least.lower_to(member.extent);
  part.most.raise_to(member.extent);
  Group& group = *part.group;
  if (group.parts.empty()) return append(part, &Group::members, member);
  Part* best = nullptr;
  std::uint32_t least_widening = UINT32_MAX;
  for (Part& inner : group.parts) {
    const std::uint32_t widening = member.extent.distance(inner.least, inner.most);
    if (widening >= least_widening) continue;
    best = &inner;
    least_widening = widening;
  }
  std::optional<Part> half = add_to(*best, member);
  if (!half) return std::nullopt;
  return append(part, &Group::parts, std::move(*half));
}

template <class Entry>
std::optional<Antichain::Part> Antichain::append(Part& part, std::vector<Entry> Group::* list, Entry entry) {
  std::vector<Entry>& entries = (*part.group).*list;
  bytes_ -= part.group->bytes();
  if (entries.size() == entries.capacity()) entries.reserve(entries.size() + group_size / 4);
  entries.push_back(std::move(entry));
  std::optional<Part> half;
  if (entries.size() >= group_size) {
    const int k = widest_component(part.least, part.most);
    const auto middle = entries.begin() + group_size / 2;
    std::nth_element(entries.begin(), middle, entries.end(), [k](const Entry& a, const Entry& b) {
      return a.smallest().sums[k] + a.largest().sums[k] < b.smallest().sums[k] + b.largest().sums[k];
    });
    half = Part{{}, {}, std::make_unique<Group>()};
    ((*half->group).*list).assign(std::move_iterator(middle), std::move_iterator(entries.end()));
    entries.erase(middle, entries.end());
    entries.shrink_to_fit();
    fit(part);
    fit(*half);
    bytes_ += half->group->bytes();
  }
  bytes_ += part.group->bytes();
  return half;
}

void Antichain::fit(Part& part) {
  bool first = true;
  const auto widen = [&](const auto& entry) {
    if (std::exchange(first, false)) {
      part.least = entry.smallest();
      part.most = entry.largest();
    }
    part.least.lower_to(entry.smallest());
    part.most.raise_to(entry.largest());
  };
  for (const Member& member : part.group->members) widen(member);
  for (const Part& inner : part.group->parts) widen(inner);
}

void Antichain::lower_root() {
  bytes_ -= root_.group->bytes();
  Part only = std::move(root_.group->parts.front());
  root_ = std::move(only);
}

}  // namespace tachk::states
