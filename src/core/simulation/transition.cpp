#include "simulation/transition.hpp"

#include <algorithm>
#include <bit>

namespace tachk::simulation {

using flow::Ticks;
using program::Edge;
using program::no_code;
using zones::ClockReset;

bool Transition::begin(Present& present) {
  *this = Transition(present.processes());
  if (present.program.has_stopwatches) switch_clocks(present);
  present.update_all_dependencies();
  for (std::size_t p = 0; p < present.processes(); ++p) concerned_.push_back(p);
  return invariants_hold(present);
}

bool Transition::enter(Present& present, std::span<const std::uint32_t> action) {
  const std::size_t width = present.program.state_slots;
  slots_.resize(width);
  std::copy_n(present.values.slots.begin(), width, slots_.begin());
  written_ = {};
  resets_.clear();
  values_.clear();
  switched_.clear();
  clocks_ = 0;
  under_way_ = true;
  update(present, action);
  if (present.program.has_stopwatches) switch_clocks(present);
  find_concerned(present, action);
  return invariants_hold(present);
}

void Transition::update(Present& present, std::span<const std::uint32_t> action) {
  const program::Program& program = present.program;
  Values& values = present.values;
  for (const std::uint32_t number : action) {
    const program::Update& update = program.edges[number].update;
    for (const program::Update::Store& store : update.stores) {
      values.slots[store.slot] = store.value;
      written_.add(store.slot);
    }
    resets_.insert(resets_.end(), update.resets.begin(), update.resets.end());
    if (update.code != no_code) present.machine.update(update.code, values.slots.data(), written_, resets_);
  }
  for (const std::uint32_t number : action) {
    const Edge& edge = program.edges[number];
    values.slots[edge.process] = edge.target;
    if (present.tables.reads_locations) written_.add(edge.process);
  }
  for (const std::uint32_t slot : present.tables.meta_slots) values.slots[slot] = program.slots[slot].initial;
  for (const ClockReset& reset : resets_) {
    values_.emplace_back(reset.clock, values.clocks.value(reset.clock, present.now));
    clocks_ |= clock_group(reset.clock);
    const Ticks copied = values.clocks.value(reset.source, present.now);
    const Ticks advance = Ticks{reset.value} * present.unit();
    if (copied > machine::largest_exact_reset * present.unit() + flow::latest_end - advance)
      throw machine::ModelFault(machine::FaultKind::bound, no_code);
    values.clocks.set(reset.clock, copied + advance, present.now);
  }
}

// Lets clocks run or stand as the locations want.
void Transition::switch_clocks(Present& present) {
  std::vector<std::uint8_t> stands(static_cast<std::size_t>(present.program.dimension()), 0);
  for (std::size_t p = 0; p < present.processes(); ++p)
    for (const program::Location::Stop& stop : present.place(p).location->stopped)
      if (stop.code == no_code || present.machine.value(stop.code, present.values.slots.data()) == 0)
        stands[stop.clock] = 1;
  const auto dimension = static_cast<std::uint16_t>(present.program.dimension());
  for (std::uint16_t clock = 1; clock < dimension; ++clock) {
    if (present.values.clocks.runs(clock) != (stands[clock] != 0)) continue;
    present.values.clocks.run(clock, stands[clock] == 0, present.now);
    switched_.push_back(clock);
    clocks_ |= clock_group(clock);
  }
}

// Finds the processes that the change concerns: no other invariant can have become false, no other draw is void.
void Transition::find_concerned(const Present& present, std::span<const std::uint32_t> action) {
  const auto changes_rates = [&](std::uint32_t number) {
    const Edge& edge = present.program.edges[number];
    const auto& rates = present.chances.flow_rates[edge.process];
    return edge.source != edge.target && (!rates[static_cast<std::size_t>(edge.source)].empty() ||
                                          !rates[static_cast<std::size_t>(edge.target)].empty());
  };
  flow_ = present.flow.exists() &&
          (present.chances.flow_reads.meets(written_) || std::any_of(action.begin(), action.end(), changes_rates));
  concerned_.clear();
  for (const std::uint32_t number : action) concerned_.push_back(present.program.edges[number].process);
  const std::size_t participants = concerned_.size();
  const auto examine = [&](std::size_t p) {
    if (!touches(present.dependencies[p])) return;
    const auto end = concerned_.begin() + static_cast<std::ptrdiff_t>(participants);
    if (std::find(concerned_.begin(), end, p) == end) concerned_.push_back(p);
  };
  if (present.processes() <= few_processes) {
    for (std::size_t p = 0; p < present.processes(); ++p) examine(p);
    return;
  }
  find_readers(present);
  readers_.for_each(examine);
}

void Transition::find_readers(const Present& present) {
  const Readers& readers = present.tables.readers;
  readers_.clear();
  for (const ClockReset& reset : resets_) readers_.add(readers.of_clock[reset.clock]);
  for (const std::uint16_t clock : switched_) readers_.add(readers.of_clock[clock]);
  if (flow_) readers_.add(readers.of_flow);
  const std::size_t groups = readers.of_slots.size();
  const auto changed = [&](std::size_t group) {
    const std::size_t first = group * program::SlotSet::group_size;
    const std::size_t last = std::min(first + program::SlotSet::group_size, slots_.size());
    return !std::equal(slots_.data() + first, slots_.data() + last, present.values.slots.data() + first);
  };
  for (std::uint64_t written = written_.groups(); written != 0; written &= written - 1)
    for (auto group = static_cast<std::size_t>(std::countr_zero(written)); group < groups; group += 64)
      if (groups <= 64 || changed(group)) readers_.add(readers.of_slots[group]);
}

bool Transition::invariants_hold(Present& present) const {
  for (const std::size_t p : concerned_) {
    const LocationTables& here = present.place(p);
    if (here.dependencies.has_invariant && !present.holds(here.location->invariant)) return false;
  }
  return true;
}

void Transition::undo(Present& present) {
  flow::ClockValues& clocks = present.values.clocks;
  for (const std::uint16_t clock : switched_) clocks.run(clock, !clocks.runs(clock), present.now);
  for (auto each = values_.rbegin(); each != values_.rend(); ++each) clocks.set(each->first, each->second, present.now);
  std::copy(slots_.begin(), slots_.end(), present.values.slots.begin());
  under_way_ = false;
}

}  // namespace tachk::simulation
