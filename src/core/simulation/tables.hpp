// What a simulation looks up for each location: computed once for a program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "flow/chances.hpp"
#include "program/program.hpp"

namespace tachk {

// A location of a process.
struct Station {
  const Location* location;
  const Number* rate;
  std::vector<std::uint32_t> outputs;   // internal and sending edges
  std::vector<std::uint32_t> receives;  // receiving edges
  std::vector<std::uint32_t> urgent;    // sending edges over channels that may be urgent
  SlotSet reads;                        // what guards of outputs, invariant and rate depend on
  std::uint64_t clocks = 0;             // the same of clocks: of 64 groups of clocks those with a member
  bool looks_at_flow = false;           // the same of hybrid clocks

  bool freezes() const { return location->urgent || location->committed; }
};

constexpr std::uint64_t clock_group(std::size_t clock) { return std::uint64_t{1} << (clock % 64); }

struct Tables {
  Tables(const Program& program, const Chances& chances);

  const Station& place(std::size_t process, const std::int32_t* slots) const {
    return places[first_place[process] + static_cast<std::size_t>(slots[process])];
  }

  std::vector<Station> places;
  std::vector<std::size_t> first_place;               // of each process
  std::vector<std::vector<std::uint32_t>> listening;  // of each channel: the processes that may receive
  std::vector<std::uint32_t> meta_slots;
  std::vector<std::uint32_t> urgent_senders;  // the processes that may send over urgent channels
  bool has_branches = false;                  // some edges share a way into a branchpoint
  bool reads_locations = false;               // some guard does
};

}  // namespace tachk
