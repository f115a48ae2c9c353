// The tables of a simulation for each location: computed once for a program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "flow/chances.hpp"
#include "machine/code_accesses.hpp"
#include "program/program.hpp"
#include "simulation/process_set.hpp"

namespace tachk::simulation {

// The dependencies of a location, which every transition reads for each process: small, so that they lie side by side.
struct Dependencies {
  program::SlotSet reads;        // what guards of outputs, invariant and rate depend on
  std::uint64_t clocks = 0;      // the same of clocks: of 64 groups of clocks those with a member
  bool depends_on_flow = false;  // the same of hybrid clocks
  bool committed = false;
  bool urgent = false;
  bool has_invariant = false;
};

// The first test of a guard, kept where the edge is looked up: most guards that are false fail there.
struct FirstTest {
  program::Test test;

  explicit FirstTest(const program::Condition& guard)
      : test(guard.tests.empty() ? program::Test{0, program::Comparison::greater_equal, INT32_MIN}
                                 : guard.tests.front()) {}
  bool may_hold(const std::int32_t* slots) const { return test.holds(slots); }
};

// An internal or sending edge.
struct Output {
  std::uint32_t edge;
  FirstTest first_test;
};

// An edge that receives over some channels, from one on.
struct ReceivingEdge {
  std::uint32_t edge;
  FirstTest first_test;
  std::int32_t channel;
  std::uint32_t channels;

  bool may_name(std::int32_t number) const {
    return static_cast<std::uint32_t>(number) - static_cast<std::uint32_t>(channel) < channels;
  }
};

// A location of a process.
struct LocationTables {
  const program::Location* location;
  const flow::Number* rate;
  std::vector<Output> outputs;
  std::vector<ReceivingEdge> receives;
  std::vector<std::uint32_t> urgent;  // sending edges over channels that may be urgent
  Dependencies dependencies;

  bool freezes() const { return dependencies.urgent || dependencies.committed; }
};

// The processes of which some location depends on a clock or a slot, whatever the location is in which they are.
struct Readers {
  std::vector<ProcessSet> of_clock;  // by its number
  std::vector<ProcessSet> of_slots;  // by the group of slots, `program::SlotSet::group_of`
  ProcessSet of_flow{0};             // of hybrid clocks
};

constexpr std::uint64_t clock_group(std::size_t clock) { return std::uint64_t{1} << (clock % 64); }

struct Tables {
  Tables(const program::Program& program, const flow::Chances& chances);

  const LocationTables& place(std::size_t process, const std::int32_t* slots) const {
    return places[first_place[process] + static_cast<std::size_t>(slots[process])];
  }

  std::vector<LocationTables> places;
  std::vector<std::size_t> first_place;                  // of each process
  std::vector<std::vector<std::uint32_t>> receivers_of;  // of each channel: the processes that may receive
  Readers readers;
  std::vector<std::uint32_t> meta_slots;
  std::vector<std::uint32_t> urgent_senders;  // the processes that may send over urgent channels
  bool has_branches = false;                  // some edges share a way into a branchpoint
  bool reads_locations = false;               // some guard does

 private:
  void add_edge(const program::Program& program, std::uint32_t number);
  void add_dependencies(const program::Program& program, std::size_t process, LocationTables& place,
                        machine::CodeAccesses& accesses);
};

}  // namespace tachk::simulation
