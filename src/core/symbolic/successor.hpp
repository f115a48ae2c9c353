// The transition relation on symbolic states: the actions enabled in a discrete state, and what firing one does to
// slots and zone. The semantics is that of docs/semantics.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <span>
#include <utility>
#include <vector>

#include "machine/machine.hpp"
#include "program/program.hpp"
#include "symbolic/callback.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::symbolic {

// The numbers of the edges that fire together.
using Edges = std::vector<std::uint32_t>;

// The actions that lead from one state to another one, in order.
using Path = std::vector<Edges>;

// Clock values beyond what a bound can hold: without extrapolation, or because clocks are advanced so far.
struct ConstantOverflow : std::exception {
  const char* what() const noexcept override { return "clock values are too large"; }
};

// An action of a discrete state: one internal edge; a sender and a receiver; or a broadcast sender and its receivers in
// process order. `guard` is the conjunction of their clock guards in this discrete state.
struct Action {
  Edges edges;
  std::vector<zones::Atom> guard;
};

// The effect of an action on the discrete state: all that is known without the zone.
struct Effect {
  std::vector<std::int32_t> slots;  // all slots, frame slots included
  program::SlotSet written;         // holds every slot of the state that differs from the source
  std::vector<zones::ClockReset> resets;
  std::vector<zones::Atom> invariant;  // of the target, over the values after the resets
};

class Semantics {
 public:
  Semantics(const program::Program& program, const zones::ZoneOperations& operations);

  const program::Program& program() const { return program_; }

  // Calls visit(action, guarded) for each action that is enabled somewhere in the zone; `guarded` is that part of the
  // zone. Priorities and the invariants of the targets are not considered. Both arguments are only valid during the
  // call. Receivers are evaluated only where the guard of a sender holds, channel codes only where that of their edge
  // does (docs/semantics.md, run-time errors). Throws ModelFault.
  using Visit = Callback<void(const Action&, zones::ConstZoneRef)>;
  void for_each_action(std::int32_t* slots, zones::ConstZoneRef zone, Visit visit) {
    for_each_action(slots, zone, visit, [](std::size_t) { return false; });
  }
  // As above, without what a process does alone where skips(process) is true.
  void for_each_action(std::int32_t* slots, zones::ConstZoneRef zone, Visit visit, Callback<bool(std::size_t)> skips);

  // Runs the updates of an action. False if an integer condition of a target invariant is violated: then the action is
  // not possible. Throws ModelFault, ConstantOverflow.
  bool apply(const Edges& edges, const std::int32_t* slots, Effect& effect);

  // The constraints on the source valuation under which the effect's invariant holds after its resets, appended to
  // `atoms`; false if it never holds.
  bool weakest_precondition(const Effect& effect, std::vector<zones::Atom>& atoms) const;

  // True if time may pass in a discrete state: no urgent or committed location, no enabled urgent synchronisation.
  bool time_passes(std::int32_t* slots);

  // Which clocks stand still; null if none can in this program.
  const std::uint8_t* stopped_clocks(std::int32_t* slots);

  // The value that code computes. Throws ModelFault.
  std::int64_t value(std::int32_t code, std::int32_t* slots) { return machine_.value(code, slots); }

  // Tests and code of a condition.
  bool holds(const program::Condition& condition, std::int32_t* slots);

  // Appends the clock constraints of a condition. Throws ModelFault.
  void resolve(const program::Condition& condition, std::int32_t* slots, std::vector<zones::Atom>& atoms);

  // Channel priority, then process priority (the largest of the participants).
  std::pair<std::int32_t, std::int32_t> priority(const Edges& edges, std::int32_t* slots);

  // Collects the invariant of a discrete state; false if its integer part is violated.
  bool invariant(std::int32_t* slots, std::vector<zones::Atom>& atoms);

  const program::Location& location(std::size_t process, const std::int32_t* slots) const {
    return program_.processes[process].locations[static_cast<std::size_t>(slots[process])];
  }
  // A number for each location of each process, counted through.
  std::size_t location_number(std::size_t process, std::int32_t location) const {
    return first_location_[process] + static_cast<std::size_t>(location);
  }
  std::size_t location_count() const { return outgoing_.size(); }

