// The data of a unit for co-simulation: a file that `tachk convert --format fmu` writes, and that lies beside the
// library. `tachk.simulation.fmi.resource_file` has the same fields.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "flow/chances.hpp"
#include "flow/clock_values.hpp"
#include "program/program.hpp"
#include "simulation/tables.hpp"

namespace tachk::fmi {

// The role of a variable of a unit, and the meaning of its number.
enum class Role : std::int64_t {
  time,
  seed,         // of the random numbers
  run,          // its number
  policy,       // how processes choose moments
  transitions,  // how many there have been
  observed,     // a value of the network: its place in `Chances::observed`
  input,        // what the environment writes: the slot of what it writes, and of the variable it is for
  receives,     // a channel over which the environment sends: the edge that does it
  sends,        // a channel over which the network sends: the edge that takes notice
};

enum class Type : std::int64_t { real, integer, truth, enumeration, natural, clock };

struct Variable {
  Role role;
  Type type;
  std::int64_t number;
  std::int64_t target;  // of an input: the slot of the variable; -1 if its value does not last
};

// Seconds as ticks: a tick is numerator / denominator seconds.
class TimeScale {
 public:
  TimeScale() = default;
  TimeScale(std::int64_t numerator, std::int64_t denominator) : numerator_(numerator), denominator_(denominator) {}

  // The scale whose ticks are ten of these.
  TimeScale coarser() const { return {10 * numerator_, denominator_}; }
  // True if a time can be counted in ticks.
  bool holds(double seconds) const;

  // The nearest double.
  double seconds(flow::Ticks ticks) const;
  // The nearest tick. Throws std::invalid_argument for a time that is too large, or none.
  flow::Ticks ticks(double seconds) const;
  // How many ticks a time may be off because it is a double.
  flow::Ticks slack(double seconds) const;

 private:
  std::int64_t numerator_ = 1;
  std::int64_t denominator_ = 1;
};

struct ResourceFile {
  // Throws std::invalid_argument if the file is none.
  explicit ResourceFile(const std::string& path);
  ResourceFile(const ResourceFile&) = delete;
  ResourceFile& operator=(const ResourceFile&) = delete;

  std::array<std::int64_t, 2> fingerprint;
  TimeScale scale;     // of the finest ticks
  std::int64_t nudge;  // the edge by which the environment writes without sending; -1 if it never does
  std::vector<Variable> variables;
  program::Program program;
  flow::Chances chances;
  simulation::Tables tables;

  std::string token() const;  // of the fingerprint
  bool open() const { return nudge >= 0; }

 private:
  struct Numbers;
  explicit ResourceFile(Numbers numbers);
};

}  // namespace tachk::fmi
