#include "machine/code_accesses.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace tachk::machine {

AccessSet::AccessSet(const program::Program& program)
    : program_(&program),
      words_((program.state_slots + static_cast<std::size_t>(program.dimension()) + std::size_t{63}) / 64) {}

// A meta has its initial value before and after each action: none hands anything on in it.
void AccessSet::add_slots(std::int64_t first, std::int64_t last) {
  last = std::min<std::int64_t>(last, std::int64_t{program_->state_slots} - 1);
  for (std::int64_t slot = std::max<std::int64_t>(first, 0); slot <= last; ++slot)
    if (!program_->slots[static_cast<std::size_t>(slot)].meta) add_bit(static_cast<std::size_t>(slot));
}

void AccessSet::add_clock(std::size_t clock) {
  if (clock > 0) add_bit(program_->state_slots + clock);
}

void AccessSet::add_everything() { std::fill(words_.begin(), words_.end(), UINT64_MAX); }

void AccessSet::add(const AccessSet& other) {
  for (std::size_t word = 0; word < words_.size(); ++word) words_[word] |= other.words_[word];
}

bool AccessSet::meets(const AccessSet& other) const {
  for (std::size_t word = 0; word < words_.size(); ++word)
    if ((words_[word] & other.words_[word]) != 0) return true;
  return false;
}

// Runs over the stack code with intervals in place of numbers (Cousot and Cousot 1977), until nothing is new.
struct CodeAccesses::Interpretation {
  struct Interval {
    std::int64_t low, high;
    bool operator==(const Interval&) const = default;
    bool known() const { return low > INT64_MIN; }
  };
  using Stack = std::vector<Interval>;
  static constexpr Interval anything{INT64_MIN, INT64_MAX};

  CodeAccesses& found;
  std::map<std::int32_t, Stack> before;    // each instruction
  std::map<std::int64_t, Interval> frame;  // of frame slots: what has been stored there
  std::vector<std::int32_t> open;
  bool changed = false;

  static Interval joined(Interval one, Interval other) { return one == other ? one : anything; }

  void run(std::int32_t start) {
    do {
      changed = false;
      reach(start, {});
      for (const auto& [position, stack] : before) open.push_back(position);
      while (!open.empty()) {
        const std::int32_t position = open.back();
        open.pop_back();
        step(position, before.at(position));
      }
    } while (changed);
  }
  void reach(std::int32_t position, const Stack& stack) {
    const auto [entry, fresh] = before.emplace(position, stack);
    bool different = fresh;
    for (std::size_t n = 0; n < stack.size() && !fresh; ++n) {
      const Interval both = joined(entry->second[n], stack[n]);
      different |= both != entry->second[n];
      entry->second[n] = both;
    }
    if (different) open.push_back(position);
  }
  Interval content(std::int64_t slot) const {
    if (slot < found.program_.state_slots) {
      const program::Slot& known = found.program_.slots[static_cast<std::size_t>(slot)];
      return {known.low, known.high};
    }
    const auto stored = frame.find(slot);
    return stored == frame.end() ? anything : stored->second;
  }
  void store(std::int64_t slot, Interval value) {
    if (slot < found.program_.state_slots) return;
    const auto [entry, fresh] = frame.emplace(slot, value);
    const Interval both = joined(entry->second, value);
    changed |= fresh || both != entry->second;
    entry->second = both;
  }
  void read(Interval slots, std::int64_t count = 1) {
    if (slots.known())
      found.reads.add_slots(slots.low, slots.high + count - 1);
    else
      found.reads.add_everything();
  }
  void write(Interval slots, std::int64_t count, Interval value) {
    if (!slots.known()) {
      found.writes.add_everything();
      slots = {found.program_.state_slots, static_cast<std::int64_t>(found.program_.slots.size()) - count};
    }
    found.writes.add_slots(slots.low, slots.high + count - 1);
    for (std::int64_t slot = std::max<std::int64_t>(slots.low, found.program_.state_slots);
         slot < slots.high + count && slot < static_cast<std::int64_t>(found.program_.slots.size()); ++slot)
      store(slot, slots.low == slots.high && count == 1 ? value : anything);
  }
  void add_clocks(Interval clock, AccessSet& accesses) const {
    const std::int64_t last = found.program_.numbered_clocks();
    for (std::int64_t n = clock.known() ? std::max<std::int64_t>(clock.low, 0) : 0;
         n <= last && (!clock.known() || n <= clock.high); ++n)
      accesses.add_clock(static_cast<std::size_t>(found.program_.renumbered(n)));
  }
  static Interval pop(Stack& stack) {
    const Interval top = stack.back();
    stack.pop_back();
    return top;
  }
  std::int32_t operand(std::int32_t position, int number) const {
    return found.program_.code.at(static_cast<std::size_t>(position) + 1 + static_cast<std::size_t>(number));
  }
  void step(std::int32_t position, Stack stack);
};

