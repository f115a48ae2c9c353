// The rates and weights of events, which a program lacks because no search needs them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "machine/machine.hpp"
#include "program/program.hpp"

namespace tachk::flow {

// A number that is known, computed by code from the discrete state, or in a slot of it.
struct Number {
  enum class Kind : std::int32_t { floating_constant, integer_code, floating_code, slot, integer_constant };

  Kind kind = Kind::integer_constant;
  double constant = 1.0;
  std::int32_t code = program::no_code;  // or the number of the slot

  bool is_constant() const { return kind == Kind::floating_constant || kind == Kind::integer_constant; }
  bool integer() const { return kind != Kind::floating_constant && kind != Kind::floating_code; }
  // Throws ModelFault.
  double value(machine::Machine& machine, std::int32_t* slots) const;
};

// How fast a hybrid clock changes in a location.
struct FlowRate {
  std::uint32_t clock;  // its number among the hybrid ones
  bool varies;          // with the values of hybrid clocks
  Number rate;
};

struct Chances {
  std::vector<std::vector<Number>> rates;  // of each location of each process: of its exponential distribution
  std::vector<Number> weights;             // of each edge
  // Of each edge: edges with the same number are the branches of one way into a branchpoint.
  std::vector<std::uint32_t> choices;
  std::vector<std::int32_t> starts;                            // code that draws initial values
  std::vector<Number> observed;                                // what is recorded
  std::vector<std::uint32_t> hybrid;                           // the first slot of each hybrid clock
  std::vector<std::vector<std::vector<FlowRate>>> flow_rates;  // of each location of each process
  program::SlotSet flow_reads;                                 // what these rates depend on
};

// Reads the flat form that tachk.engine.simulation.simulator writes. Throws std::invalid_argument if the numbers do
// not fit the program.
Chances decode_chances(std::span<const std::int64_t> image, const program::Program& program);

}  // namespace tachk::flow
