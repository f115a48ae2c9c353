// The states of some discrete parts: their zones, and for each discrete part an antichain of them. Different shares of
// one passed list may be changed by different threads at the same time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "states/antichain.hpp"
#include "states/discrete.hpp"
#include "states/nodes.hpp"
#include "states/zone_store.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk {

class alignas(64) Share final {
 public:
  Share(ZoneStore zones, const ZoneOperations& scaled, int dimension, bool reclaim, Nodes& nodes,
        DiscreteStates& discretes);

  // The first three and the last of these may be asked by several threads as long as nobody changes the share.
  std::uint32_t coverer(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds) const;
  std::uint32_t find(std::uint32_t discrete, ZoneView zone) const;
  std::size_t count(std::uint32_t discrete) const;
  const ZoneStore& zones() const { return zones_; }

  // Calls look(zone) for the number of the zone of each node of an antichain from `first` on, the newest first, and
  // appends the nodes for which it says yes to `parts`.
  template <class Look>
  void for_each_waiting(std::uint32_t discrete, std::uint32_t first, std::vector<std::uint32_t>& parts,
                        Look look) const;
  // Unites a zone with this one, if that makes a zone which is larger.
  bool unite(ZoneRef united, int dimension, std::uint32_t zone);

  std::uint32_t intern(ZoneView zone) { return zones_.intern(zone); }
  // One fewer needs a zone. What a covered node keeps of it.
  std::uint32_t give_up(std::uint32_t zone);
  // Whether an antichain has a member with this zone, which has this number.
  bool holds(std::uint32_t discrete, ZoneView zone, std::uint32_t zone_number) const;
  // Removes the members of an antichain that the zone covers.
  void thin_out(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds);
  // Adds a node, which has its discrete state and its zone, to its antichain.
  void append(std::uint32_t discrete, std::uint32_t number);

  void wait_from(std::uint32_t first) { first_waiting_ = first; }
  void release(std::uint32_t zone_number) { zones_.release(zone_number); }

  // The nodes that have been removed since this was cleared.
  std::vector<std::uint32_t>& covered() { return covered_; }
  const std::vector<std::uint32_t>& covered() const { return covered_; }

  std::size_t bytes() const { return zones_.bytes() + chain_bytes_ + chains_.capacity() * sizeof(Antichain); }

 private:
  static constexpr std::size_t short_chain = 8;
  static constexpr std::uint32_t mark = Nodes::mark;

  bool is_long(std::uint32_t head) const { return head != no_node && (head & mark) != 0; }
  Antichain& chain(std::uint32_t head) { return chains_[head & ~mark]; }
  const Antichain& chain(std::uint32_t head) const { return chains_[head & ~mark]; }
  // The first node of the antichain of a discrete part, or the number of a long one with the mark.
  std::uint32_t& head(std::uint32_t discrete) { return discretes_.note(discrete); }
  std::uint32_t head(std::uint32_t discrete) const {
    return static_cast<const DiscreteStates&>(discretes_).note(discrete);
  }
  ZoneView zone(std::uint32_t number) { return zones_.read(nodes_.zone(number), buffer_.get()); }
  bool is_above(std::uint32_t number, ZoneView zone, const ClockBounds* bounds) const {
    return zones_.covers(nodes_.zone(number), zone, bounds);
  }
  bool is_below(std::uint32_t number, ZoneView zone, const ClockBounds* bounds) const {
    return zones_.is_covered(nodes_.zone(number), zone, bounds);
  }
  void cover(std::uint32_t number, std::uint32_t discrete);
  void add_to(Antichain& members, std::uint32_t number);
  Extent extent_of(ZoneView zone) const {
    return zones_.operations(zone.dimension).extent(zone.data, zone.dimension, scale_);
  }
  // Chooses the scale for a larger entry than has been seen, and with it all extents anew.
  void rescale(Raw largest_entry);

  int dimension_;
  ZoneStore zones_;
  ZoneBuffer buffer_;      // for a copy of one of them
  ZoneOperations scaled_;  // for which the scale is chosen
  bool reclaim_;
  ExtentScale scale_;
  Nodes& nodes_;
  DiscreteStates& discretes_;
  std::vector<Antichain> chains_;
  std::size_t chain_bytes_ = 0;
  std::vector<std::uint32_t> covered_;
  std::uint32_t first_waiting_ = UINT32_MAX;
};

template <class Look>
void Share::for_each_waiting(std::uint32_t discrete, std::uint32_t first, std::vector<std::uint32_t>& parts,
                             Look look) const {
  const auto visit = [&](std::uint32_t number) {
    if (number >= first && !nodes_.covered(number) && look(nodes_.zone(number))) parts.push_back(number);
  };
  if (const std::uint32_t newest = head(discrete); is_long(newest))
    chain(newest).for_each_waiting(first, visit);
  else
    for (std::uint32_t number = newest; number != no_node; number = nodes_.next(number)) visit(number);
}

}  // namespace tachk
