// What one thread has found of the states of one block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>
#include <vector>

#include "states/store.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::reachability::ahead {

// A successor that no stored state covered when it was found.
struct Found {
  static constexpr std::uint32_t none = UINT32_MAX;

  std::uint32_t discrete;     // HashIndex::absent where that discrete state was not known
  std::uint32_t slots;        // where its slots begin
  std::uint32_t zone;         // as the step leads to it
  std::uint32_t abstract;     // abstracted; none where it is taken to be covered
  std::uint32_t transitions;  // of the state, up to here
  std::uint32_t finder;       // who found it
  std::uint64_t key;          // equal for equal discrete states
  std::uint64_t hash = 0;     // of the abstracted zone as it is stored
  bool further = false;       // one more abstracted zone of the successor before this one
  bool meets = true;          // it may meet a goal
  // That it covers none of the stored states, nor of those found for earlier states, and none of these covers it.
  bool apart = false;
  std::uint32_t own_coverer = none;      // one of the same harvest
  const Found* coverer = nullptr;        // that one, or one of another harvest; nullptr: none covers it
  Found* before = nullptr;               // the one with the same discrete state that was found before
  std::uint32_t node = states::no_node;  // its number, once it is stored
};

// A successor of which only the step has been computed.
struct Step {
  std::uint32_t slots;
  std::uint32_t zone;
  std::uint32_t transitions;
  program::SlotSet written;
};

// What was found of a state: ranges of what the harvest holds.
struct Expansion {
  std::size_t first = 0;  // of its successors: steps, and once these are looked at, what was found
  std::size_t last = 0;
  std::size_t first_edge = 0;  // of those taken
  std::size_t last_edge = 0;
  std::uint32_t transitions = 0;
  std::vector<std::size_t> stuck;  // goals that the state satisfies, being stuck or not as they ask
  std::exception_ptr failure;      // behind all this
  bool alone = false;              // a goal has failed: the search has to expand the state itself
};

class Harvest final {
 public:
  // Forgets everything, but for the memory.
  void clear() {
    zones_used_ = 0;
    slots_.clear();
    found.clear();
    steps.clear();
    edges.clear();
    expansions.clear();
  }

  std::uint32_t keep(zones::ConstZoneRef zone, const zones::ZoneOperations& operations) {
    if (zones_used_ == zones_.size()) zones_.emplace_back(operations);
    zones_[zones_used_].assign(zone);
    return static_cast<std::uint32_t>(zones_used_++);
  }
  std::uint32_t keep(const std::int32_t* slots, std::size_t count) {
    const std::size_t first = slots_.size();
    slots_.insert(slots_.end(), slots, slots + count);
    return static_cast<std::uint32_t>(first);
  }
  zones::ConstZoneRef zone(std::uint32_t number) const { return zones_[number].get(); }
  const std::int32_t* slots(std::uint32_t first) const { return slots_.data() + first; }
  std::size_t zones() const { return zones_used_; }

  std::vector<Found> found;
  std::vector<Step> steps;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  // one that was taken, by which transition of its state
  std::vector<Expansion> expansions;                           // in the order in which states were expanded

 private:
  std::size_t zones_used_ = 0;
  std::vector<zones::ZoneBuffer> zones_;
  std::vector<std::int32_t> slots_;
};

}  // namespace tachk::reachability::ahead