 private:
  // Throws ConstantOverflow where copies advance clocks by more than zones have room for.
  void check_advance(const std::vector<zones::ClockReset>& resets) const;

  struct Sender {
    std::uint32_t edge;
    std::vector<std::uint32_t> partners;  // the other processes with an edge that may receive what it sends
  };
  struct Outgoing {
    std::vector<std::uint32_t> internal;
    std::vector<Sender> sends;
    std::vector<std::uint32_t> receives;
  };
  // A test without a branch: whether the slot lies in [low, low + span], or outside of it.
  struct RangeTest {
    explicit RangeTest(const program::Test& test);
    bool passes(const std::int32_t* slots) const {
      return (static_cast<std::uint32_t>(slots[slot]) - low <= span) != outside;
    }

    std::uint32_t slot;
    std::uint32_t low;
    std::uint32_t span;
    bool outside;
  };
  // The integer part of a guard, side by side with those of other edges: of most guards only this is ever evaluated.
  struct IntegerGuard {
    std::uint32_t first_test;
    std::uint32_t last_test;
    std::int32_t code;
  };
  const Outgoing& outgoing(std::size_t process, const std::int32_t* slots) const {
    return outgoing_[location_number(process, slots[process])];
  }
  std::int32_t channel_of(const program::Edge& edge, std::int32_t* slots);
  // True if a receiving edge may name the channel and the integer part of its guard holds.
  bool may_receive(std::uint32_t number, std::int32_t channel, std::int32_t* slots) {
    return program_.edges[number].may_name(channel) && guard_may_hold(number, slots);
  }
  // True if an edge that may name the channel does so now. Only to be called where its guard holds.
  bool names(const program::Edge& edge, std::int32_t channel, std::int32_t* slots) {
    return edge.channel_code == program::no_code || channel_of(edge, slots) == channel;
  }
  // True if a sending edge names an urgent channel in some state.
  bool may_be_urgent(const program::Edge& edge) const;
  // As `names`, evaluated only if the guard of the edge holds somewhere in the zone; uses the buffer of this level.
  bool names_within(const program::Edge& edge, std::int32_t channel, std::int32_t* slots, zones::ConstZoneRef zone,
                    std::size_t level);
  // True if the integer part of an edge's guard holds.
  bool guard_may_hold(std::uint32_t number, std::int32_t* slots) {
    const IntegerGuard& guard = integer_guards_[number];
    for (std::uint32_t n = guard.first_test; n < guard.last_test; ++n)
      if (!guard_tests_[n].passes(slots)) return false;
    return guard.code == program::no_code || machine_.value(guard.code, slots) != 0;
  }
  void broadcast(std::span<const std::uint32_t> receivers, std::int32_t channel, int most, bool participates,
                 std::int32_t* slots, zones::ConstZoneRef zone, std::size_t level, Visit visit);
  void stay_out(const std::vector<std::vector<zones::Atom>>& guards, std::size_t next, zones::ConstZoneRef zone,
                std::size_t level, Callback<void(zones::ConstZoneRef, std::size_t)> visit);
  // The zone and the atoms, in the buffer of this level unless there is nothing to do; none if that is empty.
  zones::ConstZoneRef narrowed(zones::ConstZoneRef zone, std::size_t level, std::span<const zones::Atom> atoms);
  // Adds the clock guard of an edge to the action; gives the zone within it as `narrowed` does.
  zones::ConstZoneRef guarded(const program::Edge& edge, std::int32_t* slots, zones::ConstZoneRef zone,
                              std::size_t level);

  const program::Program& program_;
  zones::ZoneOperations operations_;
  machine::Machine machine_;
  std::vector<std::size_t> first_location_;
  std::vector<Outgoing> outgoing_;
  std::vector<IntegerGuard> integer_guards_;  // of each edge
  std::vector<RangeTest> guard_tests_;
  std::vector<std::uint32_t> receiving_;  // receiving edges of the broadcasts under way
  std::vector<std::uint32_t> meta_slots_;
  std::vector<std::uint8_t> stopped_;
  bool has_urgent_channels_ = false;
  bool has_urgent_locations_ = false;  // urgent or committed
  bool has_committed_locations_ = false;
  Action action_;
  std::deque<zones::ZoneBuffer> levels_;
};

}  // namespace tachk::symbolic
