#include "reachability/explorer.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace tachk {
namespace {

struct ConstantOverflow {};

Width choose_width(const Program& program, const Options& options) {
  // Without extrapolation entries grow with the depth.
  if (options.extrapolation == Extrapolation::none) return Width::widest;
  const Raw largest = program.largest_constant;
  if (options.least_width == Width::narrow && largest <= BoundLimits<std::int16_t>::largest_constant)
    return Width::narrow;
  if (options.least_width != Width::widest && largest <= BoundLimits<std::int32_t>::largest_constant)
    return Width::wide;
  return Width::widest;
}

ZoneOperations choose_operations(const Program& program, const Options& options) {
  if (program.largest_constant > BoundLimits<std::int64_t>::largest_constant)
    throw std::overflow_error("a clock constant is too large");
  return select_operations(program.dimension(), choose_width(program, options), options.vector);
}

// Where zones of many clocks are stored without those that do not matter: the operations for what remains.
std::vector<ZoneOperations> smaller_operations(const Program& program, const Options& options) {
  std::vector<ZoneOperations> operations;
  constexpr int most_clocks = 1024;
  const bool packs = options.local_bounds && options.extrapolation != Extrapolation::none && program.diagonals.empty();
  if (!packs || program.clocks > most_clocks || static_cast<std::uint32_t>(program.clocks) <= options.pack_clocks)
    return operations;
  operations.resize(1);
  for (int dimension = 1; dimension < program.dimension(); ++dimension)
    operations.push_back(select_operations(dimension, choose_width(program, options), options.vector));
  return operations;
}

Program prepared(Program program, const Options& options) {
  if (options.local_bounds) program = without_idle_clocks(std::move(program));
  if (options.scale) program = in_largest_unit(std::move(program));
  return program;
}

}  // namespace

Explorer::Explorer(Program program, const Options& options)
    : program_(prepared(std::move(program), options)),
      options_(options),
      operations_(choose_operations(program_, options)),
      dimension_(program_.dimension()),
      semantics_(program_, operations_),
      active_(program_, semantics_, operations_, smaller_operations(program_, options)),
      passed_(program_, operations_, options.chunk_words, options.reclaim, smaller_operations(program_, options)),
      random_(options.seed),
      reached_(program_.goals.size(), no_node),
      deadlocks_(operations_, dimension_),
      lower_(operations_, dimension_),
      upper_(operations_, dimension_),
      source_(program_.slots.size()),
      source_zone_(operations_),
      target_(operations_),
      scratch_(operations_) {
  for (std::size_t goal = 0; goal < program_.goals.size(); ++goal) {
    open_goals_.push_back(goal);
    const std::vector<Disjunct>& disjuncts = program_.goals[goal].disjuncts;
    asks_deadlock_.push_back(std::any_of(disjuncts.begin(), disjuncts.end(), [](const Disjunct& disjunct) {
      return disjunct.deadlock != DeadlockLiteral::absent;
    }));
    deadlock_open_ |= asks_deadlock_.back();
  }
  if (options_.shortest && options_.order != SearchOrder::breadth_first)
    throw std::invalid_argument("shortest paths need a breadth-first search");
  // Steps are counted in stored states.
  if (options_.shortest || options_.depth_limit != UINT32_MAX) options_.passing = 0;
  prepare_bounds();
  watch_goals();
}

// ---- what becomes of successors -------------------------------------------------------------------------------------

// Stores them.
struct Explorer::Collector {
  Explorer& explorer;
  std::uint32_t parent;
  std::uint32_t discrete = 0;
  bool passes = false;

