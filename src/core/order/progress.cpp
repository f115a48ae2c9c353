#include "order/progress.hpp"

#include <algorithm>
#include <utility>

namespace tachk::order {
namespace {

using Targets = std::vector<std::vector<std::uint32_t>>;

// The locations of a process that can be entered, each before those that its edges lead to, and the edges without those
// that close a circle: depth first from the initial location, an edge closes a circle if it leads to a location that is
// still being gone through.
class Unrolled {
 public:
  Unrolled(const Targets& targets, std::uint32_t initial) : targets_(targets), state_(targets.size(), State::fresh) {
    forward.resize(targets.size());
    visit(initial);
    std::reverse(order.begin(), order.end());
  }

  std::vector<std::uint32_t> order;
  Targets forward;

 private:
  enum class State : std::uint8_t { fresh, open, done };

  void visit(std::uint32_t initial) {
    std::vector<std::pair<std::uint32_t, std::size_t>> path{{initial, 0}};  // locations, and how many edges were taken
    state_[initial] = State::open;
    while (!path.empty()) {
      auto& [location, taken] = path.back();
      if (taken == targets_[location].size()) {
        state_[location] = State::done;
        order.push_back(location);
        path.pop_back();
        continue;
      }
      const std::uint32_t target = targets_[location][taken++];
      if (state_[target] == State::open) continue;
      forward[location].push_back(target);
      if (state_[target] == State::done) continue;
      state_[target] = State::open;
      path.emplace_back(target, 0);
    }
  }

  const Targets& targets_;
  std::vector<State> state_;
};

}  // namespace

Progress::Progress(const program::Program& program) {
  for (std::size_t p = 0; p < program.processes.size(); ++p) {
    Targets targets(program.processes[p].locations.size());
    for (const program::Edge& edge : program.edges)
      if (edge.process == p)
        targets[static_cast<std::size_t>(edge.source)].push_back(static_cast<std::uint32_t>(edge.target));
    const Unrolled unrolled(targets, static_cast<std::uint32_t>(program.slots[p].initial));
    Layered& layered = processes_.emplace_back(std::vector<std::uint32_t>(targets.size(), 0), 1);
    for (const std::uint32_t location : unrolled.order)
      for (const std::uint32_t target : unrolled.forward[location]) {
        layered.layer[target] = std::max(layered.layer[target], layered.layer[location] + 1);
        layered.layers = std::max(layered.layers, layered.layer[target] + 1);
      }
  }
}

std::uint32_t Progress::between(const std::int32_t* from, const std::int32_t* to) const {
  std::uint32_t sum = 0;
  for (std::size_t p = 0; p < processes_.size(); ++p) {
    if (from[p] == to[p]) continue;
    const Layered& process = processes_[p];
    const std::uint32_t before = process.layer[static_cast<std::size_t>(from[p])];
    const std::uint32_t after = process.layer[static_cast<std::size_t>(to[p])];
    sum += after - before + (after > before ? 0 : process.layers);
  }
  return std::max(sum, std::uint32_t{1});
}

}  // namespace tachk::order
