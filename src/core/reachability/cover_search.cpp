#include "reachability/cover_search.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tachk {
namespace {

constexpr int attempts_by_state = 12;      // before all discrete states with the same locations keep their zones
constexpr int attempts_by_locations = 24;  // before all discrete states do
constexpr std::uint16_t most_growths = 64;

// Zones are stored whole, and no state is left out.
Options plain(Options options) {
  options.pack_clocks = UINT32_MAX;
  options.passing = 0;
  options.shortest = false;
  options.subsumption = true;
  options.order = SearchOrder::breadth_first;
  return options;
}

Raw sum(Raw a, Raw b) { return a == unbounded_entry || b == unbounded_entry ? unbounded_entry : a + b - ((a | b) & 1); }

}  // namespace

CoverSearch::Attempt::Attempt(ZoneGraph& graph, const Options& options)
    : passed(graph.program(), graph.operations(), options.chunk_words, options.reclaim, graph.smaller_operations()),
      waiting(options.order, options.seed, UINT32_MAX),
      goals(graph.program(), graph.semantics(), graph.operations(), false),
      deadlocks(graph, goals) {}

CoverSearch::CoverSearch(Program program, const Options& options, const Limits& limits, bool hulls)
    : options_(plain(options)),
      limits_(limits),
      graph_(std::move(program), options_),
      hulls_(hulls),
      attempt_(std::make_unique<Attempt>(graph_, options_)),
      source_(graph_.blank()),
      hull_(graph_.operations()) {}

std::size_t CoverSearch::KeyHash::operator()(const Key& key) const {
  std::uint64_t hash = key.size();
  for (const std::int32_t number : key) hash = (hash ^ static_cast<std::uint32_t>(number)) * 0x9E3779B97F4A7C15u;
  return static_cast<std::size_t>(hash ^ hash >> 32);
}

// ---- the search -----------------------------------------------------------------------------------------------------

struct CoverSearch::Keeping {
  CoverSearch& search;
  std::uint32_t discrete = 0;

  void possible(ConstZoneRef guarded, const Effect& effect) const { search.attempt_->deadlocks.pass(guarded, effect); }
  void expect(const Effect& effect) const { search.attempt_->passed.announce(effect.slots.data(), SlotSet::all()); }
  bool wants(const Successor& successor) {
    if (!successor.edges.empty()) ++search.transitions_;
    discrete = search.attempt_->passed.locate();
    return !search.attempt_->passed.covers(discrete, {successor.zone, search.graph_.program().dimension()});
  }
  void take(const Successor& successor) const { search.keep(successor, discrete); }
};

Status CoverSearch::search(std::uint64_t expansions) {
  while (true) {
    if (!std::exchange(attempt_->started, true)) {
      node_ = no_node;
      graph_.start(Keeping{*this});
    }
    while (!attempt_->goals.settled()) {
      if (expansions-- == 0) return Status::running;
      const std::uint32_t node = attempt_->waiting.next();
      if (node == no_node) return Status::finished;
      if (attempt_->passed.covered(node)) continue;
      expand(node);
      if (attempt_->passed.stored() > limits_.states) return Status::state_limit;
      if (limits_.memory_bytes != UINT64_MAX && statistics().bytes > limits_.memory_bytes) return Status::memory_limit;
    }
    if (refine(attempt_->goals.node(0))) continue;
    reached_ = true;
    return Status::finished;
  }
}

Status CoverSearch::run(std::uint64_t expansions) {
  try {
    return search(expansions);
  } catch (const ModelFault&) {
    return node_ != no_node && refine(node_) ? Status::running : Status::fault;
  } catch (const ConstantOverflow&) {
    return Status::constant_limit;
  }
}

void CoverSearch::expand(std::uint32_t number) {
  const Node node = attempt_->passed.node(number);
  attempt_->passed.unpack(node, source_.slots.data());
  source_.zone.assign(attempt_->passed.zone(node));
  node_ = number;
  ++explored_;
  attempt_->deadlocks.begin(source_);
  graph_.expand(source_, Keeping{*this});
  attempt_->deadlocks.end(number, source_);
}

void CoverSearch::keep(const Successor& successor, std::uint32_t discrete) {
  Attempt& attempt = *attempt_;
  const int dimension = graph_.program().dimension();
  ConstZoneRef zone = successor.zone;
  bool widened = false;
  if (mode(discrete, successor.slots) == Mode::hull) {
    if (const std::uint32_t before = attempt.latest[discrete]; before != no_node) {
      const ConstZoneRef held = attempt.passed.zone(attempt.passed.node(before));
      widened = !graph_.operations().includes(zone, held, dimension);
      hull_.assign(zone);
      graph_.operations().hull(hull_.get(), held, dimension);
      zone = hull_.get();
      if (widened && ++attempt.growths[discrete] > most_growths) attempt.modes[discrete] = Mode::exact;
    }
  }
  const std::uint32_t parent = successor.edges.empty() ? no_node : node_;
  const std::uint32_t number = attempt.passed.add(discrete, {zone, dimension}, parent, true);
  if (number == no_node) return;
  attempt.waiting.add(number, parent);
  attempt.latest[discrete] = number;
  attempt.widened.resize(number + std::size_t{1});
  attempt.widened[number] = widened;
  const std::uint32_t expanded = std::exchange(node_, number);  // a fault of the predicate is one of the new state
  attempt.goals.check(number, successor.slots, zone);
  node_ = expanded;
}

