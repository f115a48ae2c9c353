// How hybrid clocks change while nothing happens: the solution of x' = rate(x) from the last change of a rate or a
// value.
//
// Where no rate depends on a hybrid clock the solution is a line. Otherwise it is computed by the method of Dormand and
// Prince of order 5 with error control and its interpolation of order 4 (Hairer, Norsett, Wanner, "Solving ordinary
// differential equations I", 1993, II.5 and II.6), up to the moment that a caller needs.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "flow/chances.hpp"
#include "flow/clock_values.hpp"
#include "machine/machine.hpp"

namespace tachk::flow {

class Flow {
 public:
  Flow(const Chances& chances, Ticks ticks_per_unit) : chances_(&chances), ticks_per_unit_(ticks_per_unit) {}

  bool exists() const { return !chances_->hybrid.empty(); }
  bool linear() const { return linear_; }
  Ticks ticks_per_unit() const { return ticks_per_unit_; }

  // The clocks have the values that are in the slots now, and change as the locations there say.
  void start(Ticks now, machine::Machine& machine, std::int32_t* slots);

  // The last moment up to `wanted` for which there is a solution: rates that have no value end it. Changes slots.
  Ticks known_up_to(Ticks wanted, machine::Machine& machine, std::int32_t* slots);

  // Writes the values of a moment, which is not before the start, to the slots. Throws the ModelFault of a rate that
  // has no value before.
  void show(Ticks moment, machine::Machine& machine, std::int32_t* slots);

 private:
  using Numbers = std::vector<double>;
  struct Step {
    double begin;
    double length;
    Numbers coefficients;  // five of each clock
  };

  std::size_t clocks() const { return chances_->hybrid.size(); }
  double since_start(Ticks moment) const {
    return static_cast<double>(moment - begin_) / static_cast<double>(ticks_per_unit_);
  }
  void write(const Numbers& values, std::int32_t* slots) const;
  void rates(const Numbers& values, Numbers& result, machine::Machine& machine, std::int32_t* slots) const;
  void advance(machine::Machine& machine, std::int32_t* slots);
  double error_of(double length, machine::Machine& machine, std::int32_t* slots);
  double try_step(double length, machine::Machine& machine, std::int32_t* slots);
  void extend(double wanted, machine::Machine& machine, std::int32_t* slots);
  double known() const { return steps_.empty() ? 0 : steps_.back().begin + steps_.back().length; }

  const Chances* chances_;
  Ticks ticks_per_unit_;
  Ticks begin_ = 0;
  bool linear_ = true;
  Numbers first_;                        // values at the start
  Numbers slopes_;                       // rates there
  std::vector<const FlowRate*> active_;  // of each clock; null: 1
  std::vector<Step> steps_;
  std::optional<machine::ModelFault> fault_;  // why there is no more
  // Of the integration: the last values and rates, the stages, and how long the next step should be.
  Numbers last_;
  Numbers stages_[7];
  Numbers tried_;
  double length_ = 0;
};

}  // namespace tachk::flow
