#include "fmi/unit_run.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace tachk::fmi {

using flow::Ticks;
using simulation::Ending;
using simulation::Policy;

namespace {

// Reads what `save` has written.
class Saved {
 public:
  explicit Saved(std::span<const std::int64_t> numbers) : numbers_(numbers) {}

  std::int64_t next() {
    if (position_ >= numbers_.size()) throw std::invalid_argument("a saved state is too short");
    return numbers_[position_++];
  }
  std::uint64_t natural() { return static_cast<std::uint64_t>(next()); }
  bool truth() { return next() != 0; }

  template <class Value>
  std::vector<Value> sequence() {
    const std::uint64_t size = natural();
    if (size > numbers_.size() - position_) throw std::invalid_argument("a saved state is too short");
    const auto first = numbers_.begin() + static_cast<std::ptrdiff_t>(position_);
    position_ += size;
    std::vector<Value> result;
    std::transform(first, first + static_cast<std::ptrdiff_t>(size), std::back_inserter(result),
                   [](std::int64_t number) { return static_cast<Value>(number); });
    return result;
  }

 private:
  std::span<const std::int64_t> numbers_;
  std::size_t position_ = 0;
};

template <class Value>
void append(std::vector<std::int64_t>& numbers, const std::vector<Value>& values) {
  numbers.push_back(static_cast<std::int64_t>(values.size()));
  numbers.insert(numbers.end(), values.begin(), values.end());
}

}  // namespace

UnitRun::UnitRun(std::shared_ptr<const ResourceFile> resource)
    : resource_(std::move(resource)), scale_(resource_->scale) {
  const std::vector<Variable>& variables = resource_->variables;
  outside_.inputs.resize(variables.size());
  outside_.counts.resize(variables.size());
  outside_.pending.resize(variables.size());
  for (std::size_t n = 0; n < variables.size(); ++n)
    if (variables[n].role == Role::input)
      outside_.inputs[n] = resource_->program.slots[static_cast<std::size_t>(variables[n].number)].initial;
}

UnitRun::UnitRun(const UnitRun& other)
    : resource_(other.resource_),
      parameters_(other.parameters_),
      simulator_(other.simulator_ ? std::make_unique<simulation::Simulator>(*other.simulator_) : nullptr),
      scale_(other.scale_),
      ticks_per_unit_(other.ticks_per_unit_),
      start_(other.start_),
      now_(other.now_),
      transitions_(other.transitions_),
      at_once_(other.at_once_),
      last_(other.last_),
      settled_(other.settled_),
      fresh_(other.fresh_),
      ending_(other.ending_),
      outside_(other.outside_) {}

// ---- variables ------------------------------------------------------------------------------------------------------

const Variable& UnitRun::variable(std::uint32_t reference, Type type) const {
  if (reference >= resource_->variables.size()) throw std::invalid_argument("there is no variable with this number");
  const Variable& found = resource_->variables[reference];
  if (found.type != type) throw std::invalid_argument("the variable has another type");
  return found;
}

double UnitRun::real(std::uint32_t reference) {
  const Variable& wanted = variable(reference, Type::real);
  if (wanted.role == Role::time) return scale_.seconds(start_ + now_);
  begin();
  const flow::Number& number = resource_->chances.observed[static_cast<std::size_t>(wanted.number)];
  return number.value(simulator_->machine(), simulator_->slots());
}

std::int64_t UnitRun::number(std::uint32_t reference, Type type) {
  const Variable& wanted = variable(reference, type);
  switch (wanted.role) {
    case Role::seed:
      return static_cast<std::int64_t>(parameters_.seed);
    case Role::run:
      return static_cast<std::int64_t>(parameters_.run);
    case Role::policy:
      return static_cast<std::int64_t>(parameters_.policy);
    case Role::transitions:
      return static_cast<std::int64_t>(transitions_);
    case Role::input:
      return outside_.inputs[reference];
    case Role::receives:
      return outside_.counts[reference] + outside_.pending[reference];
    case Role::sends:
      return outside_.counts[reference];
    case Role::observed:
    case Role::time:
      break;
  }
  begin();
  const flow::Number& found = resource_->chances.observed[static_cast<std::size_t>(wanted.number)];
  return static_cast<std::int64_t>(found.value(simulator_->machine(), simulator_->slots()));
}

void UnitRun::set_number(std::uint32_t reference, Type type, std::int64_t value) {
  const Variable& wanted = variable(reference, type);
  switch (wanted.role) {
    case Role::seed:
    case Role::run:
    case Role::policy:
      choose(wanted.role, value);
      return;
    case Role::input:
      set_input(reference, value);
      return;
    case Role::receives:
      set_count(reference, value);
      return;
    case Role::time:
    case Role::transitions:
    case Role::observed:
    case Role::sends:
      throw std::invalid_argument("this variable cannot be set");
  }
}

