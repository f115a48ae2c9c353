#include "symbolic/zone_graph.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "zones/federation.hpp"

namespace tachk::symbolic {

using program::Program;
using zones::BoundLimits;
using zones::Raw;
using zones::Width;
using zones::ZoneOperations;

namespace {

Program prepared(Program program, const ZoneGraphOptions& options) {
  if (options.bounds == BoundScope::local) program = program::without_idle_clocks(std::move(program));
  if (!program.diagonals.empty()) program.interchangeable.clear();
  if (options.scale) program = program::in_largest_unit(std::move(program));
  return program;
}

// By how much a transition may advance clocks, as far as code does not compute it: a clock at the edge of the
// distinguished values may still get larger by so much.
Raw largest_advance(const Program& program) {
  std::vector<Raw> of_process(program.processes.size(), 0);
  for (const program::Edge& edge : program.edges) {
    Raw whole = 0;
    for (const zones::ClockReset& reset : edge.update.resets)
      if (reset.source != 0) whole += reset.value;
    of_process[edge.process] = std::max(of_process[edge.process], whole);
  }
  return std::accumulate(of_process.begin(), of_process.end(), Raw{0});
}

Width choose_width(const Program& program, const ZoneGraphOptions& options) {
  // Without extrapolation entries grow with the depth.
  if (options.extrapolation == Extrapolation::none) return Width::widest;
  const Raw largest = std::max(program.largest_constant * (program.copies_clocks ? 4 : 1), largest_advance(program));
  if (options.width == Width::narrow && largest <= BoundLimits<std::int16_t>::largest_constant) return Width::narrow;
  if (options.width != Width::widest && largest <= BoundLimits<std::int32_t>::largest_constant) return Width::wide;
  return Width::widest;
}

ZoneOperations choose_operations(const Program& program, const ZoneGraphOptions& options) {
  if (program.largest_constant > BoundLimits<std::int64_t>::largest_constant)
    throw std::overflow_error("a clock constant is too large");
  return zones::select_operations(program.dimension(), choose_width(program, options), options.vector);
}

// Where zones of many clocks are stored without those that do not matter: the operations for what remains.
std::vector<ZoneOperations> choose_smaller(const Program& program, const ZoneGraphOptions& options) {
  std::vector<ZoneOperations> operations;
  constexpr int most_clocks = 1024;
  const bool packs =
      options.bounds == BoundScope::local && options.extrapolation != Extrapolation::none && program.diagonals.empty();
  if (!packs || program.clocks > most_clocks || static_cast<std::uint32_t>(program.clocks) <= options.pack_clocks)
    return operations;
  operations.resize(1);
  for (int dimension = 1; dimension < program.dimension(); ++dimension)
    operations.push_back(zones::select_operations(dimension, choose_width(program, options), options.vector));
  return operations;
}

}  // namespace

ZoneGraph::ZoneGraph(Program program, const ZoneGraphOptions& options)
    : program_(prepared(std::move(program), options)),
      options_(options),
      operations_(choose_operations(program_, options)),
      smaller_(choose_smaller(program_, options)),
      semantics_(program_, operations_),
      active_(program_, semantics_, operations_, smaller_),
      abstraction_(program_, semantics_, operations_, options.extrapolation, options.bounds),
      representatives_(program_, operations_),
      equivalent_(program_, operations_),
      target_(operations_) {}

SymbolicState ZoneGraph::blank() const {
  return {std::vector<std::int32_t>(program_.slots.size()), zones::ZoneBuffer(operations_)};
}

SymbolicState ZoneGraph::copy(const Successor& successor) const {
  SymbolicState state{{successor.slots, successor.slots + program_.slots.size()}, zones::ZoneBuffer(operations_)};
  state.zone.assign(successor.zone);
  return state;
}

bool ZoneGraph::begin() {
  effect_.slots.clear();
  for (const program::Slot& slot : program_.slots) effect_.slots.push_back(slot.initial);
  effect_.written = program::SlotSet::all();
  effect_.resets = program_.starts;
  effect_.invariant.clear();
  return semantics_.invariant(effect_.slots.data(), effect_.invariant);
}

bool ZoneGraph::enter(zones::ConstZoneRef guarded, const Effect& effect) {
  const int dimension = program_.dimension();
  target_.assign(guarded);
  operations_.reset(target_.get(), dimension, effect.resets.data(), effect.resets.size());
  return operations_.intersect(target_.get(), dimension, effect.invariant.data(), effect.invariant.size());
}

void ZoneGraph::delay(Effect& effect) {
  const std::vector<zones::Atom>& invariant = effect.invariant;
  std::int32_t* slots = effect.slots.data();
  if (!semantics_.time_passes(slots)) return;
  const std::uint8_t* stopped = semantics_.stopped_clocks(slots);
  operations_.up_within(target_.get(), program_.dimension(), stopped, invariant.data(), invariant.size());
}

template <class Body>
bool ZoneGraph::within(std::span<const std::uint32_t> edges, Body&& body) {
  try {
    return body();
  } catch (const machine::ModelFault& fault) {
    throw ActionFault(fault, edges);
  }
}

void ZoneGraph::start_for(ReceiverOfSuccessors& receiver) {
  if (beginnings_) {
    for (const SymbolicState& state : *beginnings_) {
      effect_.slots = state.slots;
      effect_.written = program::SlotSet::all();
      receiver.expect(effect_);
      const Successor beginning{{}, effect_.slots.data(), state.zone.get()};
      if (receiver.wants(beginning)) receiver.take(beginning);
    }
    return;
  }
  if (!begin()) return;
  zones::ZoneBuffer zero(operations_);
  operations_.make_zero(zero.get(), program_.dimension());
  follow({}, zero.get(), effect_, receiver);
}

void ZoneGraph::expand_for(SymbolicState& source, ReceiverOfSuccessors& receiver) {
  if (program_.has_priorities) return expand_by_priority(source, receiver);
  std::int32_t* slots = source.slots.data();
  const bool sorts = representatives_.active();
  const bool counts = receiver.counts();
  if (sorts) equivalent_.find(slots, source.zone.get());
  const auto visit = [&](const Action& action, zones::ConstZoneRef guarded) {
    check_patience();
    if (!receiver.admits(action.edges)) return;
    const bool repeats = sorts && equivalent_.repeats(action.edges);
    if (repeats && !counts) return;
    if (!within(action.edges, [&] { return semantics_.apply(action.edges, slots, effect_); })) return;
    receiver.possible(guarded, effect_);
    if (!repeats) follow(action.edges, guarded, effect_, receiver);
  };
  const auto skips = [&](std::size_t process) { return sorts && !counts && equivalent_.second(process); };
  semantics_.for_each_action(slots, source.zone.get(), visit, skips);
}

// An action may only fire in valuations in which no action of higher priority is possible.
void ZoneGraph::expand_by_priority(SymbolicState& source, ReceiverOfSuccessors& receiver) {
  struct Ranked {
    Edges edges;
    zones::ZoneBuffer guarded;
    std::vector<zones::Atom> possible;  // where the action is possible: guard and precondition of the target invariant
    Effect effect;
    std::pair<std::int32_t, std::int32_t> priority;
  };
  std::int32_t* slots = source.slots.data();
  std::vector<Ranked> actions;
  semantics_.for_each_action(slots, source.zone.get(), [&](const Action& action, zones::ConstZoneRef guarded) {
    check_patience();
    Ranked ranked{action.edges, zones::ZoneBuffer(operations_), action.guard, {}, {}};
    ranked.guarded.assign(guarded);
    if (!within(action.edges, [&] { return semantics_.apply(action.edges, slots, ranked.effect); })) return;
    if (!semantics_.weakest_precondition(ranked.effect, ranked.possible)) return;
    receiver.possible(guarded, ranked.effect);
    ranked.priority = semantics_.priority(action.edges, slots);
    actions.push_back(std::move(ranked));
  });
  for (Ranked& action : actions) {
    zones::Federation first(operations_, program_.dimension());  // where no action of higher priority is possible
    first.add(action.guarded.get());
    for (const Ranked& other : actions)
      if (other.priority > action.priority) first.subtract(other.possible);
    for (std::size_t piece = 0; piece < first.size(); ++piece) {
      check_patience();
      Effect effect = action.effect;
      follow(action.edges, first[piece], effect, receiver);
    }
  }
}

void ZoneGraph::follow(std::span<const std::uint32_t> edges, zones::ConstZoneRef guarded, Effect& effect,
                       ReceiverOfSuccessors& receiver) {
  if (representatives_.active()) {
    if (enter(guarded, effect)) follow_sorted(edges, effect, receiver);
    return;
  }
  receiver.expect(effect);
  if (!enter(guarded, effect)) return;
  std::int32_t* slots = effect.slots.data();
  if (!receiver.enters(Successor{edges, slots, target_.get()}, effect.invariant)) return;
  within(edges, [&] { return delay(effect), true; });
  if (!receiver.wants(Successor{edges, slots, target_.get()})) return;
  abstraction_.apply(slots, target_, [&](zones::ConstZoneRef zone) { receiver.take(Successor{edges, slots, zone}); });
}

// There are no diagonals here, so that a state has one zone.
void ZoneGraph::follow_sorted(std::span<const std::uint32_t> edges, Effect& effect, ReceiverOfSuccessors& receiver) {
  std::int32_t* slots = effect.slots.data();
  if (!receiver.enters(Successor{edges, slots, target_.get()}, effect.invariant)) return;
  within(edges, [&] { return delay(effect), true; });
  abstraction_.apply(slots, target_, [](zones::ConstZoneRef) {});
  representatives_.sort(slots, target_);
  effect.written = program::SlotSet::all();
  receiver.expect(effect);
  const Successor successor{edges, slots, target_.get()};
  if (receiver.wants(successor)) receiver.take(successor);
}

}  // namespace tachk::symbolic
