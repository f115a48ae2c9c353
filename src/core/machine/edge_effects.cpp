#include "machine/edge_effects.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "machine/code_accesses.hpp"

namespace tachk::machine {

using program::Comparison;
using program::Condition;
using program::Edge;
using program::no_code;
using program::Program;

EffectReader::Term EffectReader::within(std::int64_t low, std::int64_t high) {
  if (low < INT32_MIN || high > INT32_MAX) return {};  // wraps around
  return {{low, high}};
}

// Reads code that is one sequence of instructions, which may call functions.
class EffectReader::Sequence {
 public:
  Sequence(EffectReader& reader, Known known) : reader_(reader), program_(reader.program_), known_(std::move(known)) {}

  // False if the code is no such sequence; then nothing else counts.
  bool read(std::int32_t position) {
    while (true) {
      const auto here = static_cast<Opcode>(word(position));
      if (here == Opcode::end) return true;
      const StackEffect effect = effect_of(here);
      if (stack_.size() < static_cast<std::size_t>(effect.pops) || !step(here, position)) return false;
      position += 1 + effect.operands;
    }
  }

  bool fails() const { return fails_; }
  const Term* result() const { return stack_.empty() ? nullptr : &stack_.back(); }
  EdgeEffects take() && {
    effects_.update_can_fail = fails_;
    if (effects_.any_slot) return std::move(effects_);
    for (const std::uint32_t slot : written_) {
      const Term& term = known_.at(slot);
      if (term.is_constant())
        effects_.slots.push_back({slot, EdgeEffects::Kind::set, term.range.low});
      else if (term.slot == slot)
        effects_.slots.push_back({slot, EdgeEffects::Kind::raise, term.offset});
      else
        effects_.slots.push_back({slot, EdgeEffects::Kind::anything, 0});
    }
    return std::move(effects_);
  }

 private:
  std::int32_t word(std::int32_t position) const { return program_.code.at(static_cast<std::size_t>(position)); }
  bool is_slot(std::int32_t number) const {
    return number >= 0 && static_cast<std::size_t>(number) < program_.slots.size();
  }
  Term pop() {
    const Term top = stack_.back();
    stack_.pop_back();
    return top;
  }
  bool push(const Term& term) {
    stack_.push_back(term);
    return true;
  }
  Term content(std::uint32_t slot) const {
    const Range range{program_.slots[slot].low, program_.slots[slot].high};
    if (effects_.any_slot) return {range};
    const auto entry = known_.find(slot);
    return entry != known_.end() ? entry->second : Term{range, slot, 0};
  }
  void store(std::uint32_t slot, const Term& value) {
    fails_ = fails_ || !value.range.lies_in(program_.slots[slot].low, program_.slots[slot].high);
    known_[slot] = value;
    if (slot < program_.state_slots && std::find(written_.begin(), written_.end(), slot) == written_.end())
      written_.push_back(slot);
  }
  // False if it is not known which clock that is.
  bool set_clock(const Term& clock, std::optional<std::int64_t> value) {
    if (!clock.is_constant() || clock.range.low < 1 || clock.range.low > program_.numbered_clocks()) return false;
    const std::int64_t number = program_.renumbered(clock.range.low);
    if (number != 0) effects_.clocks.push_back({static_cast<std::uint16_t>(number), value});
    return true;
  }
  bool reset() {
    const Term time = pop();
    const std::int64_t unit = program_.time_unit;
    const bool is_known = time.is_constant() && time.range.low >= 0 && time.range.low % unit == 0;
    fails_ = fails_ || !time.range.lies_in(0, program_.largest_constant * unit);
    return set_clock(pop(), is_known ? std::optional(time.range.low / unit) : std::nullopt);
  }
  bool add(const Term& left, const Term& right, std::int64_t sign) {
    const std::int64_t low = left.range.low + (sign > 0 ? right.range.low : -right.range.high);
    const std::int64_t high = left.range.high + (sign > 0 ? right.range.high : -right.range.low);
    Term sum = within(low, high);
    if (low < INT32_MIN || high > INT32_MAX) return push(sum);
    if (right.is_constant() && left.slot >= 0) {
      sum.slot = left.slot;
      sum.offset = left.offset + sign * right.range.low;
    } else if (sign > 0 && left.is_constant() && right.slot >= 0) {
      sum.slot = right.slot;
      sum.offset = right.offset + left.range.low;
    }
    return push(sum);
  }
  bool modulo(const Term& left, const Term& right) {
    if (!right.range.lies_in(1, INT32_MAX)) {
      fails_ = true;
      return push({});
    }
    const std::int64_t most = right.range.high - 1;
    return push(within(left.range.low < 0 ? -most : 0, std::min(std::max<std::int64_t>(left.range.high, 0), most)));
  }
  // Code that is not looked into writes variables.
  void forget_slots() {
    effects_.any_slot = true;
    fails_ = true;
  }
  bool step(Opcode here, std::int32_t position);