void UnitRun::choose(Role parameter, std::int64_t value) {
  if (transitions_ > 0 || now_ > 0 || !outside_.intakes.empty()) throw std::invalid_argument("the run has begun");
  if (parameter == Role::policy && (value < 0 || value > static_cast<std::int64_t>(Policy::boundary)))
    throw std::invalid_argument("there is no such policy");
  if (parameter == Role::seed)
    parameters_.seed = static_cast<std::uint64_t>(value);
  else if (parameter == Role::run)
    parameters_.run = static_cast<std::uint64_t>(value);
  else
    parameters_.policy = static_cast<Policy>(value);
  simulator_.reset();
}

void UnitRun::set_input(std::uint32_t place, std::int64_t value) {
  const Variable& input = resource_->variables[place];
  const program::Slot& slot = resource_->program.slots[static_cast<std::size_t>(input.number)];
  if (value < slot.low || value > slot.high) throw std::invalid_argument("the value is outside the variable's range");
  begin();
  outside_.changed |= input.target >= 0 && simulator_->slots()[input.target] != value;
  outside_.inputs[place] = static_cast<std::int32_t>(value);
}

void UnitRun::set_count(std::uint32_t place, std::int64_t value) {
  if (value < outside_.counts[place] + outside_.pending[place])
    throw std::invalid_argument("a number of messages went down");
  outside_.pending[place] = value - outside_.counts[place];
}

bool UnitRun::ticks(std::uint32_t reference) const {
  const Variable& wanted = variable(reference, Type::clock);
  if (wanted.role == Role::receives) return outside_.pending[reference] > 0;
  if (!fresh_ || !simulator_) return false;
  const std::span<const std::uint32_t> edges = simulator_->edges();
  return std::find(edges.begin(), edges.end(), static_cast<std::uint32_t>(wanted.number)) != edges.end();
}

void UnitRun::set_ticks(std::uint32_t reference) {
  if (variable(reference, Type::clock).role != Role::receives) throw std::invalid_argument("this clock cannot be set");
  outside_.pending[reference] = 1;
}

bool UnitRun::ticking() const {
  const std::vector<Variable>& variables = resource_->variables;
  for (std::uint32_t n = 0; n < variables.size(); ++n)
    if (variables[n].role == Role::sends && variables[n].type == Type::clock && ticks(n)) return true;
  return false;
}

// ---- the run --------------------------------------------------------------------------------------------------------

void UnitRun::start_at(double start, std::optional<double> stop) {
  TimeScale scale = resource_->scale;
  for (Ticks ticks = flow::finest_ticks; ticks >= flow::coarsest_ticks; ticks /= 10, scale = scale.coarser())
    if (scale.holds(start) && (!stop || (scale.holds(*stop) && scale.holds(*stop - start)))) {
      scale_ = scale;
      ticks_per_unit_ = ticks;
      break;
    }
  start_ = scale_.ticks(start);
}

void UnitRun::begin() {
  if (simulator_) return;
  auto simulator = std::make_unique<simulation::Simulator>(resource_->program, resource_->chances, resource_->tables,
                                                           parameters_.policy, ticks_per_unit_);
  if (!simulator->begin(parameters_.seed, parameters_.run))
    throw std::invalid_argument("the initial state of the network violates an invariant");
  simulator_ = std::move(simulator);
}

Ticks UnitRun::next_event() {
  if (ending_) return flow::never;
  if (outside_.changed ||
      std::any_of(outside_.pending.begin(), outside_.pending.end(), [](std::int64_t count) { return count > 0; }))
    return now_;
  const Ticks next = simulator_->next_moment();
  return next <= flow::latest_end ? std::max(next, now_) : flow::never;
}

void UnitRun::wait_until(Ticks moment) {
  settled_ = settled_ && moment == now_;
  now_ = moment;
}

bool UnitRun::react() {
  fresh_ = false;
  if (ending_) return false;
  bool sent = false;
  for (std::uint32_t n = 0; n < outside_.pending.size(); ++n)
    for (; outside_.pending[n] > 0; --outside_.pending[n], ++outside_.counts[n], sent = true)
      environment_sends(static_cast<std::uint32_t>(resource_->variables[n].number));
  if (outside_.changed) {
    environment_sends(static_cast<std::uint32_t>(resource_->nudge));
    sent = true;
  }
  return sent || transition();
}

// The environment takes a transition, and the network gets the new inputs.
void UnitRun::environment_sends(std::uint32_t edge) {
  outside_.intakes.push_back({transitions_, now_, settled_, edge, outside_.inputs});
  take(outside_.intakes.back());
  outside_.changed = false;
}

void UnitRun::take(const Intake& intake) {
  for (std::size_t n = 0; n < intake.inputs.size(); ++n)
    if (resource_->variables[n].role == Role::input)
      simulator_->slots()[resource_->variables[n].number] = intake.inputs[n];
  if (!simulator_->take(intake.edge, intake.moment))
    throw std::invalid_argument("the environment sends what no process can receive now");
  settled_ = false;
}

