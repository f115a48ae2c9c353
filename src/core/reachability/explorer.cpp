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
using zones::ClockBounds;

namespace {

Options consistent(Options options, const Limits& limits, const Program& program) {
  // What is counted in steps from the initial state is explored in their order.
  if (options.order == SearchOrder::automatic && (options.shortest || limits.depth != UINT32_MAX))
    options.order = SearchOrder::breadth_first;
  if (options.shortest && options.order != SearchOrder::breadth_first)
    throw std::invalid_argument("shortest paths need a breadth-first search");
  // An action that is taken first makes paths longer.
  if (options.shortest || limits.depth != UINT32_MAX || !program.interchangeable.empty()) options.partial_order = false;
  // A path to a united state has not been stored, and is told only to goals.
  if (options.shortest || limits.depth != UINT32_MAX || options.partial_order || !program.measures.empty() ||
      !options.subsumption)
    options.merging = false;
  return options;
}

// Whether a state that simulates another one stands for it: nothing is asked that depends on an action being
// impossible, or on how long clocks have run.
bool looks_at_actions_only(const Program& program) {
  if (!program.measures.empty()) return false;
  for (const program::Goal& goal : program.goals)
    for (const program::Disjunct& disjunct : goal.disjuncts)
      if (disjunct.deadlock != program::DeadlockLiteral::absent) return false;
  return true;
}

// The limit is met in the midst of a state.
struct TooMuchMemory : std::exception {};

}  // namespace

Explorer::Explorer(Program program, const Options& options, const Limits& limits)
    : options_(consistent(options, limits, program)),
      limits_(limits),
      graph_(std::move(program), options_),
      passed_(graph_.program(), graph_.operations(), options_, graph_.smaller_operations()),
      waiting_(options_.order, options_.seed, limits_.depth),
      goals_(graph_.program(), graph_.semantics(), graph_.operations(), options_.shortest),
      deadlocks_(graph_, goals_),
      measures_(graph_.program(), graph_.semantics(), graph_.operations()),
      partial_order_(graph_, options_.partial_order),
      merging_(options_.merging, graph_.operations()),
      source_(graph_.blank()),
      work_{.taken = std::vector<std::uint8_t>(graph_.program().edges.size(), 0),
            .simulation = states::AdaptiveCheck(options_.alu && options_.subsumption && graph_.knows_simulation() &&
                                                looks_at_actions_only(graph_.program()))} {}

// ---- the loop -------------------------------------------------------------------------------------------------------

// Stores successors, unless they are covered.
struct Explorer::Storing {
  Explorer& search;
  std::uint32_t discrete = 0;

  bool counts() const { return search.deadlocks_.counts(); }
  bool admits(const symbolic::Edges& edges) const { return search.partial_order_.admits(edges); }
  void possible(zones::ConstZoneRef guarded, const symbolic::Effect& effect) const {
    search.deadlocks_.pass(guarded, effect);
    search.partial_order_.pass(guarded, effect);
  }
  void expect(const symbolic::Effect& effect) const { search.passed_.announce(effect.slots.data(), effect.written); }
  bool wants(const Successor& successor) {
    if (!successor.edges.empty()) ++search.work_.transitions;
    for (const std::uint32_t edge : successor.edges) search.work_.taken[edge] = 1;
    if (search.corridor_ && !search.corridor_->contains(successor.slots)) return false;
    discrete = search.passed_.locate();
    if (!search.options_.subsumption || !search.covers(discrete, successor)) return true;
    search.note_coverer(discrete, successor);
    return false;
  }
  void take(const Successor& successor) { search.store(successor, discrete); }
};

Status Explorer::search(std::uint64_t expansions) {
  if (!std::exchange(work_.started, true)) {
    graph_.start(Storing{*this});
    waiting_.close();
    waiting_.consider(graph_.program(), passed_);
  }
  while (!goals_.settled()) {
    if (expansions-- == 0) return Status::running;
    const std::uint32_t node = next();
    if (node == no_node) return goals_.settled() || waiting_.complete() ? Status::finished : Status::depth_limit;
    expand(node);
    if (passed_.stored() > limits_.states) return Status::state_limit;
    if (needs_too_much_memory()) return Status::memory_limit;
  }
  return Status::finished;
}

std::uint32_t Explorer::next() {
  for (std::uint32_t node = waiting_.next(); node != no_node; node = waiting_.next()) {
    if (options_.shortest && !keeps_layers(node)) return no_node;
    if (!passed_.covered(node) && waiting_.admits(node)) return node;
  }
  return no_node;
}

void Explorer::expand(std::uint32_t number) {
  node_ = number;
  ++work_.explored;
  passed_.unpack(number, source_.slots.data());
  waiting_.begin(source_.slots.data());
  graph_.unpack(passed_, number, source_);
  deadlocks_.begin(number, source_);
  for (partial_order_.begin(number, source_); partial_order_.next();) graph_.expand(source_, Storing{*this});
  deadlocks_.end(number, source_);
  waiting_.close();
  waiting_.consider(graph_.program(), passed_);
}

bool Explorer::needs_too_much_memory() const {
  return limits_.memory_bytes != UINT64_MAX && statistics().bytes > limits_.memory_bytes;
}

bool Explorer::covers(std::uint32_t discrete, const Successor& successor) {
  return passed_.covers(discrete, graph_.packed(successor.slots, successor.zone)) || simulates(discrete, successor);
}