  EffectReader& reader_;
  const Program& program_;
  Known known_;
  std::vector<std::uint32_t> written_;
  std::vector<Term> stack_;
  EdgeEffects effects_;
  bool fails_ = false;
};

bool EffectReader::Sequence::step(Opcode here, std::int32_t position) {
  switch (here) {
    case Opcode::constant:
      return push(within(word(position + 1), word(position + 1)));
    case Opcode::load:
      return is_slot(word(position + 1)) && push(content(static_cast<std::uint32_t>(word(position + 1))));
    case Opcode::store:
      if (!is_slot(word(position + 1))) return false;
      store(static_cast<std::uint32_t>(word(position + 1)), pop());
      return true;
    case Opcode::store_indirect:
    case Opcode::copy:
      pop();
      pop();
      forget_slots();
      return true;
    case Opcode::load_indirect:
      pop();
      fails_ = true;
      return push({});
    case Opcode::index: {
      pop();
      pop();
      fails_ = true;
      return push({});
    }
    case Opcode::table: {
      const std::int64_t low = word(position + 2);
      fails_ = fails_ || !pop().range.lies_in(low, low + word(position + 3) - 1);
      return push({});
    }
    case Opcode::call:
      if (!reader_.clocks_set_by(word(position + 1)).empty()) return false;
      forget_slots();
      stack_.insert(stack_.end(), static_cast<std::size_t>(reader_.code_.results(word(position + 1))), Term{});
      return true;
    case Opcode::reset:
      return reset();
    case Opcode::copy_clock:
      pop();
      return set_clock(pop(), std::nullopt);
    case Opcode::advance_clock:
      pop();
      fails_ = true;
      return set_clock(pop(), std::nullopt);
    case Opcode::duplicate:
      return !stack_.empty() && push(Term{stack_.back()});
    case Opcode::pop:
      pop();
      return true;
    case Opcode::swap:
      std::swap(stack_.back(), stack_[stack_.size() - 2]);
      return true;
    case Opcode::over:
      return push(Term{stack_[stack_.size() - 2]});
    case Opcode::add:
    case Opcode::subtract: {
      const Term right = pop();
      const Term left = pop();
      return add(left, right, here == Opcode::add ? 1 : -1);
    }
    case Opcode::modulo: {
      const Term right = pop();
      const Term left = pop();
      return modulo(left, right);
    }
    case Opcode::check_range:
      fails_ = fails_ || !stack_.back().range.lies_in(word(position + 1), word(position + 2));
      return true;
    case Opcode::assertion:
      pop();
      fails_ = true;
      return true;
    case Opcode::negate: {
      const Term value = pop();
      return push(within(-value.range.high, -value.range.low));
    }
    case Opcode::logical_not:
    case Opcode::boolean:
      pop();
      return push(within(0, 1));
    case Opcode::equal:
    case Opcode::not_equal:
    case Opcode::less:
    case Opcode::less_equal:
    case Opcode::greater:
    case Opcode::greater_equal:
      pop();
      pop();
      return push(within(0, 1));
    case Opcode::equal_slots:
    case Opcode::divide:
    case Opcode::power:
    case Opcode::shift_left:
    case Opcode::shift_right:
      fails_ = true;
      [[fallthrough]];
    case Opcode::minimum:
    case Opcode::maximum:
    case Opcode::multiply:
    case Opcode::bit_and:
    case Opcode::bit_or:
    case Opcode::bit_xor:
      pop();
      pop();
      return push({});
    default:
      return false;
  }
}

namespace {

// Jumps are none of these: code that jumps back may take too many steps.
bool cannot_fail(Opcode opcode) {
  constexpr Opcode harmless[] = {Opcode::constant,   Opcode::load,    Opcode::duplicate,    Opcode::pop,
                                 Opcode::swap,       Opcode::over,    Opcode::add,          Opcode::subtract,
                                 Opcode::multiply,   Opcode::bit_and, Opcode::bit_or,       Opcode::bit_xor,
                                 Opcode::minimum,    Opcode::maximum, Opcode::negate,       Opcode::logical_not,
                                 Opcode::boolean,    Opcode::equal,   Opcode::not_equal,    Opcode::less,
                                 Opcode::less_equal, Opcode::greater, Opcode::greater_equal};
  return std::find(std::begin(harmless), std::end(harmless), opcode) != std::end(harmless);
}

}  // namespace

// True if no instruction that the code may come to can be a run-time error.
bool EffectReader::is_harmless(std::int32_t start) const {
  std::set<std::int32_t> seen;
  std::vector<std::int32_t> open{start};
  while (!open.empty()) {
    const std::int32_t position = open.back();
    open.pop_back();
    if (!seen.insert(position).second) continue;
    const auto here = static_cast<Opcode>(program_.code.at(static_cast<std::size_t>(position)));
    if (here == Opcode::end) continue;
    const bool jumps = here == Opcode::jump || here == Opcode::jump_if_zero || here == Opcode::jump_if_nonzero;
    if (!jumps && !cannot_fail(here)) return false;
    if (jumps) {
      const std::int32_t target = program_.code.at(static_cast<std::size_t>(position) + 1);
      if (target <= position) return false;
      open.push_back(target);
    }
    if (here != Opcode::jump) open.push_back(position + 1 + effect_of(here).operands);
  }
  return true;
}

const std::vector<std::uint16_t>& EffectReader::clocks_set_by(std::int32_t code) {
  const auto [entry, fresh] = clocks_set_.try_emplace(code);
  std::vector<std::uint16_t>& clocks = entry->second;
  if (!fresh) return clocks;
  CodeAccesses accesses(program_);
  accesses.add(code);
  for (std::uint16_t clock = 1; clock <= program_.clocks; ++clock)
    if (accesses.writes.has_clock(clock)) clocks.push_back(clock);
  return clocks;
}

bool EffectReader::fails(std::int32_t code, Range expected) {
  if (code == no_code) return false;
  Sequence sequence(*this, {});
  if (sequence.read(code))
    return sequence.fails() || sequence.result() == nullptr ||
           !sequence.result()->range.lies_in(expected.low, expected.high);
  return expected.low > INT32_MIN || expected.high < INT32_MAX || !is_harmless(code);
}

EffectReader::Known EffectReader::narrowed(const Condition& guard) const {
  Known known;
  for (const program::Test& test : guard.tests) {
    if (test.slot >= program_.state_slots || program_.slots[test.slot].meta) continue;
    const program::Slot& slot = program_.slots[test.slot];
    Range& range = known.try_emplace(test.slot, Term{{slot.low, slot.high}, test.slot, 0}).first->second.range;
    const std::int64_t constant = test.constant;
    switch (test.comparison) {
      case Comparison::equal:
        range = {std::max(range.low, constant), std::min(range.high, constant)};
        break;
      case Comparison::not_equal:
        break;
      case Comparison::less:
        range.high = std::min(range.high, constant - 1);
        break;
      case Comparison::less_equal:
        range.high = std::min(range.high, constant);
        break;
      case Comparison::greater:
        range.low = std::max(range.low, constant + 1);
        break;
      case Comparison::greater_equal:
        range.low = std::max(range.low, constant);
        break;
    }
  }
  std::erase_if(known, [](const auto& entry) { return entry.second.range.low > entry.second.range.high; });
  return known;
}

bool EffectReader::can_fail(const Condition& condition) {
  if (fails(condition.code) || !condition.flow.empty()) return true;
  const std::int64_t largest = program_.largest_constant * program_.time_unit;
  return std::any_of(condition.computed.begin(), condition.computed.end(), [&](const auto& constraint) {
    return fails(constraint.condition) || fails(constraint.left_code) || fails(constraint.right_code) ||
           fails(constraint.bound_code, {-largest, largest});
  });
}

EdgeEffects EffectReader::of(const Edge& edge) {
  const program::Update& update = edge.update;
  EdgeEffects effects;
  if (update.code == no_code) {
    for (const zones::ClockReset& reset : update.resets)
      effects.clocks.push_back(
          {reset.clock, reset.source == 0 ? std::optional<std::int64_t>(reset.value) : std::nullopt});
    for (const program::Update::Store& store : update.stores)
      effects.slots.push_back({store.slot, EdgeEffects::Kind::set, store.value});
  } else {
    // What a sender does comes between the guard of a receiver and its update.
    const bool receives = !edge.internal() && !edge.sends;
    Sequence sequence(*this, receives ? Known{} : narrowed(edge.guard));
    if (sequence.read(update.code)) {
      effects = std::move(sequence).take();
    } else {
      effects.any_slot = effects.update_can_fail = true;
      for (const std::uint16_t clock : clocks_set_by(update.code)) effects.clocks.push_back({clock, std::nullopt});
    }
  }
  effects.guard_can_fail = can_fail(edge.guard) || fails(edge.channel_code);
  return effects;
}

std::vector<EdgeEffects::OnSlot> EffectReader::slots_of(const Edge& edge) const {
  CodeAccesses accesses(program_);
  accesses.add(edge.update.code);
  std::vector<EdgeEffects::OnSlot> slots;
  for (std::uint32_t slot = 0; slot < program_.state_slots; ++slot)
    if (accesses.writes.has_slot(slot)) slots.push_back({slot, EdgeEffects::Kind::anything, 0});
  return slots;
}

}  // namespace tachk::machine