  void possible(ConstZoneRef guarded, const Effect& effect) const { explorer.pass_to_deadlock(guarded, effect); }
  void expect(const Effect& effect) const {
    // The state unpacked last is the stored one, not one that is passed through.
    const SlotSet& written = explorer.current_actions_.empty() ? effect.written : SlotSet::all();
    explorer.passed_.announce(effect.slots.data(), written);
  }
  bool wants(std::int32_t* slots, ConstZoneRef zone) {
    if (parent != no_node) ++explorer.transitions_;
    passes = explorer.passes_ && parent != no_node && explorer.is_passing(slots, explorer.current_actions_.size());
    if (passes) return true;
    discrete = explorer.passed_.locate();
    return !explorer.options_.subsumption || !explorer.passed_.covers(discrete, explorer.active_.packed(slots, zone));
  }
  void take(std::int32_t* slots, ConstZoneRef zone) {
    if (passes) {
      if (!explorer.meets_an_open_goal(slots, zone)) return explorer.pass_through(slots, zone);
      discrete = explorer.passed_.locate();
    }
    explorer.add(discrete, slots, zone, parent);
  }
};

// Keeps the states that may be those of a node, each once, with the actions that lead there, and those passed through.
struct Explorer::Recogniser {
  Explorer& explorer;
  const Node& node;
  std::vector<State>& states;
  std::vector<Step>& steps;
  std::size_t previous = 0;

  void possible(ConstZoneRef, const Effect&) const {}
  void expect(const Effect&) const {}
  bool passes(const std::int32_t* slots) const {
    return explorer.current_edges_ != nullptr && explorer.is_passing(slots, explorer.current_actions_.size());
  }
  bool wants(std::int32_t* slots, ConstZoneRef) const { return explorer.passed_.equals(node, slots) || passes(slots); }
  void take(std::int32_t* slots, ConstZoneRef zone) const {
    if (passes(slots)) explorer.pass_through(slots, zone);
    if (!explorer.passed_.equals(node, slots)) return;
    if (!explorer.passed_.may_equal(node, explorer.active_.packed(slots, zone))) return;
    for (const State& state : states)
      if (std::memcmp(state.zone.get().bytes, zone.bytes, explorer.operations_.bytes) == 0) return;
    states.push_back({{slots, slots + explorer.program_.slots.size()}, ZoneBuffer(explorer.operations_)});
    states.back().zone.assign(zone);
    steps.push_back({explorer.actions_so_far(), previous});
  }
};

// Keeps what an action leads to, or all there is where no action has been taken yet.
struct Explorer::Follower {
  Explorer& explorer;
  std::vector<State>& states;
  const std::vector<std::uint32_t>* edges = nullptr;

  void possible(ConstZoneRef, const Effect&) const {}
  void expect(const Effect&) const {}
  bool wants(std::int32_t*, ConstZoneRef) const { return edges == nullptr || *explorer.current_edges_ == *edges; }
  void take(std::int32_t* slots, ConstZoneRef zone) const {
    states.push_back({{slots, slots + explorer.program_.slots.size()}, ZoneBuffer(explorer.operations_)});
    states.back().zone.assign(zone);
  }
};

// Wants no successors, only to know whether there are any.
struct Explorer::Prober {
  Explorer& explorer;

  void possible(ConstZoneRef guarded, const Effect& effect) const { explorer.pass_to_deadlock(guarded, effect); }
  void expect(const Effect&) const {}
  bool wants(std::int32_t*, ConstZoneRef) const { return false; }
  void take(std::int32_t*, ConstZoneRef) const {}
};

// ---- the loop -------------------------------------------------------------------------------------------------------

Status Explorer::run(std::uint64_t expansions) {
  if (fault_) return Status::fault;
  try {
    return explore(expansions);
  } catch (const ModelFault& fault) {
    fault_ = FaultReport{fault.kind, fault.position, current_node_, current_actions_, {}};
    if (current_edges_ != nullptr) fault_->edges = *current_edges_;
    return Status::fault;
  } catch (const ConstantOverflow&) {
    return Status::constant_limit;
  }
}