bool UnitRun::transition() {
  if (settled_) return false;
  simulation::RunLimits limits;
  limits.until = now_;
  const std::optional<Ending> ending = simulator_->step(limits);
  if (!ending) {
    ++transitions_;
    at_once_ = now_ == last_ ? at_once_ + 1 : 0;
    last_ = now_;
    fresh_ = true;
    count();
    if (at_once_ >= limits.steps_at_once) ending_ = Ending::zeno;
    return true;
  }
  settled_ = true;
  // In an open network the environment may help.
  const bool stuck = *ending == Ending::deadlock || *ending == Ending::time_lock;
  if (*ending != Ending::horizon && !(stuck && resource_->open())) ending_ = ending;
  return false;
}

void UnitRun::count() {
  const std::span<const std::uint32_t> edges = simulator_->edges();
  if (!resource_->open() || edges.size() < 2) return;
  for (std::size_t n = 0; n < outside_.counts.size(); ++n) {
    const Variable& variable = resource_->variables[n];
    if (variable.role != Role::sends) continue;
    outside_.counts[n] += std::count(edges.begin(), edges.end(), static_cast<std::uint32_t>(variable.number));
  }
}

// ---- as numbers -----------------------------------------------------------------------------------------------------
//
// A saved state is how the run came about: its parameters, how many transitions it has had, and what the environment
// did. That is all there is to know of it, whatever a simulator keeps in mind.

std::vector<std::int64_t> UnitRun::save() const {
  std::vector<std::int64_t> result{resource_->fingerprint[0],
                                   resource_->fingerprint[1],
                                   static_cast<std::int64_t>(parameters_.seed),
                                   static_cast<std::int64_t>(parameters_.run),
                                   static_cast<std::int64_t>(parameters_.policy),
                                   simulator_ != nullptr,
                                   ticks_per_unit_,
                                   start_,
                                   now_,
                                   static_cast<std::int64_t>(transitions_),
                                   settled_,
                                   fresh_,
                                   outside_.changed,
                                   ending_ ? static_cast<std::int64_t>(*ending_) : -1};
  append(result, outside_.inputs);
  append(result, outside_.counts);
  append(result, outside_.pending);
  result.push_back(static_cast<std::int64_t>(outside_.intakes.size()));
  for (const Intake& intake : outside_.intakes) {
    result.insert(result.end(), {static_cast<std::int64_t>(intake.transitions), intake.moment, intake.settled,
                                 static_cast<std::int64_t>(intake.edge)});
    append(result, intake.inputs);
  }
  return result;
}

UnitRun UnitRun::restore(std::shared_ptr<const ResourceFile> resource, std::span<const std::int64_t> numbers) {
  UnitRun result(std::move(resource));
  Saved saved(numbers);
  if (saved.next() != result.resource_->fingerprint[0] || saved.next() != result.resource_->fingerprint[1])
    throw std::invalid_argument("the state was saved by a unit of another network");
  result.parameters_.seed = saved.natural();
  result.parameters_.run = saved.natural();
  const std::int64_t policy = saved.next();
  if (policy < 0 || policy > static_cast<std::int64_t>(Policy::boundary))
    throw std::invalid_argument("bad saved state");
  result.parameters_.policy = static_cast<Policy>(policy);
  const bool begun = saved.truth();
  const Ticks ticks_per_unit = saved.next();
  while (result.ticks_per_unit_ > std::max(ticks_per_unit, flow::coarsest_ticks)) {
    result.ticks_per_unit_ /= 10;
    result.scale_ = result.scale_.coarser();
  }
  result.start_ = saved.next();
  const Ticks now = saved.next();
  const std::uint64_t transitions = saved.natural();
  const bool settled = saved.truth();
  const bool fresh = saved.truth();
  const bool changed = saved.truth();
  const std::int64_t ending = saved.next();
  const auto inputs = saved.sequence<std::int32_t>();
  const auto counts = saved.sequence<std::int64_t>();
  const auto pending = saved.sequence<std::int64_t>();
  if (begun) {
    result.begin();
    for (std::uint64_t left = saved.natural(); left > 0; --left) {
      Intake intake{saved.natural(), saved.next(), saved.truth(), static_cast<std::uint32_t>(saved.next()), {}};
      intake.inputs = saved.sequence<std::int32_t>();
      result.go_through(intake);
      result.take(intake);
      result.outside_.intakes.push_back(std::move(intake));
    }
    result.go_through({transitions, now, settled, 0, {}});
  }
  result.now_ = now;
  result.settled_ = settled;
  result.fresh_ = fresh;
  result.outside_.changed = changed;
  if (ending >= 0) result.ending_ = static_cast<Ending>(ending);
  result.outside_.inputs = inputs;
  result.outside_.counts = counts;
  result.outside_.pending = pending;
  return result;
}

// The network on its own up to what the environment did.
void UnitRun::go_through(const Intake& intake) {
  simulation::RunLimits limits;
  while (transitions_ < intake.transitions) {
    if (simulator_->step(limits)) throw std::invalid_argument("the saved state is not one of this network");
    ++transitions_;
    at_once_ = simulator_->now() == last_ ? at_once_ + 1 : 0;
    last_ = simulator_->now();
  }
  limits.until = intake.moment - 1;
  if (simulator_->next_moment() < intake.moment) simulator_->step(limits);
  limits.until = intake.moment;
  if (intake.settled) simulator_->step(limits);
}

}  // namespace tachk::fmi
