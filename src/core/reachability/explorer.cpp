#include "reachability/explorer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "reachability/paths.hpp"

namespace tachk::reachability {

using machine::ModelFault;
using order::SearchOrder;
using program::Program;
using states::no_node;
using symbolic::Path;
using symbolic::Successor;

namespace {

Options consistent(Options options, const Limits& limits, const Program& program) {
  // Distances in steps from the initial state need states in this order.
  if (options.order == SearchOrder::automatic && (options.shortest || limits.depth != UINT32_MAX))
    options.order = SearchOrder::breadth_first;
  if (options.shortest && options.order != SearchOrder::breadth_first)
    throw std::invalid_argument("shortest paths need a breadth-first search");
  // An action that is taken first makes paths longer.
  if (options.shortest || limits.depth != UINT32_MAX || !program.interchangeable.empty()) options.partial_order = false;
  // A path to a merged state has not been stored, and is made only for goals. Where clocks stop, a merged state may
  // lead to more than its parts, and so to a goal that none of them leads to.
  if (options.shortest || limits.depth != UINT32_MAX || options.partial_order || !program.measures.empty() ||
      !options.subsumption || program.has_stopwatches)
    options.merging = false;
  return options;
}

// The limit is met in the midst of a state.
struct TooMuchMemory : std::exception {};

}  // namespace

Explorer::Explorer(Program program, const Options& options, const Limits& limits)
    : options_(consistent(options, limits, program)),
      limits_(limits),
      graph_(std::move(program), options_),
      store_(graph_, options_),
      waiting_(options_.order, options_.seed, limits_.depth),
      parts_(graph_, options_),
      source_(graph_.blank()) {}

Explorer::Parts::Parts(symbolic::ZoneGraph& graph, const Options& options)
    : taken(graph.program().edges.size()),
      path_filter(graph.program().state_slots),
      partial_order(graph, options.partial_order),
      goals(graph.program(), graph.semantics(), graph.operations(), options.shortest),
      deadlocks(graph, goals),
      measures(graph.program(), graph.semantics(), graph.operations()),
      lost(graph.program(), graph.operations(), goals,
           options.pruning ? pruning::aims_of(graph.program()) : pruning::Aims{}) {}

// ---- the loop -------------------------------------------------------------------------------------------------------

// Stores successors, unless they are covered.
struct Explorer::Storing {
  Explorer& search;

