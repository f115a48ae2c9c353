#include "reachability/merging/merging.hpp"

#include <algorithm>

namespace tachk::reachability::merging {

using states::ZoneView;

ZoneView Merging::merged(states::PassedList& passed, std::uint32_t discrete, ZoneView zone, std::uint32_t first) {
  fresh_.clear();
  if (!allowed_) return zone;
  passed.wait_from(first);
  if (first == states::no_node || !check_.is_due()) return zone;
  const std::size_t compared = passed.merge(discrete, zone, first, merged_.get(), fresh_);
  check_.record(!fresh_.empty(), compared);
  return fresh_.empty() ? zone : ZoneView{merged_.get(), zone.dimension};
}

void Merging::stored(std::uint32_t node) {
  for (const std::uint32_t part : fresh_) parts_.push_back({node, part});
  fresh_.clear();
}

std::vector<std::uint32_t> Merging::origins(const states::PassedList& passed, std::uint32_t node) const {
  std::vector<std::uint32_t> found{node};
  std::vector<bool> known(passed.size(), false);
  known[node] = true;
  const auto add = [&](std::uint32_t origin) {
    if (origin == states::no_node || known[origin]) return;
    known[origin] = true;
    found.push_back(origin);
  };
  for (std::size_t next = 0; next < found.size(); ++next) {
    const std::uint32_t whole = found[next];
    add(passed.parent(whole));
    const auto before = [](const Part& part, std::uint32_t number) { return part.whole < number; };
    for (auto part = std::lower_bound(parts_.begin(), parts_.end(), whole, before);
         part != parts_.end() && part->whole == whole; ++part)
      add(part->node);
  }
  return found;
}

}  // namespace tachk::reachability::merging
