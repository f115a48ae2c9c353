#include "reachability/paths.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tachk::reachability {

using machine::ModelFault;
using states::PassedList;
using symbolic::ActionFault;
using symbolic::Arrangement;
using symbolic::ConstantOverflow;
using symbolic::Edges;
using symbolic::Effect;
using symbolic::Path;
using symbolic::Successor;
using symbolic::SymbolicState;
using symbolic::ZoneGraph;

namespace {

// A receiver that does not care how successors come about.
struct OnlyStates {
  void possible(zones::ConstZoneRef, const Effect&) const {}
  void expect(const Effect&) const {}
};

// How a state that a path may lead through is reached.
struct BackwardStep {
  Edges action;             // none to an initial state
  std::size_t previous;     // among the states one step before
  Arrangement arrangement;  // of the state, behind the actions; empty where processes keep their places
};

// Keeps the states that may be those of a node, each once, with the action that leads there.
struct Recogniser : OnlyStates {
  ZoneGraph& graph;
  PassedList& passed;
  std::uint32_t node;
  std::vector<SymbolicState>& states;
  std::vector<BackwardStep>& steps;
  std::size_t previous = 0;
  std::vector<Edges> failing = {};  // actions that are a run-time error

  // The zone of a node that is not covered is known: the first that equals it will do.
  bool admits(const Edges& edges) const {
    return (states.empty() || passed.covered(node)) &&
           std::find(failing.begin(), failing.end(), edges) == failing.end();
  }
  // True if there is more to find now that an action has failed: the search may not have taken that one.
  bool leaves_out(const Edges& edges) {
    if (std::find(failing.begin(), failing.end(), edges) != failing.end()) return false;
    failing.push_back(edges);
    return true;
  }
  bool wants(const Successor& successor) const { return passed.equals(node, successor.slots); }
  void take(const Successor& successor) const {
    if (!passed.may_equal(node, graph.packed(successor.slots, successor.zone))) return;
    for (const SymbolicState& state : states)
      if (std::memcmp(state.zone.get().bytes, successor.zone.bytes, graph.operations().bytes) == 0) return;
    symbolic::Representatives& sorted = graph.representatives();
    states.push_back(graph.copy(successor));
    steps.push_back({{successor.edges.begin(), successor.edges.end()},
                     previous,
                     sorted.active() ? sorted.arrangement() : Arrangement{}});
  }
};

// Keeps the successors by one action, or the initial states where no action has been taken yet.
struct ActionSuccessors : OnlyStates {
  const ZoneGraph& graph;
  std::vector<SymbolicState>& states;
  const Edges* edges = nullptr;

  bool wants(const Successor& successor) const {
    return edges == nullptr || std::equal(successor.edges.begin(), successor.edges.end(), edges->begin(), edges->end());
  }
  void take(const Successor& successor) const { states.push_back(graph.copy(successor)); }
};

// Wants no successors; only whether there are any.
struct Prober {
  DeadlockWatch& deadlocks;