Status Explorer::explore(std::uint64_t expansions) {
  if (!std::exchange(started_, true)) {
    fresh_.clear();
    start(Collector{*this, no_node});
    if (options_.order != SearchOrder::breadth_first) stack_ = fresh_;
  }
  while (!all_reached()) {
    if (expansions-- == 0) return Status::running;
    const std::uint32_t number = next_waiting();
    if (number == no_node) return too_deep_ ? Status::depth_limit : Status::finished;
    if (options_.shortest) {
      if (number >= layer_end_) begin_layer();
      if (all_reached()) break;
      passed_.protect(cursor_, layer_end_);
    }
    if (passed_.covered(number)) continue;
    if (!depth_.empty() && depth_[number] >= options_.depth_limit) {
      too_deep_ = true;
      continue;
    }
    const Node node = passed_.node(number);
    passed_.unpack(node, source_.data());
    active_.unpack(source_.data(), passed_.zone(node), source_zone_);
    const ConstZoneRef zone = source_zone_.get();
    current_node_ = number;
    ++explored_;
    fresh_.clear();
    if (deadlock_open_) begin_deadlock(zone);
    current_actions_.clear();
    passes_ = options_.passing != 0 && !deadlock_open_;
    expand(zone, Collector{*this, number});
    if (deadlock_open_) end_deadlock(number);
    while (!passing_.empty()) {
      expand_passing([&] { return Collector{*this, number}; });
      ++explored_;
    }
    if (options_.order == SearchOrder::random_depth_first) std::shuffle(fresh_.begin(), fresh_.end(), random_);
    if (options_.order != SearchOrder::breadth_first) stack_.insert(stack_.end(), fresh_.begin(), fresh_.end());
    if (passed_.stored() > options_.state_limit) return Status::state_limit;
    if (options_.memory_limit != UINT64_MAX && statistics().bytes > options_.memory_limit) return Status::memory_limit;
  }
  return Status::finished;
}

bool Explorer::is_passing(const std::int32_t* slots, std::size_t actions) const {
  if (!passes_ || actions >= options_.passing) return false;
  std::size_t committed = 0;
  for (std::size_t p = 0; p < program_.processes.size(); ++p) committed += semantics_.location(p, slots).committed;
  return committed == 1;
}

std::vector<std::vector<std::uint32_t>> Explorer::actions_so_far() const {
  std::vector<std::vector<std::uint32_t>> actions = current_actions_;
  if (current_edges_ != nullptr) actions.push_back(*current_edges_);
  return actions;
}

void Explorer::pass_through(std::int32_t* slots, ConstZoneRef zone) {
  passing_.push_back({{{slots, slots + program_.slots.size()}, ZoneBuffer(operations_)}, actions_so_far()});
  passing_.back().state.zone.assign(zone);
}

template <class MakeSink>
void Explorer::expand_passing(MakeSink&& make_sink) {
  Passing passing = std::move(passing_.back());
  passing_.pop_back();
  source_ = passing.state.slots;
  current_actions_ = std::move(passing.actions);
  expand(passing.state.zone.get(), make_sink());
  current_actions_.clear();
}

template <class Sink>
void Explorer::start(Sink&& sink) {
  for (std::size_t slot = 0; slot < program_.slots.size(); ++slot) source_[slot] = program_.slots[slot].initial;
  effect_.slots = source_;
  effect_.written = SlotSet::all();
  effect_.resets.clear();
  effect_.invariant.clear();
  if (!semantics_.invariant(effect_.slots.data(), effect_.invariant)) return;
  operations_.make_zero(scratch_.get(), dimension_);
  finish(scratch_.get(), effect_, sink);
}

std::uint32_t Explorer::next_waiting() {
  if (options_.order == SearchOrder::breadth_first) return cursor_ < passed_.size() ? cursor_++ : no_node;
  if (stack_.empty()) return no_node;
  const std::uint32_t number = stack_.back();
  stack_.pop_back();
  return number;
}