void CodeAccesses::Interpretation::step(std::int32_t position, Stack stack) {
  const auto here = static_cast<Opcode>(found.program_.code.at(static_cast<std::size_t>(position)));
  const StackEffect effect = effect_of(here);
  const std::int32_t next = position + 1 + effect.operands;
  const std::int32_t first = effect.operands > 0 ? operand(position, 0) : 0;
  switch (here) {
    case Opcode::end:
    case Opcode::call_return:
      return;
    case Opcode::jump:
      return reach(first, stack);
    case Opcode::jump_if_zero:
    case Opcode::jump_if_nonzero:
      stack.pop_back();
      reach(first, stack);
      break;
    case Opcode::call:
      reach(first, {});
      stack.insert(stack.end(), static_cast<std::size_t>(found.code_.results(first)), anything);
      break;
    case Opcode::constant:
      stack.push_back({first, first});
      break;
    case Opcode::load:
      read({first, first});
      stack.push_back(content(first));
      break;
    case Opcode::load_indirect: {
      const Interval slots = pop(stack);
      read(slots);
      stack.push_back(slots.known() && slots.low == slots.high ? content(slots.low) : anything);
      break;
    }
    case Opcode::store:
      write({first, first}, 1, pop(stack));
      break;
    case Opcode::store_indirect: {
      const Interval value = pop(stack);
      write(pop(stack), 1, value);
      break;
    }
    case Opcode::index: {
      stack.pop_back();
      const Interval base = pop(stack);
      const std::int64_t reach_of_it = (std::int64_t{operand(position, 1)} - 1) * operand(position, 2);
      stack.push_back(base.known() ? Interval{base.low, base.high + reach_of_it} : anything);
      break;
    }
    case Opcode::copy:
      read(pop(stack), first);
      write(pop(stack), first, anything);
      break;
    case Opcode::equal_slots:
      read(pop(stack), first);
      read(pop(stack), first);
      stack.push_back(anything);
      break;
    case Opcode::reset:
      stack.pop_back();
      add_clocks(pop(stack), found.writes);
      break;
    case Opcode::copy_clock:
      add_clocks(pop(stack), found.reads);
      add_clocks(pop(stack), found.writes);
      break;
    case Opcode::advance_clock: {
      stack.pop_back();
      const Interval clock = pop(stack);
      add_clocks(clock, found.reads);
      add_clocks(clock, found.writes);
      break;
    }
    case Opcode::floating:  // operands are numbers of slots, as a rule
      found.reads.add_everything();
      stack.resize(stack.size() - 2);
      write({operand(position, 1), operand(position, 1)}, 2, anything);
      stack.push_back(anything);
      break;
    case Opcode::duplicate:
      stack.push_back(stack.back());
      break;
    case Opcode::swap:
      std::swap(stack.back(), stack[stack.size() - 2]);
      break;
    case Opcode::over:
      stack.push_back(stack[stack.size() - 2]);
      break;
    case Opcode::check_range:
      if (!stack.back().known()) stack.back() = {first, operand(position, 1)};
      break;
    default:
      stack.resize(stack.size() - static_cast<std::size_t>(effect.pops));
      stack.insert(stack.end(), static_cast<std::size_t>(effect.pushes), anything);
  }
  reach(next, stack);
}

void CodeAccesses::add(std::int32_t code) {
  if (code != program::no_code) Interpretation{*this, {}, {}, {}}.run(code);
}

void CodeAccesses::add(const program::Condition& condition) {
  for (const program::Test& test : condition.tests) reads.add_slots(test.slot, test.slot);
  add(condition.code);
  const auto add_clock = [this](std::int32_t code, std::int64_t clock) {
    add(code);
    if (code == program::no_code)
      reads.add_clock(static_cast<std::size_t>(clock));
    else
      for (int any = 1; any <= program_.clocks; ++any) reads.add_clock(static_cast<std::size_t>(any));
  };
  for (const zones::Atom& atom : condition.atoms) {
    reads.add_clock(atom.left);
    reads.add_clock(atom.right);
  }
  for (const program::FlowTest& test : condition.flow) {
    add(test.left);
    add(test.right);
  }
  for (const program::ComputedConstraint& constraint : condition.computed) {
    add(constraint.bound_code);
    add(constraint.condition);
    add_clock(constraint.left_code, constraint.left);
    add_clock(constraint.right_code, constraint.right);
  }
}

void CodeAccesses::add(const program::Update& update) {
  for (const program::Update::Store& store : update.stores) writes.add_slots(store.slot, store.slot);
  for (const zones::ClockReset& reset : update.resets) {
    reads.add_clock(reset.source);
    writes.add_clock(reset.clock);
  }
  add(update.code);
}

void CodeAccesses::clear() { reads = writes = AccessSet(program_); }

}  // namespace tachk::machine