bool Explorer::simulates(std::uint32_t discrete, const Successor& successor) {
  if (!work_.simulation.asks()) return false;
  const std::size_t others = passed_.count(discrete);
  if (others == 0) return false;
  const ClockBounds bounds = graph_.bounds(successor.slots);
  const bool simulated = passed_.covers(discrete, graph_.packed(successor.slots, successor.zone), &bounds);
  work_.simulation.tell(simulated, others);
  return simulated;
}

// What covers a successor only in that it can do as much is not asked for.
void Explorer::note_coverer(std::uint32_t discrete, const Successor& successor) {
  if (!partial_order_.asks()) return;
  const std::uint32_t coverer = passed_.coverer(discrete, graph_.packed(successor.slots, successor.zone));
  if (coverer != no_node) partial_order_.leads_to(coverer);
}

void Explorer::store(const Successor& successor, std::uint32_t discrete) {
  const std::uint32_t parent = successor.edges.empty() ? no_node : node_;
  const states::ZoneView zone = graph_.packed(successor.slots, successor.zone);
  const states::ZoneView united = merging_.united(passed_, discrete, zone, waiting_.first_untouched());
  const ClockBounds bounds = work_.simulation.asking() ? graph_.bounds(successor.slots) : ClockBounds{};
  const std::uint32_t number =
      passed_.add(discrete, united, parent, options_.subsumption, work_.simulation.asking() ? &bounds : nullptr);
  if (number == no_node) return note_coverer(discrete, successor);
  merging_.stored(number);
  partial_order_.leads_to(number);
  enlist(number, parent, successor);
  constexpr std::uint32_t seldom = 256;  // one state may have very many successors
  if (number % seldom == seldom - 1 && needs_too_much_memory()) throw TooMuchMemory{};
}

void Explorer::enlist(std::uint32_t number, std::uint32_t parent, const Successor& successor) {
  const auto [edges, slots, zone] = successor;
  waiting_.add(number, parent, slots, passed_.covered_last());
  goals_.check(number, slots, zone);
  try {
    measures_.check(number, slots, zone);
  } catch (const ModelFault& fault) {  // of the new state, not of the action that leads there
    throw FaultReport{fault.kind, fault.position, number, {}};
  }
}

// ---- special cases --------------------------------------------------------------------------------------------------

// For shortest paths: a waiting state may be covered only by one that is no further from the initial state. False if
// the layer that has been gone through settles the goals.
bool Explorer::keeps_layers(std::uint32_t node) {
  if (layers_.begins(node, passed_.size())) goals_.end_layer();
  passed_.protect(node + 1, layers_.end());
  return !goals_.settled();
}

// ---- how it is asked for --------------------------------------------------------------------------------------------

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
  return {work_.explored, passed_.stored(), work_.transitions, passed_.bytes() + waiting_.bytes() + merging_.bytes()};
}

std::vector<std::uint32_t> Explorer::taken() const {
  std::vector<std::uint32_t> edges;
  for (std::uint32_t edge = 0; edge < work_.taken.size(); ++edge)
    if (work_.taken[edge] != 0) edges.push_back(edge);
  return edges;
}

std::optional<std::uint32_t> Explorer::reached(std::size_t goal) const {
  return goals_.node(goal) == no_node ? std::nullopt : std::optional(goals_.node(goal));
}

std::unique_ptr<Explorer> Explorer::among_origins(std::uint32_t node, Program program) {
  auto corridor = std::make_unique<merging::Corridor>(graph_.program().state_slots);
  std::vector<std::int32_t> slots(source_.slots.size());
  for (const std::uint32_t origin : merging_.origins(passed_, node)) {
    passed_.unpack(origin, slots.data());
    corridor->add(slots.data());
  }
  Options options = options_;
  options.merging = false;
  auto search = std::make_unique<Explorer>(std::move(program), options);
  search->corridor_ = std::move(corridor);
  return search;
}

std::uint32_t Explorer::settled_in(std::size_t goal) const {
  const std::uint32_t reached = goals_.node(goal);
  return reached == no_node && goals_.failure(goal) ? goals_.failure(goal)->node : reached;
}

Path Explorer::path_to_goal(std::size_t goal) {
  if (!merging_.any()) return path(settled_in(goal));
  const std::unique_ptr<Explorer> narrow = among_origins(settled_in(goal), graph_.program());
  while (narrow->settled_in(goal) == no_node)
    if (narrow->run(1) != Status::running && narrow->settled_in(goal) == no_node)
      throw std::logic_error("united states are not reached one by one");
  return narrow->path_to_goal(goal);
}

Path Explorer::path(std::uint32_t node) { return path_to(graph_, passed_, node); }

FaultReport Explorer::told_fault(Path& path) {
  FaultReport report = *fault_;
  if (report.node == no_node) return report;
  if (merging_.any()) {
    Program endless = graph_.program();  // no goal ends the search before the error does
    endless.goals.emplace_back();
    const std::unique_ptr<Explorer> narrow = among_origins(report.node, std::move(endless));
    if (narrow->run(UINT64_MAX) != Status::fault) throw std::logic_error("united states do not meet a run-time error");
    return narrow->told_fault(path);
  }
  symbolic::SymbolicState last = graph_.blank();
  path = path_to(graph_, passed_, report.node, &last);
  if (report.edges.empty() || !graph_.representatives().active()) return report;
  if (const std::optional<symbolic::ActionFault> fault = fault_after(graph_, last))
    report = {fault->kind, fault->position, report.node, fault->edges};
  return report;
}

bool Explorer::leads_to(const Path& actions, std::size_t goal) {
  return reachability::leads_to(graph_, goals_, deadlocks_, actions, goal);
}

}  // namespace tachk::reachability