void Explorer::add(std::uint32_t discrete, std::int32_t* slots, ConstZoneRef zone, std::uint32_t parent) {
  const std::uint32_t number = passed_.add(discrete, active_.packed(slots, zone), parent, options_.subsumption);
  if (number == no_node) return;
  if (options_.depth_limit != UINT32_MAX) depth_.push_back(parent == no_node ? 0 : depth_[parent] + 1);
  fresh_.push_back(number);
  check_goals(number, slots, zone);
}

// What is reached by now is no further away than what this layer leads to.
void Explorer::begin_layer() {
  layer_end_ = passed_.size();
  std::erase_if(open_goals_, [this](std::size_t goal) { return reached_[goal] != no_node; });
}

bool Explorer::all_reached() const { return open_goals_.empty() && !program_.goals.empty(); }

Statistics Explorer::statistics() const {
  return {explored_, passed_.stored(), transitions_,
          passed_.bytes() + (stack_.capacity() + depth_.capacity()) * sizeof(std::uint32_t)};
}

std::optional<std::uint32_t> Explorer::reached(std::size_t goal) const {
  return reached_[goal] == no_node ? std::nullopt : std::optional(reached_[goal]);
}

// ---- successors -----------------------------------------------------------------------------------------------------

template <class Sink>
void Explorer::expand(ConstZoneRef zone, Sink&& sink) {
  if (program_.has_priorities) {
    expand_by_priority(zone, sink);
    return;
  }
  semantics_.for_each_action(source_.data(), zone, [&](const Action& action, ConstZoneRef guarded) {
    current_edges_ = &action.edges;
    if (semantics_.apply(action.edges, source_.data(), effect_)) {
      sink.possible(guarded, effect_);
      finish(guarded, effect_, sink);
    }
    current_edges_ = nullptr;
  });
}

// An action may only fire in valuations in which no action of higher priority is possible.
template <class Sink>
void Explorer::expand_by_priority(ConstZoneRef zone, Sink&& sink) {
  struct Ranked {
    std::vector<std::uint32_t> edges;
    ZoneBuffer guarded;
    std::vector<Atom> possible;  // where the action is possible: guard and precondition of the target invariant
    Effect effect;
    std::pair<std::int32_t, std::int32_t> priority;
  };
  std::vector<Ranked> actions;
  semantics_.for_each_action(source_.data(), zone, [&](const Action& action, ConstZoneRef guarded) {
    Ranked ranked{action.edges, ZoneBuffer(operations_), action.guard, {}, {}};
    ranked.guarded.assign(guarded);
    current_edges_ = &action.edges;
    const bool possible = semantics_.apply(action.edges, source_.data(), ranked.effect) &&
                          semantics_.weakest_precondition(ranked.effect, ranked.possible);
    current_edges_ = nullptr;
    if (!possible) return;
    sink.possible(guarded, ranked.effect);
    ranked.priority = semantics_.priority(action.edges, source_.data());
    actions.push_back(std::move(ranked));
  });
  for (Ranked& action : actions) {
    Federation first(operations_, dimension_);  // where no action of higher priority is possible
    first.add(action.guarded.get());
    for (const Ranked& other : actions)
      if (other.priority > action.priority) first.subtract(other.possible);
    current_edges_ = &action.edges;
    for (std::size_t piece = 0; piece < first.size(); ++piece) {
      Effect effect = action.effect;
      finish(first[piece], effect, sink);
    }
    current_edges_ = nullptr;
  }
}

template <class Sink>
void Explorer::finish(ConstZoneRef zone, Effect& effect, Sink&& sink) {
  const std::vector<Atom>& invariant = effect.invariant;
  sink.expect(effect);
  target_.assign(zone);
  operations_.reset(target_.get(), dimension_, effect.resets.data(), effect.resets.size());
  if (!operations_.intersect(target_.get(), dimension_, invariant.data(), invariant.size())) return;
  if (semantics_.time_passes(effect.slots.data()))
    operations_.up_within(target_.get(), dimension_, semantics_.stopped_clocks(effect.slots.data()), invariant.data(),
                          invariant.size());
  // A zone that is covered as it is need not be abstracted first: most successors end here.
  if (sink.wants(effect.slots.data(), target_.get())) abstract(effect, target_, sink);
}