  void possible(zones::ConstZoneRef guarded, const Effect& effect) const { deadlocks.possible(guarded, effect); }
  void expect(const Effect&) const {}
  bool wants(const Successor&) const { return false; }
  void take(const Successor&) const {}
};

// From the initial state to the node.
std::vector<std::uint32_t> chain_of_parents(const PassedList& passed, std::uint32_t node) {
  std::vector<std::uint32_t> chain;
  for (std::uint32_t number = node; number != states::no_node; number = passed.parent(number)) chain.push_back(number);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

// Keeps the action that leads to a given state.
struct Matcher : OnlyStates {
  const ZoneGraph& graph;
  const SymbolicState& state;
  std::optional<Edges>& edges;

  bool admits(const Edges&) const { return !edges; }
  bool wants(const Successor& successor) const {
    return std::equal(successor.slots, successor.slots + graph.program().state_slots, state.slots.begin());
  }
  void take(const Successor& successor) const {
    if (std::memcmp(state.zone.get().bytes, successor.zone.bytes, graph.operations().bytes) == 0)
      edges.emplace(successor.edges.begin(), successor.edges.end());
  }
};

// During its life processes keep their places in the graph.
class Unsorted {
 public:
  explicit Unsorted(ZoneGraph& graph) : representatives_(graph.representatives()), before_(representatives_.active()) {
    representatives_.activate(false);
  }
  ~Unsorted() { representatives_.activate(before_); }
  Unsorted(const Unsorted&) = delete;
  Unsorted& operator=(const Unsorted&) = delete;

 private:
  symbolic::Representatives& representatives_;
  bool before_;
};

// The numbers of the states of each layer that lie on the way to the first of the last ones.
std::vector<std::size_t> way_back(const std::vector<std::vector<BackwardStep>>& layers) {
  std::vector<std::size_t> numbers(layers.size(), 0);
  for (std::size_t layer = layers.size() - 1; layer > 0; --layer)
    numbers[layer - 1] = layers[layer][numbers[layer]].previous;
  return numbers;
}

// The same way with processes that keep their places: what the search calls the member at some place is another one
// whenever a state has been sorted.
Path unsorted_path(ZoneGraph& graph, const std::vector<std::vector<BackwardStep>>& layers,
                   std::vector<std::vector<SymbolicState>>& states, SymbolicState* last) {
  const std::vector<std::size_t> numbers = way_back(layers);
  const Unsorted unsorted(graph);
  Path path;
  Arrangement places;  // which place of the sorted state each member has
  SymbolicState source = graph.blank();
  for (std::size_t layer = 0; layer < layers.size(); ++layer) {
    const Arrangement back = symbolic::inverse(layers[layer][numbers[layer]].arrangement);
    places = layer == 0 ? back : symbolic::composed(back, places);
    SymbolicState& target = states[layer][numbers[layer]];
    graph.representatives().arrange(places, target.slots.data(), target.zone);
    if (layer > 0) {
      std::optional<Edges> edges;
      try {
        graph.expand(source, Matcher{{}, graph, target, edges});
      } catch (const ModelFault&) {  // as when the state was recognised
      } catch (const ConstantOverflow&) {
      }
      if (!edges) throw std::logic_error("processes are not as interchangeable as they seem to be");
      path.push_back(*std::move(edges));
    }
    source = target;
  }
  if (last != nullptr) *last = source;
  return path;
}

// The way back from the first of the last states; `layers`: the steps to the states of each layer.
Path actions_through(std::vector<std::vector<BackwardStep>>& layers) {
  Path actions;  // from the last to the first
  std::size_t number = 0;
  for (std::size_t layer = layers.size() - 1; layer > 0; --layer) {
    BackwardStep& step = layers[layer][number];
    actions.push_back(std::move(step.action));
    number = step.previous;
  }
  std::reverse(actions.begin(), actions.end());
  return actions;
}

}  // namespace

// Of a covered node only half a hash of the zone is known, so that two states may seem to be its own: all are followed.
// Each is reached by the actions noted for it, so that whichever remains at the end has been reached.
Path path_to(ZoneGraph& graph, PassedList& passed, std::uint32_t node, SymbolicState* last) {
  const bool sorted = graph.representatives().active();
  std::vector<std::vector<SymbolicState>> states_by_layer;  // of all layers, where processes have been sorted
  std::vector<SymbolicState> states;                        // of the last layer
  std::vector<std::vector<BackwardStep>> layers;
  for (const std::uint32_t child : chain_of_parents(passed, node)) {
    std::vector<SymbolicState> next;
    std::vector<BackwardStep>& steps = layers.emplace_back();
    if (layers.size() == 1) graph.start(Recogniser{{}, graph, passed, child, next, steps});
    for (std::size_t number = 0; number < states.size(); ++number) {
      Recogniser recogniser{{}, graph, passed, child, next, steps, number};
      for (bool goes_on = true; goes_on;) {
        goes_on = false;
        try {
          graph.expand(states[number], recogniser);
        } catch (const ActionFault& fault) {
          goes_on = next.empty() && recogniser.leaves_out(fault.edges);
        } catch (const ModelFault&) {
          // The search stopped at this fault, in an action behind the one looked for.
        } catch (const ConstantOverflow&) {
          // As above.
        }
      }
    }
    states.swap(next);
    if (states.empty()) throw std::logic_error("a stored state is not a successor of its parent");
    if (sorted) states_by_layer.push_back(states);
  }
  if (sorted) return unsorted_path(graph, layers, states_by_layer, last);
  if (last != nullptr) *last = states.front();
  return actions_through(layers);
}

std::optional<ActionFault> fault_after(ZoneGraph& graph, SymbolicState& state) {
  struct Nothing : OnlyStates {
    bool wants(const Successor&) const { return false; }
    void take(const Successor&) const {}
  };
  const Unsorted unsorted(graph);
  try {
    graph.expand(state, Nothing{});
  } catch (const ActionFault& fault) {
    return fault;
  } catch (const ModelFault&) {  // of the state itself
  } catch (const ConstantOverflow&) {
  }
  return std::nullopt;
}

std::vector<SymbolicState> states_after(ZoneGraph& graph, const Path& actions) {
  std::vector<SymbolicState> states;
  graph.start(ActionSuccessors{{}, graph, states});
  for (const Edges& edges : actions) {
    std::vector<SymbolicState> next;
    for (SymbolicState& state : states) graph.expand(state, ActionSuccessors{{}, graph, next, &edges});
    states.swap(next);
  }
  return states;
}

bool leads_to(ZoneGraph& graph, GoalWatch& goals, DeadlockWatch& deadlocks, const Path& actions, std::size_t goal) {
  try {
    for (SymbolicState& state : states_after(graph, actions)) {
      goals.check(0, state.slots.data(), state.zone.get());
      if (!deadlocks.open()) continue;
      deadlocks.before_expand(0, state);
      graph.expand(state, Prober{deadlocks});
      deadlocks.after_expand(0, state);
    }
  } catch (const ModelFault&) {
  } catch (const ConstantOverflow&) {
  }
  return goals.node(goal) != states::no_node;
}

}  // namespace tachk::reachability
