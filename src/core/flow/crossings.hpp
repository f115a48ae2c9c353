// When conditions on hybrid clocks become true and false.
//
// Where rates are constant and conditions linear, crossings are computed; else the conditions are looked at every 1/100
// unit of time, and a crossing that is seen is located to a tick. docs/simulation.md says what that means.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flow/clock_values.hpp"
#include "flow/flow.hpp"
#include "machine/machine.hpp"
#include "program/program.hpp"

namespace tachk::flow {

// How far apart moments are at which conditions are looked at.
constexpr Ticks flow_sample(Ticks ticks_per_unit) { return ticks_per_unit / 100; }

class Crossings {
 public:
  // The arguments must outlive it. Questions about other moments leave the values of those in the slots.
  Crossings(Flow& flow, machine::Machine& machine, std::int32_t* slots)
      : flow_(flow), machine_(machine), slots_(slots) {}

  // True if all hold with the values in the slots, where what is not strict may be missed by a millionth.
  bool hold(std::span<const program::FlowTest> tests);

  struct Found {
    Ticks moment = never;  // never: not up to `seen`
    Ticks seen = never;    // how far was looked
  };
  // The first moment of [from, last] at which all hold. Conditions that have to be sampled are evaluated at least up to
  // `lookahead`.
  Found opening(std::span<const program::FlowTest> tests, Ticks from, Ticks last, Ticks lookahead);
  // The last moment up to which all hold, from `from` on, where they do.
  Found ending(std::span<const program::FlowTest> tests, Ticks from, Ticks lookahead);

 private:
  // The sides of a comparison, turned so that it says that the difference is negative, or zero.
  struct Sides {
    double difference;
    double scale;
  };
  // The value of a condition at a moment.
  struct ConditionValue {
    bool exact;
    bool close;
    bool positive;
  };

  Sides sides(const program::FlowTest& test);
  ConditionValue value(const program::FlowTest& test);
  ConditionValue value_at(const program::FlowTest& test, Ticks moment) {
    flow_.show(moment, machine_, slots_);
    return value(test);
  }
  Ticks sample() const { return flow_sample(flow_.ticks_per_unit()); }
  bool solvable(std::span<const program::FlowTest> tests) const;
  Window solved(const program::FlowTest& test, Ticks from);
  Window solved(std::span<const program::FlowTest> tests, Ticks from);
  template <class Differs>
  Ticks first_different(const program::FlowTest& test, Ticks before, Ticks after, Differs differs);
  void crossings(std::span<const program::FlowTest> tests, Ticks before, Ticks after);

  Flow& flow_;
  machine::Machine& machine_;
  std::int32_t* slots_;
  std::vector<ConditionValue> values_;
  std::vector<Ticks> candidates_;
};

}  // namespace tachk::flow