template <class Sink>
void Explorer::abstract(Effect& effect, ZoneBuffer& zone, Sink&& sink) {
  if (options_.extrapolation == Extrapolation::none) {
    check_magnitude(zone.get());
    sink.take(effect.slots.data(), zone.get());
    return;
  }
  collect_bounds(effect.slots.data());
  if (!program_.diagonals.empty()) {
    std::vector<Atom> sides;
    split(0, effect, ZoneBuffer(zone), sides, sink);
    return;
  }
  operations_.extrapolate_lu_plus(zone.get(), dimension_, lower_.get(), upper_.get());
  sink.take(effect.slots.data(), zone.get());
}

// `sides`: for each diagonal seen so far the side on which the piece lies.
template <class Sink>
void Explorer::split(std::size_t diagonal, Effect& effect, const ZoneBuffer& zone, std::vector<Atom>& sides,
                     Sink&& sink) {
  if (diagonal == program_.diagonals.size()) {
    ZoneBuffer piece(zone);
    operations_.extrapolate_max(piece.get(), dimension_, upper_.get());
    if (!operations_.intersect(piece.get(), dimension_, sides.data(), sides.size()))
      throw std::logic_error("extrapolation lost a zone");
    sink.take(effect.slots.data(), piece.get());
    return;
  }
  const Atom inside = program_.diagonals[diagonal];
  for (const Atom side : {inside, negated(inside)}) {
    ZoneBuffer piece(zone);
    if (!operations_.intersect(piece.get(), dimension_, &side, 1)) continue;
    sides.push_back(side);
    split(diagonal + 1, effect, piece, sides, sink);
    sides.pop_back();
  }
}

// Of a covered node only half a hash of the zone is known, so that two states may seem to be its own: all are followed.
// Each is reached by the actions noted for it, so that whichever remains at the end has been reached.
std::vector<std::vector<std::uint32_t>> Explorer::path(std::uint32_t node) {
  // Whether a state was passed through depended on the goals open at the time: any may have been.
  passes_ = options_.passing != 0;
  current_actions_.clear();
  passing_.clear();
  std::vector<std::uint32_t> chain;
  for (std::uint32_t number = node; number != no_node; number = passed_.node(number).parent) chain.push_back(number);
  std::vector<std::vector<Step>> steps(chain.size());
  std::vector<State> states;
  std::vector<State> next;
  for (std::size_t layer = 0; layer < chain.size(); ++layer) {
    const Node child = passed_.node(chain[chain.size() - 1 - layer]);
    next.clear();
    if (layer == 0) start(Recogniser{*this, child, next, steps[layer]});
    for (std::size_t number = 0; number < states.size(); ++number) {
      source_ = states[number].slots;
      try {
        const Recogniser recogniser{*this, child, next, steps[layer], number};
        expand(states[number].zone.get(), recogniser);
        while (!passing_.empty()) expand_passing([&] { return recogniser; });
      } catch (const ModelFault&) {
        // The search stopped at this fault, in an action behind the one looked for.
      }
      current_edges_ = nullptr;
      current_actions_.clear();
      passing_.clear();
    }
    states.swap(next);
    if (states.empty()) throw std::logic_error("a stored state is not a successor of its parent");
  }
  std::vector<std::vector<std::uint32_t>> actions;  // from the last to the first
  std::size_t number = 0;
  for (std::size_t layer = chain.size() - 1; layer > 0; --layer) {
    Step& step = steps[layer][number];
    std::move(step.actions.rbegin(), step.actions.rend(), std::back_inserter(actions));
    number = step.previous;
  }
  std::reverse(actions.begin(), actions.end());
  return actions;
}

