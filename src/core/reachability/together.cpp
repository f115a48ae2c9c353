// What several threads do for a search.
#include <algorithm>
#include <memory>

#include "reachability/explorer.hpp"

namespace tachk {

std::size_t Explorer::expand_together(std::uint64_t expansions) {
  Stretch& stretch = work_.stretch;
  std::span<const std::uint32_t> nodes = stretch.left();
  nodes = nodes.first(std::min<std::uint64_t>(nodes.size(), expansions));
  const std::size_t fewest = std::clamp<std::size_t>(options_.threads_after, 1, 64);
  const Program& program = graph_.program();
  if (!program.measures.empty() && !program.diagonals.empty()) return 0;  // which piece of a zone has which value
  if (stretch.alone || nodes.size() < fewest) return 0;
  if (!work_.ahead) work_.ahead.emplace(graph_, passed_, threads_of(options_));
  const bool simulation = work_.simulation.asks();
  const bool slots = waiting_.looks_at_slots() || !program.measures.empty();
  const std::size_t count = work_.ahead->find(nodes, goals_, work_.taken, {options_.subsumption, simulation, slots});
  stretch.alone = count == 0 || passed_.stored() + work_.ahead->found() > limits_.states;
  if (stretch.alone) return 0;
  store_together(count);
  return count;
}

// Does what `expand` does for each of the first states of the stretch, in the same order.
void Explorer::store_together(std::size_t count) {
  Ahead& ahead = *work_.ahead;
  const std::uint32_t first = waiting_.first_untouched();
  ahead.store(count, {options_.subsumption, work_.simulation.asks(), merging_.allowed() && first != no_node,
                      merging_.asks(), first});
  const auto begin = [&](std::size_t place, const Expansion& expansion, std::span<const std::uint32_t> edges) {
    node_ = work_.stretch.left()[place];
    ++work_.explored;
    work_.transitions += expansion.transitions;
    for (const std::uint32_t edge : edges) work_.taken[edge] = 1;
    if (!waiting_.looks_at_slots()) return;
    passed_.unpack(node_, source_.slots.data());
    waiting_.begin(source_.slots.data());
  };
  const auto add = [&](Harvest& harvest, const Found& found, const Keeper::Union* united, const Keeper& keeper) {
    const std::uint32_t number = passed_.append(node_);
    std::int32_t* slots = harvest.slots(found.slots);
    waiting_.add(number, node_, slots, {});
    if (!graph_.program().measures.empty()) {
      std::copy_n(slots, graph_.program().state_slots, source_.slots.data());
      source_.zone.assign(found.zone);
      const auto check = [&](ConstZoneRef zone) { measures_.check(number, source_.slots.data(), zone); };
      if (graph_.representatives().active())
        check(found.zone);
      else
        graph_.abstract(slots, source_.zone, check);
    }
    if (united == nullptr) return number;
    for (const std::uint32_t part : united->parts) merging_.add(number, part);
    for (const std::uint32_t part : united->own) merging_.add(number, keeper.numbers()[part]);
    return number;
  };
  std::int64_t added = 0;
  for (const std::unique_ptr<Keeper>& keeper : ahead.keepers()) {
    added += keeper->added();
    work_.simulated.add(keeper->simulated());
    merging_.add(keeper->united());
    waiting_.note_covered(keeper->covered());
  }
  ahead.number(count, begin, add);
  passed_.count_stored(added);
}

}  // namespace tachk
