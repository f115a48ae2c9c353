#include "reachability/distances.hpp"

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <utility>
#include <vector>

#include "reachability/goals.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk::reachability {

using simulation::Levels;
using symbolic::ZoneGraph;

namespace {

constexpr std::uint32_t unreached = UINT32_MAX;

// The slots whose values can differ, clocks and locations included where they can.
std::vector<std::uint32_t> varying(const program::Program& program) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t slot = 0; slot < program.state_slots; ++slot)
    if (program.slots[slot].low < program.slots[slot].high && !program.slots[slot].meta) result.push_back(slot);
  return result;
}

class Search {
 public:
  Search(ZoneGraph& graph, std::size_t most_zones)
      : graph_(graph),
        passed_(graph.program(), graph.operations(), states::StoreOptions{}, graph.smaller_operations()),
        goals_(graph.program(), graph.semantics(), graph.operations(), false),
        levels_(varying(graph.program())),
        most_zones_(most_zones) {}

  Distances run() {
    graph_.start(*this);
    symbolic::SymbolicState source = graph_.blank();
    std::size_t next = 0;
    for (; next < waiting_.size() && waiting_.size() < most_zones_; ++next) {
      number_ = waiting_[next];
      if (passed_.covered(number_)) continue;
      passed_.unpack(number_, source.slots.data());
      graph_.unpack(passed_, number_, source);
      source_ = state(source.slots.data());
      try {
        graph_.expand(source, *this);
      } catch (const machine::ModelFault&) {
        continue;  // a run that gets here ends
      }
    }
    return result(next == waiting_.size());
  }

  // ---- the edges of the graph
  void possible(zones::ConstZoneRef, const symbolic::Effect&) const {}
  void expect(const symbolic::Effect& effect) { passed_.announce(effect.slots.data(), program::SlotSet::all()); }
  bool wants(const symbolic::Successor&) const { return true; }
  void take(const symbolic::Successor& successor) {
    const std::uint32_t target = state(successor.slots);
    if (source_ != unreached && (before_[target].empty() || before_[target].back() != source_))
      before_[target].push_back(source_);
    if (goals_.meets_any(successor.slots, successor.zone)) is_goal_[target] = true;
    const states::ZoneView zone = graph_.packed(successor.slots, successor.zone);
    const std::uint32_t node = passed_.add(passed_.locate(), zone, number_, true);
    if (node != states::no_node) waiting_.push_back(node);
  }

 private:
  std::uint32_t state(const std::int32_t* slots) {
    const auto [found, is_new] = numbers_.try_emplace(levels_.key(slots), static_cast<std::uint32_t>(numbers_.size()));
    if (is_new) {
      before_.emplace_back();
      is_goal_.push_back(false);
    }
    return found->second;
  }

  // Distances back from the goal, as levels.
  Distances result(bool whole) {
    std::vector<std::uint32_t> distance(before_.size(), unreached);
    std::deque<std::uint32_t> queue;
    for (std::uint32_t n = 0; n < is_goal_.size(); ++n)
      if (is_goal_[n]) {
        distance[n] = 0;
        queue.push_back(n);
      }
    while (!queue.empty()) {
      const std::uint32_t here = queue.front();
      queue.pop_front();
      for (const std::uint32_t there : before_[here])
        if (distance[there] == unreached) {
          distance[there] = distance[here] + 1;
          queue.push_back(there);
        }
    }
    Distances result{std::move(levels_), before_.size(), whole, !before_.empty() && distance[0] != unreached};
    const std::uint32_t initial = result.reached ? distance[0] : 0;
    for (auto& [key, number] : numbers_)
      if (distance[number] < initial) result.levels.set(key, initial - distance[number]);
    return result;
  }

  ZoneGraph& graph_;
  states::PassedList passed_;
  GoalWatch goals_;
  Levels levels_;
  std::size_t most_zones_;
  std::unordered_map<Levels::Key, std::uint32_t, Levels::Hash> numbers_;  // the initial state is 0
  std::vector<std::vector<std::uint32_t>> before_;
  std::vector<bool> is_goal_;
  std::vector<std::uint32_t> waiting_;
  std::uint32_t number_ = states::no_node;
  std::uint32_t source_ = unreached;
};

}  // namespace

Distances distances(program::Program program, std::size_t most_zones) {
  program.goals.resize(1);
  ZoneGraph graph(std::move(program), {});
  return Search(graph, most_zones).run();
}

}  // namespace tachk::reachability
