// A read-only mirror of tachk.engine.compiler.program: what the names mean is documented there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "zones/bound.hpp"

namespace tachk::program {

inline constexpr std::int32_t no_code = -1;

enum class Comparison : std::int32_t { equal, not_equal, less, less_equal, greater, greater_equal };

struct Test {
  std::uint32_t slot;
  Comparison comparison;
  std::int32_t constant;

  bool holds(const std::int32_t* slots) const {
    const std::int32_t value = slots[slot];
    switch (comparison) {
      case Comparison::equal:
        return value == constant;
      case Comparison::not_equal:
        return value != constant;
      case Comparison::less:
        return value < constant;
      case Comparison::less_equal:
        return value <= constant;
      case Comparison::greater:
        return value > constant;
      case Comparison::greater_equal:
        return value >= constant;
    }
    return false;
  }
};

// A set of slots, coarsely: of 64 groups of slots those with a member. It may hold more slots than were added.
class SlotSet {
 public:
  static SlotSet all() {
    SlotSet set;
    set.groups_ = UINT64_MAX;
    return set;
  }
  // Slots come in groups; the groups whose numbers are equal modulo 64 are one here.
  static constexpr std::size_t group_size = 8;
  static std::size_t group_of(std::size_t slot) { return slot / group_size; }

  void add(std::size_t slot) { groups_ |= std::uint64_t{1} << (group_of(slot) % 64); }
  void add(const SlotSet& other) { groups_ |= other.groups_; }
  bool meets(const SlotSet& other) const { return (groups_ & other.groups_) != 0; }
  // The groups with a member, as bits.
  std::uint64_t groups() const { return groups_; }

 private:
  std::uint64_t groups_ = 0;
};

// A clock constraint with some part that has to be computed.
struct ComputedConstraint {
  std::int32_t left;
  std::int32_t right;
  bool strict;
  std::int32_t bound;
  std::int32_t bound_code;
  std::int32_t condition;
  std::int32_t left_code;
  std::int32_t right_code;
};

// A condition on hybrid clocks, which only simulations know: a comparison of two floating point numbers, or (truth) any
// other condition.
struct FlowTest {
  enum class Kind : std::int32_t { truth, less, less_equal, greater, greater_equal, equal, not_equal };

  Kind kind;
  bool affine;  // the difference of both sides is a sum of multiples of hybrid clocks
  std::int32_t left;
  std::int32_t right;  // no_code for a truth
};

struct Condition {
  std::vector<Test> tests;
  std::int32_t code = no_code;
  std::vector<zones::Atom> atoms;
  std::vector<ComputedConstraint> computed;
  std::vector<FlowTest> flow;

  bool constrains_clocks() const { return !atoms.empty() || !computed.empty(); }
  bool trivial() const { return tests.empty() && code == no_code && atoms.empty() && computed.empty() && flow.empty(); }
};

struct Update {
  struct Store {
    std::uint32_t slot;
    std::int32_t value;
  };
  std::vector<Store> stores;
  std::vector<zones::ClockReset> resets;
  std::int32_t code = no_code;
};

struct ClockBound {
  std::uint16_t clock;
  zones::Raw value;
};

struct Location {
  Condition invariant;
  bool urgent;
  bool committed;
  bool observes;
  struct Stop {
    std::uint16_t clock;
    std::int32_t code;
  };
  std::vector<Stop> stopped;
  std::vector<ClockBound> lower;
  std::vector<ClockBound> upper;
  bool has_invariant;

  // The committed rule: a transition is possible where a participant may go before what is the most committed place.
  // An observer goes whatever others have to do, and first of all where it is committed itself.
  int commitment() const { return committed ? 1 + static_cast<int>(observes) : 0; }
  bool may_go(int most) const { return observes || commitment() >= most; }
};

struct Edge {
  std::uint32_t process;
  std::int32_t source;
  std::int32_t target;
  Condition guard;
  std::int32_t channel;  // where there is code, the first of the channels that it may name
  std::int32_t channel_code;
  bool sends;
  Update update;
  std::uint32_t channels = 1;  // how many the edge may name, from that one on