CoverSearch::Mode CoverSearch::mode(std::uint32_t discrete, const std::int32_t* slots) {
  Attempt& attempt = *attempt_;
  if (attempt.modes.size() <= discrete) {
    const std::size_t size = std::max<std::size_t>(discrete + std::size_t{1}, 2 * attempt.modes.size());
    attempt.modes.resize(size, Mode::unknown);
    attempt.latest.resize(size, no_node);
    attempt.growths.resize(size, 0);
  }
  Mode& mode = attempt.modes[discrete];
  if (mode == Mode::unknown) {
    const bool exact = !hulls_ || attempts_ > attempts_by_locations ||
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
  exact_.insert(attempts_ <= attempts_by_state ? state(slots) : locations(slots));
}

bool CoverSearch::refine(std::uint32_t node) {
  std::vector<std::int32_t> slots(graph_.program().slots.size());
  bool found = false;
  for (std::uint32_t at = node; at != no_node; at = attempt_->passed.node(at).parent) {
    if (!attempt_->widened[at]) continue;
    attempt_->passed.unpack(attempt_->passed.node(at), slots.data());
    keep_all_zones_of(slots.data());
    found = true;
  }
  if (!found) return false;
  ++attempts_;
  attempt_ = std::make_unique<Attempt>(graph_, options_);
  return true;
}

Statistics CoverSearch::statistics() const {
  return {explored_, attempt_->passed.stored(), transitions_, attempt_->passed.bytes() + attempt_->waiting.bytes()};
}

// ---- what it has found ----------------------------------------------------------------------------------------------

void CoverSearch::collect() {
  const PassedList& passed = attempt_->passed;
  for (std::uint32_t node = 0; node < passed.size(); ++node)
    if (!passed.covered(node)) ordered_.push_back(node);
  std::stable_sort(ordered_.begin(), ordered_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return passed.node(a).discrete < passed.node(b).discrete; });
  for (std::size_t at = 0; at < ordered_.size(); ++at)
    if (at == 0 || passed.node(ordered_[at]).discrete != passed.node(ordered_[at - 1]).discrete) first_.push_back(at);
}

std::size_t CoverSearch::groups() {
  if (ordered_.empty()) collect();
  return first_.size();
}

CoverPart CoverSearch::part(std::size_t first, std::size_t zones) {
  const std::size_t all = groups();
  CoverPart part;
  for (std::size_t group = first; group < all && (group == first || part.constraints.size() < zones); ++group) {
    const std::size_t end = group + 1 < all ? first_[group + 1] : ordered_.size();
    attempt_->passed.unpack(attempt_->passed.node(ordered_[first_[group]]), source_.slots.data());
    const Key discrete = state(source_.slots.data());
    part.discretes.insert(part.discretes.end(), discrete.begin(), discrete.end());
    part.zones.push_back(static_cast<std::int64_t>(end - first_[group]));
    for (std::size_t at = first_[group]; at < end; ++at) tell(attempt_->passed.node(ordered_[at]), part);
  }
  return part;
}

// The minimal constraints of Larsen, Larsson, Pettersson and Yi 1997: clocks at fixed distances form classes; a cycle
// through each class, and between the first members of classes what does not follow through a third one.
void CoverSearch::tell(const Node& node, CoverPart& part) const {
  const Program& program = graph_.program();
  const auto n = static_cast<std::size_t>(program.dimension());
  std::vector<Raw> entries(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      entries[i * n + j] = graph_.operations().entry(attempt_->passed.zone(node), program.dimension(),
                                                     static_cast<int>(i), static_cast<int>(j));
  const auto at = [&](std::size_t i, std::size_t j) { return entries[i * n + j]; };
  std::vector<std::size_t> original(n);  // of each clock its number in the program as it was given
  std::iota(original.begin(), original.end(), 0);
  for (std::size_t clock = 1; clock < program.clock_numbers.size(); ++clock)
    if (program.clock_numbers[clock] != 0) original[program.clock_numbers[clock]] = clock;
  const auto width = static_cast<std::size_t>(program.numbered_clocks()) + 1;
  std::int64_t told = 0;
  const auto add = [&](std::size_t i, std::size_t j) {
    if (i == 0 && at(i, j) == raw_zero) return;
    part.places.push_back(static_cast<std::int64_t>(original[i] * width + original[j]));
    part.bounds.push_back(2 * raw_value(at(i, j)) * program.time_unit + (at(i, j) & 1));
    ++told;
  };
  std::vector<std::size_t> first(n);  // of each clock the first member of its class
  for (std::size_t i = 0; i < n; ++i) {
    first[i] = i;
    std::size_t last = i;
    for (std::size_t j = 0; j < i; ++j)
      if (sum(at(i, j), at(j, i)) == raw_zero) {
        if (first[i] == i) first[i] = j;
        last = j;
      }
    if (last == i) continue;
    add(last, i);  // one way round from each member to the next, the way back from the last one to the first
    bool is_last = true;
    for (std::size_t j = i + 1; j < n; ++j) is_last &= sum(at(i, j), at(j, i)) != raw_zero;
    if (is_last) add(i, first[i]);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j || first[i] != i || first[j] != j || at(i, j) == unbounded_entry) continue;
      bool follows = false;
      for (std::size_t k = 0; k < n && !follows; ++k)
        follows = k != i && k != j && first[k] == k && sum(at(i, k), at(k, j)) <= at(i, j);
      if (!follows) add(i, j);
    }
  part.constraints.push_back(told);
}

}  // namespace tachk
