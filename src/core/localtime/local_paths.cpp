#include "localtime/local_paths.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tachk {
namespace {

struct State {
  std::vector<std::int32_t> slots;
  std::vector<LocalEntry> zone;
  ZoneBuffer synchronised;
};

class Walk {
 public:
  explicit Walk(LocalGraph& graph) : graph_(graph), sorted_(initial(graph)), kept_(sorted_), places_(inverse(sort())) {}
  ~Walk() { graph_.symmetry().activate(true); }
  Walk(const Walk&) = delete;
  Walk& operator=(const Walk&) = delete;

  // Takes an action of the sorted state, and tells that of the state in which processes keep their places.
  Edges take(const Edges& action) {
    std::optional<State> next;
    graph_.expand(sorted_.slots.data(), sorted_.zone, ignore, [&](const LocalSuccessor& successor) {
      if (!next && successor.edges == action) next = copy(successor);
    });
    if (!next) throw std::logic_error("a path over local times does not exist");
    State target = *next;
    graph_.symmetry().arrange(places_, target.slots.data(), target.zone);
    const Edges taken = action_to(target);
    sorted_ = *std::move(next);
    kept_ = std::move(target);
    places_ = composed(inverse(sort()), places_);
    return taken;
  }

 private:
  static void ignore(const Effect&) {}

  static State copy(const LocalSuccessor& successor) {
    return {successor.effect.slots, successor.zone, successor.synchronised};
  }
  // From here on successors are not sorted.
  static State initial(LocalGraph& graph) {
    graph.symmetry().activate(false);
    std::optional<State> state;
    graph.start([&](const LocalSuccessor& successor) { state = copy(successor); });
    return *std::move(state);
  }

  const Arrangement& sort() { return graph_.symmetry().sort(sorted_.slots.data(), sorted_.synchronised, sorted_.zone); }

  Edges action_to(const State& target) {
    const std::size_t slots = graph_.program().state_slots;
    std::optional<Edges> found;
    graph_.expand(kept_.slots.data(), kept_.zone, ignore, [&](const LocalSuccessor& successor) {
      if (!found && successor.zone == target.zone &&
          std::equal(target.slots.begin(), target.slots.begin() + static_cast<std::ptrdiff_t>(slots),
                     successor.effect.slots.begin()))
        found = successor.edges;
    });
    if (!found) throw std::logic_error("processes are not as interchangeable as they seem to be");
    return *std::move(found);
  }

  LocalGraph& graph_;
  State sorted_;
  State kept_;
  Arrangement places_;  // which place of the sorted state each member has
};

}  // namespace

Path unsorted_path(LocalGraph& graph, const Path& actions) {
  Walk walk(graph);
  Path path;
  for (const Edges& action : actions) path.push_back(walk.take(action));
  return path;
}

}  // namespace tachk
