// Zones that wait in the same discrete state are merged where their union is a zone: what different orders of the same
// actions lead to often is one (R. Ben Salah, M. Bozga, O. Maler, "On interleaving in timed automata", CONCUR 2006). So
// the same states are reached, in fewer pieces.
//
// A state that has been made of several does not come from its parent alone. What it has been made of is kept, so that
// the discrete states through which it can be reached are known: a run to it is found by a search among them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "states/adaptive_check.hpp"
#include "states/store.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::reachability::merging {

class Merging final {
 public:
  // Not `allowed`: nothing is merged.
  Merging(bool allowed, const zones::ZoneOperations& operations)
      : allowed_(allowed), check_(allowed, states::AdaptiveCheck::short_first), merged_(operations) {}

  // The union of the zone with as many as possible of those that wait in this discrete state, in nodes from `first` on.
  states::ZoneView merged(states::PassedList& passed, std::uint32_t discrete, states::ZoneView zone,
                          std::uint32_t first);
  // The node that has the zone returned last.
  void stored(std::uint32_t node);

  // True if anything has been merged.
  bool any() const { return !parts_.empty(); }
  // A node and all through which its states are reached.
  std::vector<std::uint32_t> origins(const states::PassedList& passed, std::uint32_t node) const;

  std::size_t bytes() const { return parts_.capacity() * sizeof(Part); }

 private:
  struct Part {
    std::uint32_t whole;  // ascending
    std::uint32_t node;
  };

  bool allowed_;
  states::AdaptiveCheck check_;
  zones::ZoneBuffer merged_;
  std::vector<std::uint32_t> fresh_;  // what the zone returned last has been made of, besides what was new
  std::vector<Part> parts_;
};

}  // namespace tachk::reachability::merging