  bool internal() const { return channel < 0; }
  // True if one may send what the other receives.
  bool may_meet(const Edge& other) const {
    return !internal() && !other.internal() && sends != other.sends &&
           static_cast<std::uint32_t>(channel) < static_cast<std::uint32_t>(other.channel) + other.channels &&
           static_cast<std::uint32_t>(other.channel) < static_cast<std::uint32_t>(channel) + channels;
  }
  bool may_name(std::int32_t number) const {
    return channel >= 0 && static_cast<std::uint32_t>(number) - static_cast<std::uint32_t>(channel) < channels;
  }
};

struct Process {
  std::int32_t priority;
  std::vector<Location> locations;
};

struct Channel {
  bool broadcast;
  bool urgent;
  std::int32_t priority;
};

struct Slot {
  std::int32_t low;
  std::int32_t high;
  std::int32_t initial;
  bool meta;
};

enum class DeadlockLiteral : std::int32_t { forbidden = -1, absent = 0, required = 1 };

struct Disjunct {
  Condition condition;
  DeadlockLiteral deadlock;
};

struct Goal {
  std::vector<Disjunct> disjuncts;
  bool decides = true;  // the search goes on for it; otherwise it is only noted if it is met on the way
};

// The least or the largest value of something in the states of a goal: of an integer, or of a clock.
struct Measure {
  Goal where;  // none of its disjuncts asks for deadlock
  bool largest;
  std::uint16_t clock;  // 0 for an integer
  std::int32_t code;    // of the integer
};

// Processes that can be permuted without changing what is possible: any two, or all of them cyclically.
struct Interchangeable {
  struct Name {
    std::uint32_t slot;
    std::uint32_t table;
  };

  // The slots of each member, so that the entries of two members correspond; the first slot is that of the location.
  std::vector<std::vector<std::uint32_t>> slots;
  std::vector<std::vector<std::uint16_t>> clocks;
  // The slots that may name members, and which number of each table is the name of each member.
  std::vector<Name> names;
  std::vector<std::vector<std::int32_t>> tables;
  // The members can only be moved on, all by the same number of places, the last ones to the front.
  bool cyclic = false;
};

struct Program {
  std::vector<Process> processes;
  std::vector<Channel> channels;
  int clocks = 0;
  std::vector<Slot> slots;
  std::uint32_t state_slots = 0;
  std::vector<std::int32_t> code;
  std::int32_t default_priority = 0;
  std::vector<zones::Raw> maximum_constants;
  std::vector<zones::Atom> diagonals;
  std::vector<Edge> edges;
  std::vector<Goal> goals;
  std::vector<Measure> measures;
  std::vector<Interchangeable> interchangeable;
  std::vector<zones::ClockReset> starts;  // what clocks show at first that do not begin with 0
  bool has_priorities = false;
  bool has_stopwatches = false;
  bool copies_clocks = false;
  zones::Raw largest_constant = 0;  // in any atom, reset or bound
  std::int64_t computed_unit = 0;   // divides every time that code computes; 0 if that is always 0
  std::int64_t time_unit = 1;       // what 1 stands for wherever times are not computed by code

  // The clocks as the code numbers them, with their numbers here; empty if those are the same.
  std::vector<std::uint16_t> clock_numbers;

  int dimension() const { return clocks + 1; }
  int numbered_clocks() const { return clock_numbers.empty() ? clocks : static_cast<int>(clock_numbers.size()) - 1; }
  std::int64_t renumbered(std::int64_t clock) const {
    return clock_numbers.empty() ? clock : clock_numbers[static_cast<std::size_t>(clock)];
  }
};

// The program without the clocks that are never compared with anything.
Program without_idle_clocks(Program program);

// The program with all times in the largest unit of which each is a multiple.
Program in_largest_unit(Program program);

// Reads the flat form that tachk.engine.program_image writes: the fields of the dataclasses in order, each sequence
// preceded by its length. Throws std::invalid_argument if the numbers do not make a program.
Program decode_program(std::span<const std::int64_t> image);

}  // namespace tachk::program