bool Explorer::leads_to(const std::vector<std::vector<std::uint32_t>>& actions, std::size_t goal) {
  std::vector<State> states;
  std::vector<State> next;
  try {
    start(Follower{*this, states});
    for (const std::vector<std::uint32_t>& action : actions) {
      next.clear();
      for (const State& state : states) {
        source_ = state.slots;
        expand(state.zone.get(), Follower{*this, next, &action});
      }
      states.swap(next);
    }
    for (State& state : states) {
      source_ = state.slots;
      check_goals(0, state.slots.data(), state.zone.get());
      if (!deadlock_open_) continue;
      begin_deadlock(state.zone.get());
      expand(state.zone.get(), Prober{*this});
      end_deadlock(0);
    }
  } catch (const ModelFault&) {
    current_edges_ = nullptr;
  } catch (const ConstantOverflow&) {
    current_edges_ = nullptr;
  }
  return reached_[goal] != no_node;
}

// ---- zones ----------------------------------------------------------------------------------------------------------

void Explorer::check_magnitude(ConstZoneRef zone) const {
  for (int i = 0; i < dimension_; ++i)
    for (int j = 0; j < dimension_; ++j) {
      const Raw raw = operations_.entry(zone, dimension_, i, j);
      if (raw != unbounded_entry && std::abs(raw) > operations_.legal / 4) throw ConstantOverflow{};
    }
}

void Explorer::prepare_bounds() {
  const bool separate = options_.extrapolation == Extrapolation::lu && program_.diagonals.empty();
  for (const Process& process : program_.processes)
    for (const Location& location : process.locations) {
      std::vector<Raw> lower(static_cast<std::size_t>(dimension_), not_compared);
      std::vector<Raw> upper(static_cast<std::size_t>(dimension_), not_compared);
      if (options_.local_bounds) {
        for (const ClockBound& bound : location.lower) lower[bound.clock] = std::max(lower[bound.clock], bound.value);
        for (const ClockBound& bound : location.upper) upper[bound.clock] = std::max(upper[bound.clock], bound.value);
      } else {
        lower = program_.maximum_constants;
        upper = program_.maximum_constants;
      }
      BoundRowBuffer lower_row(operations_, dimension_);
      BoundRowBuffer upper_row(operations_, dimension_);
      bool present = false;
      for (int clock = 1; clock < dimension_; ++clock) {
        const auto c = static_cast<std::size_t>(clock);
        const Raw both = std::max(lower[c], upper[c]);
        operations_.set_bound(lower_row.get(), clock, separate ? lower[c] : both);
        operations_.set_bound(upper_row.get(), clock, separate ? upper[c] : both);
        present |= both >= 0;
      }
      bounds_.lower.push_back(std::move(lower_row));
      bounds_.upper.push_back(std::move(upper_row));
      bounds_.present.push_back(present);
    }
  bounds_.lower.emplace_back(operations_, dimension_);
  bounds_.upper.emplace_back(operations_, dimension_);
}

void Explorer::collect_bounds(const std::int32_t* slots) {
  lower_rows_.assign(1, bounds_.lower.back().get());
  upper_rows_.assign(1, bounds_.upper.back().get());
  for (std::size_t p = 0; p < program_.processes.size(); ++p) {
    const std::size_t number = semantics_.location_number(p, slots[p]);
    if (!bounds_.present[number]) continue;
    lower_rows_.push_back(bounds_.lower[number].get());
    upper_rows_.push_back(bounds_.upper[number].get());
  }
  operations_.maximise_bounds(lower_.get(), lower_rows_.data(), lower_rows_.size(), dimension_);
  operations_.maximise_bounds(upper_.get(), upper_rows_.data(), upper_rows_.size(), dimension_);
}

}  // namespace tachk
