#include "reachability/cover_search.hpp"

#include <algorithm>
#include <utility>

namespace tachk::reachability {

using states::no_node;
using symbolic::Successor;
using zones::ConstZoneRef;

namespace {

constexpr int searches_by_state = 12;      // before all discrete states with the same locations keep their zones
constexpr int searches_by_locations = 24;  // before all discrete states do

// Zones are stored whole, and no state is left out.
Options plain(Options options) {
  options.pack_clocks = UINT32_MAX;
  options.shortest = false;
  options.subsumption = true;
  options.order = order::SearchOrder::breadth_first;
  return options;
}

}  // namespace

CoverSearch::Search::Search(symbolic::ZoneGraph& graph, const Options& options, const pruning::Aims& aims)
    : passed(graph.program(), graph.operations(), options, graph.smaller_operations()),
      waiting(options.order, options.seed, UINT32_MAX),
      goals(graph.program(), graph.semantics(), graph.operations(), false),
      deadlocks(graph, goals),
      lost(graph.program(), graph.operations(), goals, aims) {}

CoverSearch::CoverSearch(program::Program program, const Options& options, const Limits& limits, bool hulls,
                         const std::vector<pruning::Trap>& traps, const std::vector<std::vector<std::size_t>>& clauses)
    : options_(plain(options)),
      limits_(limits),
      graph_(std::move(program), options_),
      hulls_(hulls),
      search_(std::make_unique<Search>(graph_, options_, pruning::aims_within(graph_.program(), traps, clauses))),
      source_(graph_.blank()),
      hull_(graph_.operations()),
      parts_(graph_) {}

std::size_t CoverSearch::KeyHash::operator()(const Key& key) const {
  std::uint64_t hash = key.size();
  for (const std::int32_t number : key) hash = (hash ^ static_cast<std::uint32_t>(number)) * 0x9E3779B97F4A7C15u;
  return static_cast<std::size_t>(hash ^ hash >> 32);
}

// ---- the search -----------------------------------------------------------------------------------------------------

struct CoverSearch::Keeping {
  CoverSearch& search;
  std::uint32_t discrete = 0;