  bool counts() const { return search.parts_.all.counts(); }
  bool admits(const symbolic::Edges& edges) const { return search.parts_.all.admits(edges); }
  void possible(zones::ConstZoneRef guarded, const symbolic::Effect& effect) const {
    search.parts_.all.possible(guarded, effect);
  }
  void expect(const symbolic::Effect& effect) const {
    search.store_.states().announce(effect.slots.data(), effect.written);
  }
  bool wants(const Successor& successor) const {
    if (!search.parts_.all.on_successor(successor)) return false;
    search.store_.locate();
    if (!search.store_.covers(successor)) return true;
    search.parts_.all.on_covered([&] { return search.store_.coverer(successor); });
    return false;
  }
  void take(const Successor& successor) const { search.store(successor); }
};

Status Explorer::search(std::uint64_t expansions) {
  if (!std::exchange(work_.started, true)) {
    graph_.start(Storing{*this});
    close();
  }
  while (!parts_.goals.settled() && !parts_.lost.all_is_lost()) {
    if (expansions-- == 0) return Status::running;
    const std::uint32_t node = next();
    if (node == no_node) return parts_.goals.settled() || waiting_.complete() ? Status::finished : Status::depth_limit;
    expand(node);
    if (store_.states().stored() > limits_.states) return Status::state_limit;
    if (needs_too_much_memory()) return Status::memory_limit;
  }
  return Status::finished;
}

std::uint32_t Explorer::next() {
  for (std::uint32_t node = waiting_.next(); node != no_node; node = waiting_.next()) {
    if (options_.shortest && !keeps_layers(node)) return no_node;
    if (!store_.states().covered(node) && waiting_.admits(node)) return node;
  }
  return no_node;
}

void Explorer::expand(std::uint32_t number) {
  node_ = number;
  ++work_.explored;
  store_.states().unpack(number, source_.slots.data());
  waiting_.begin(source_.slots.data());
  graph_.unpack(store_.states(), number, source_);
  parts_.all.before_expand(number, source_);
  while (parts_.partial_order.next()) graph_.expand(source_, Storing{*this});
  parts_.all.after_expand(number, source_);
  close();
}

// All successors of a state have been stored.
void Explorer::close() { waiting_.close(graph_.program(), store_.states()); }

bool Explorer::needs_too_much_memory() const {
  return limits_.memory_bytes != UINT64_MAX && statistics().bytes > limits_.memory_bytes;
}

void Explorer::store(const Successor& successor) {
  const std::uint32_t parent = successor.edges.empty() ? no_node : node_;
  const std::uint32_t number = store_.add(successor, parent, waiting_.first_untouched());
  if (number == no_node) return parts_.all.on_covered([&] { return store_.coverer(successor); });
  waiting_.add(number, parent, successor.slots, store_.states().covered_last());
  parts_.all.on_store(number, successor);
  constexpr std::uint32_t seldom = 256;  // one state may have very many successors
  if (number % seldom == seldom - 1 && needs_too_much_memory()) throw TooMuchMemory{};
}

// ---- special cases --------------------------------------------------------------------------------------------------

// For shortest paths: a waiting state may be covered only by one that is no further from the initial state. False if
// the layer that has been gone through settles the goals.
bool Explorer::keeps_layers(std::uint32_t node) {
  if (layers_.begins(node, store_.states().size())) parts_.goals.end_layer();
  store_.states().protect(node + 1, layers_.end());
  return !parts_.goals.settled();
}

// ---- the interface --------------------------------------------------------------------------------------------------

bool Explorer::begin_after(const Path& actions) {
  if (graph_.representatives().active()) throw std::invalid_argument("processes do not keep their places");
  std::vector<symbolic::SymbolicState> states;
  try {
    states = states_after(graph_, actions);
  } catch (const ModelFault&) {
  } catch (const symbolic::ConstantOverflow&) {
  }
  const bool possible = !states.empty();
  graph_.begin_at(std::move(states));
  return possible;
}

Status Explorer::run(std::uint64_t expansions) {
  if (fault_) return Status::fault;
  if (work_.is_full) return Status::memory_limit;
  return work_.pieces([&] { return search_keeping_faults(expansions); });
}

Status Explorer::search_keeping_faults(std::uint64_t expansions) {
  try {
    return search(expansions);
  } catch (const FaultReport& report) {
    fault_ = report;
  } catch (const symbolic::ActionFault& fault) {
    fault_ = FaultReport{fault.kind, fault.position, node_, fault.edges};
  } catch (const ModelFault& fault) {
    fault_ = FaultReport{fault.kind, fault.position, node_, {}};
  } catch (const symbolic::ConstantOverflow&) {
    return Status::constant_limit;
  } catch (const TooMuchMemory&) {
    work_.is_full = true;
    return Status::memory_limit;
  }
  return Status::fault;
}

Statistics Explorer::statistics() const {
  return {work_.explored, store_.states().stored(), parts_.taken.steps(), store_.bytes() + waiting_.bytes()};
}

std::uint64_t Explorer::effort() const {
  constexpr std::uint64_t entries_as_long = 1024, extents_as_long = 256;  // as a state takes
  const auto dimension = static_cast<std::uint64_t>(program().clocks) + 1;
  return store_.states().stored() + parts_.taken.steps() * dimension * dimension / entries_as_long +
         store_.states().examined() / extents_as_long;
}

std::optional<std::uint32_t> Explorer::reached(std::size_t goal) const {
  return parts_.goals.node(goal) == no_node ? std::nullopt : std::optional(parts_.goals.node(goal));
}

std::unique_ptr<Explorer> Explorer::among_origins(std::uint32_t node, Program program) {
  Options options = options_;
  options.merging = false;
  auto search = std::make_unique<Explorer>(std::move(program), options);
  search->graph_.begin_at(graph_.beginnings());
  std::vector<std::int32_t> slots(source_.slots.size());
  for (const std::uint32_t origin : store_.merging().origins(store_.states(), node)) {
    store_.states().unpack(origin, slots.data());
    search->parts_.path_filter.add(slots.data());
  }
  return search;
}

std::uint32_t Explorer::settled_in(std::size_t goal) const {
  const std::uint32_t reached = parts_.goals.node(goal);
  return reached == no_node && parts_.goals.failure(goal) ? parts_.goals.failure(goal)->node : reached;
}

Path Explorer::path_to_goal(std::size_t goal) {
  if (!has_merged()) return path(settled_in(goal));
  const std::unique_ptr<Explorer> narrow = among_origins(settled_in(goal), graph_.program());
  while (narrow->settled_in(goal) == no_node)
    if (narrow->run(1) != Status::running && narrow->settled_in(goal) == no_node)
      throw std::logic_error("merged states are not reached one by one");
  return narrow->path_to_goal(goal);
}

Path Explorer::path_to_edge(std::size_t edge) {
  if (!parts_.taken.taken(edge)) throw std::invalid_argument("this edge has not been taken");
  if (graph_.representatives().active()) throw std::invalid_argument("processes do not keep their places");
  const std::uint32_t source = parts_.taken.source(edge);
  if (!has_merged()) {
    Path actions = path(source);
    actions.push_back(parts_.taken.action(edge));
    return actions;
  }
  const std::unique_ptr<Explorer> narrow = among_origins(source, graph_.program());
  while (!narrow->parts_.taken.taken(edge))
    if (narrow->run(1) != Status::running && !narrow->parts_.taken.taken(edge))
      throw std::logic_error("merged states do not take one by one what they take together");
  return narrow->path_to_edge(edge);
}

Path Explorer::path(std::uint32_t node) { return path_to(graph_, store_.states(), node); }

FaultReport Explorer::fault_report(Path& path) {
  FaultReport report = *fault_;
  if (report.node == no_node) return report;
  if (has_merged()) {
    Program endless = graph_.program();  // no goal ends the search before the error does
    endless.goals.emplace_back();
    const std::unique_ptr<Explorer> narrow = among_origins(report.node, std::move(endless));
    if (narrow->run(UINT64_MAX) != Status::fault) throw std::logic_error("merged states do not meet a run-time error");
    return narrow->fault_report(path);
  }
  symbolic::SymbolicState last = graph_.blank();
  path = path_to(graph_, store_.states(), report.node, &last);
  if (report.edges.empty() || !graph_.representatives().active()) return report;
  if (const std::optional<symbolic::ActionFault> fault = fault_after(graph_, last))
    report = {fault->kind, fault->position, report.node, fault->edges};
  return report;
}

bool Explorer::leads_to(const Path& actions, std::size_t goal) {
  return reachability::leads_to(graph_, parts_.goals, parts_.deadlocks, actions, goal);
}

}  // namespace tachk::reachability
