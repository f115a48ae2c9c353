#include "localtime/local_paths.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tachk::localtime {

using symbolic::Edges;
using symbolic::Path;

namespace {

void ignore(const symbolic::Effect&) {}

LocalState copy(const LocalSuccessor& successor) {
  return {successor.effect.slots, successor.zone, successor.synchronised};
}

// Successors are not sorted as long as there is one.
class WithoutSorting final {
 public:
  explicit WithoutSorting(LocalGraph& graph) : symmetry_(graph.symmetry()), before_(symmetry_.active()) {
    symmetry_.activate(false);
  }
  ~WithoutSorting() { symmetry_.activate(before_); }
  WithoutSorting(const WithoutSorting&) = delete;
  WithoutSorting& operator=(const WithoutSorting&) = delete;

 private:
  LocalSymmetry& symmetry_;
  bool before_;
};

LocalState initial(LocalGraph& graph) {
  std::optional<LocalState> state;
  graph.start([&](const LocalSuccessor& successor) { state = copy(successor); });
  return *std::move(state);
}

LocalState after(LocalGraph& graph, LocalState& state, const Edges& action) {
  std::optional<LocalState> next;
  graph.expand(state.slots.data(), state.zone, ignore, [&](const LocalSuccessor& successor) {
    if (!next && successor.edges == action) next = copy(successor);
  });
  if (!next) throw std::logic_error("a path over local times does not exist");
  return *std::move(next);
}

class Walk {
 public:
  explicit Walk(LocalGraph& graph)
      : graph_(graph),
        unsorted_(graph),
        sorted_(initial(graph)),
        current_(sorted_),
        places_(symbolic::inverse(sort())) {}

  // Takes an action of the sorted state, and returns that of the state in which processes keep their places.
  Edges take(const Edges& action) {
    LocalState next = after(graph_, sorted_, action);
    LocalState target = next;
    graph_.symmetry().arrange(places_, target.slots.data(), target.zone);
    const Edges taken = action_to(target);
    sorted_ = std::move(next);
    current_ = std::move(target);
    places_ = symbolic::composed(symbolic::inverse(sort()), places_);
    return taken;
  }

 private:
  const symbolic::Arrangement& sort() {
    return graph_.symmetry().sort(sorted_.slots.data(), sorted_.synchronised, sorted_.zone);
  }

  Edges action_to(const LocalState& target) {
    const std::size_t slots = graph_.program().state_slots;
    std::optional<Edges> found;
    graph_.expand(current_.slots.data(), current_.zone, ignore, [&](const LocalSuccessor& successor) {
      if (!found && successor.zone == target.zone &&
          std::equal(target.slots.begin(), target.slots.begin() + static_cast<std::ptrdiff_t>(slots),
                     successor.effect.slots.begin()))
        found = successor.edges;
    });
    if (!found) throw std::logic_error("processes are not as interchangeable as they seem to be");
    return *std::move(found);
  }

  LocalGraph& graph_;
  WithoutSorting unsorted_;
  LocalState sorted_;
  LocalState current_;
  symbolic::Arrangement places_;  // which place of the sorted state each member has
};

}  // namespace

Path unsorted_path(LocalGraph& graph, const Path& actions) {
  Walk walk(graph);
  Path path;
  for (const Edges& action : actions) path.push_back(walk.take(action));
  return path;
}

LocalState state_after(LocalGraph& graph, const Path& actions) {
  const WithoutSorting unsorted(graph);
  LocalState state = initial(graph);
  for (const Edges& action : actions) state = after(graph, state, action);
  return state;
}

}  // namespace tachk::localtime