  void possible(ConstZoneRef guarded, const symbolic::Effect& effect) const {
    search.search_->deadlocks.possible(guarded, effect);
  }
  void expect(const symbolic::Effect& effect) const {
    search.search_->passed.announce(effect.slots.data(), program::SlotSet::all());
  }
  bool wants(const Successor& successor) {
    if (!successor.edges.empty()) ++search.transitions_;
    if (!search.search_->lost.on_successor(successor)) return false;
    discrete = search.search_->passed.locate();
    return !search.search_->passed.covers(discrete, {successor.zone, search.graph_.program().dimension()});
  }
  void take(const Successor& successor) const { search.keep(successor, discrete); }
};

Status CoverSearch::search(std::uint64_t expansions) {
  while (true) {
    if (!std::exchange(search_->started, true)) {
      node_ = no_node;
      graph_.start(Keeping{*this});
    }
    while (!search_->goals.settled()) {
      if (expansions-- == 0) return Status::running;
      const std::uint32_t node = search_->waiting.next();
      if (node == no_node) return Status::finished;
      if (search_->passed.covered(node)) continue;
      expand(node);
      if (search_->passed.stored() > limits_.states) return Status::state_limit;
      if (limits_.memory_bytes != UINT64_MAX && statistics().bytes > limits_.memory_bytes) return Status::memory_limit;
    }
    if (refine(search_->goals.node(0))) continue;
    reached_ = true;
    return Status::finished;
  }
}

Status CoverSearch::run(std::uint64_t expansions) {
  return in_pieces_([&] {
    try {
      return search(expansions);
    } catch (const machine::ModelFault&) {
      return node_ != no_node && refine(node_) ? Status::running : Status::fault;
    } catch (const symbolic::ConstantOverflow&) {
      return Status::constant_limit;
    }
  });
}

void CoverSearch::expand(std::uint32_t number) {
  search_->passed.unpack(number, source_.slots.data());
  search_->passed.copy_zone(number, source_.zone);
  node_ = number;
  ++explored_;
  search_->deadlocks.before_expand(number, source_);
  search_->goals.throw_failure();
  graph_.expand(source_, Keeping{*this});
  search_->deadlocks.after_expand(number, source_);
}

void CoverSearch::keep(const Successor& successor, std::uint32_t discrete) {
  Search& search = *search_;
  const int dimension = graph_.program().dimension();
  ConstZoneRef zone = successor.zone;
  bool widened = false;
  if (mode(discrete, successor.slots) == Mode::hull) {
    if (const std::uint32_t before = search.latest[discrete]; before != no_node) {
      search.passed.copy_zone(before, hull_);
      const ConstZoneRef held = hull_.get();
      widened = !graph_.operations().includes(zone, held, dimension);
      graph_.operations().hull(hull_.get(), zone, dimension);
      zone = hull_.get();
    }
  }
  const std::uint32_t parent = successor.edges.empty() ? no_node : node_;
  const std::uint32_t number = search.passed.add(discrete, {zone, dimension}, parent, true);
  if (number == no_node) return;
  search.waiting.add(number, parent, successor.slots, search.passed.covered_last());
  search.latest[discrete] = number;
  search.widened.resize(number + std::size_t{1});
  search.widened[number] = widened;
  const std::uint32_t expanded = std::exchange(node_, number);  // a fault of the predicate is one of the new state
  search.goals.check(number, successor.slots, zone);
  search.goals.throw_failure();
  node_ = expanded;
}

CoverSearch::Mode CoverSearch::mode(std::uint32_t discrete, const std::int32_t* slots) {
  Search& search = *search_;
  if (search.modes.size() <= discrete) {
    const std::size_t size = std::max<std::size_t>(discrete + std::size_t{1}, 2 * search.modes.size());
    search.modes.resize(size, Mode::unknown);
    search.latest.resize(size, no_node);
  }
  Mode& mode = search.modes[discrete];
  if (mode == Mode::unknown) {
    const bool exact = !hulls_ || searches_ > searches_by_locations ||
                       (!exact_.empty() && (exact_.contains(state(slots)) || exact_.contains(locations(slots))));
    mode = exact ? Mode::exact : Mode::hull;
  }
  return mode;
}

CoverSearch::Key CoverSearch::state(const std::int32_t* slots) const {
  return {slots, slots + graph_.program().state_slots};
}

CoverSearch::Key CoverSearch::locations(const std::int32_t* slots) const {
  return {slots, slots + graph_.program().processes.size()};
}

void CoverSearch::keep_all_zones_of(const std::int32_t* slots) {
  exact_.insert(searches_ <= searches_by_state ? state(slots) : locations(slots));
}

bool CoverSearch::refine(std::uint32_t node) {
  std::vector<std::int32_t> slots(graph_.program().slots.size());
  bool found = false;
  for (std::uint32_t at = node; at != no_node; at = search_->passed.parent(at)) {
    if (!search_->widened[at]) continue;
    search_->passed.unpack(at, slots.data());
    keep_all_zones_of(slots.data());
    found = true;
  }
  if (!found) return false;
  ++searches_;
  search_ = std::make_unique<Search>(graph_, options_, search_->lost.aims());
  return true;
}

Statistics CoverSearch::statistics() const {
  return {explored_, search_->passed.stored(), transitions_, search_->passed.bytes() + search_->waiting.bytes()};
}

// ---- what it has found ----------------------------------------------------------------------------------------------

CoverParts& CoverSearch::cover() {
  if (!parts_.empty()) return parts_;
  const states::PassedList& passed = search_->passed;
  for (std::uint32_t node = 0; node < passed.size(); ++node)
    if (!passed.covered(node)) parts_.add(search_->passed, node, 0);
  return parts_;
}

}  // namespace tachk::reachability
