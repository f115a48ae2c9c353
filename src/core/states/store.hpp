// The states that have been seen: discrete parts and zones interned, and for each discrete part an antichain of zones.
// A node costs 8 bytes and its parent about one; a zone or a discrete part that many nodes share is held once. A
// covered node stays, because paths lead through it, but the memory of a zone that only covered nodes have is used
// again.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "program/program.hpp"
#include "states/antichain.hpp"
#include "states/discrete.hpp"
#include "states/fitted_scale.hpp"
#include "states/memory.hpp"
#include "states/parents.hpp"
#include "states/zone_store.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::states {

inline constexpr std::uint32_t no_node = UINT32_MAX;

struct StoreOptions {
  bool reclaim = true;          // the zones of covered nodes are given up
  std::size_t chunk_words = 8;  // of the parts in which large discrete states are held; 0: in one
  // From how many zones on their rows are held once each, if that takes less memory; 0: they always are.
  std::uint32_t rows_after = 1024;
  // The same of zones in reduced form, if that takes far less memory and there are neither few nor many clocks.
  std::uint32_t reduced_after = 1024;
};

class PassedList {
 public:
  // `smaller`: as of a ZoneStore; all zones of a discrete state have one dimension.
  PassedList(const program::Program& program, const zones::ZoneOperations& zones, const StoreOptions& options,
             const std::vector<zones::ZoneOperations>& smaller = {});

  // Sets the discrete state that the next `locate` looks up. Call it early, so that its memory is fetched in the
  // meantime. All slots in which it differs from the state unpacked last are in `written`.
  void announce(const std::int32_t* slots, const program::SlotSet& written) { discretes_.announce(slots, written); }
  // The number of that state, which is new if it was never looked up before.
  std::uint32_t locate() { return discretes_.locate(no_node); }

  // True if a stored zone of this discrete state contains the zone; with `bounds` (may be null), simulates it.
  bool covers(std::uint32_t discrete, ZoneView zone, const zones::ClockBounds* bounds = nullptr) const {
    return coverer(discrete, zone, bounds) != no_node;
  }
  // A stored state with this discrete part whose zone does; no_node if there is none.
  std::uint32_t coverer(std::uint32_t discrete, ZoneView zone, const zones::ClockBounds* bounds = nullptr) const;
  // The states with this number and larger ones wait, and are to be found by `merge`. To be set before any is added,
  // and whenever it grows.
  void wait_from(std::uint32_t first) { first_waiting_ = first; }
  // Merges a zone with those of this discrete state in nodes from `first` on, one after the other, where that makes a
  // zone which is larger. The union goes to `merged`, the nodes are added to `parts`. Returns how many zones were
  // compared.
  std::size_t merge(std::uint32_t discrete, ZoneView zone, std::uint32_t first, zones::ZoneRef merged,
                    std::vector<std::uint32_t>& parts);
  // How many states with this discrete part are stored.
  std::size_t count(std::uint32_t discrete) const;

  // The stored state with this discrete part and this zone; no_node if there is none.
  std::uint32_t find(std::uint32_t discrete, ZoneView zone) const;

  // As `covers`; without `subsumption`, whether an equal zone is stored.
  bool contains(std::uint32_t discrete, ZoneView zone, bool subsumption) const;

  // Adds a state unless it is covered; removes the states that it covers. The number of the new node, or no_node.
  // With `subsumption` a state is covered by a state with a zone that contains its own, or simulates it, as for
  // `covers`; without by an equal one only.
  std::uint32_t add(std::uint32_t discrete, ZoneView zone, std::uint32_t parent, bool subsumption,
                    const zones::ClockBounds* bounds = nullptr);

  // The same for a state that is known not to be covered, with subsumption.
  std::uint32_t add_uncovered(std::uint32_t discrete, ZoneView zone, std::uint32_t parent,
                              const zones::ClockBounds* bounds = nullptr);

  // The nodes that the last of these has removed.
  const std::vector<std::uint32_t>& covered_last() const { return covered_last_; }

  // From now on the nodes with numbers from `first` to `last`, without it, are not covered by others.
  void protect(std::uint32_t first, std::uint32_t last) { protected_ = {first, last - first}; }

  std::uint32_t size() const { return nodes_.size(); }
  std::uint32_t stored() const { return stored_; }
  // How many discrete states there are.
  std::uint32_t discrete_states() const { return discretes_.size(); }
  bool covered(std::uint32_t number) const { return (node(number).zone & mark) != 0; }
  // The number of the discrete state of a node.
  std::uint32_t discrete(std::uint32_t number) const {
    std::uint32_t link = node(number).link;
    while ((link & mark) == 0) link = node(link).link;
    return link & ~mark;
  }
  // The node that a node has been reached from; no_node for the initial state.
  std::uint32_t parent(std::uint32_t number) const { return parents_[number]; }
  // The zone of a node that is not covered, or a copy of it in the buffer.
  ZoneView zone(std::uint32_t number, zones::ZoneBuffer& buffer) const {
    return zones_.read(zone_of(number), buffer.get());
  }
  // Writes that zone.
  void copy_zone(std::uint32_t number, zones::ZoneBuffer& zone) const {
    const ZoneView held = this->zone(number, zone);
    if (held.data.bytes != zone.get().bytes)
      std::memcpy(zone.get().bytes, held.data.bytes, zones_.operations(held.dimension).bytes);
  }
  // True if the zone of a node that is not covered contains this one of the same discrete state.
  bool includes(std::uint32_t number, ZoneView zone) const { return zones_.covers(zone_of(number), zone); }
  void unpack(std::uint32_t number, std::int32_t* slots) { discretes_.unpack(discrete(number), slots); }
  void unpack_discrete(std::uint32_t discrete, std::int32_t* slots) { discretes_.unpack(discrete, slots); }
  // True if a node has this discrete state.
  bool equals(std::uint32_t number, const std::int32_t* slots) { return discretes_.equals(discrete(number), slots); }
  // True if a node has this zone; of a covered node, whether it has one with this hash.
  bool may_equal(std::uint32_t number, ZoneView zone) const;
  std::size_t bytes() const;
  // How many members of long antichains have been looked at.
  std::uint64_t examined() const { return examined_; }

 private:
  static constexpr std::size_t short_chain = 8;
  static constexpr std::uint32_t mark = std::uint32_t{1} << 31;

  struct Node {
    std::uint32_t link;  // the next in a short antichain; for the last one and others, the discrete state and the mark
    std::uint32_t zone;  // of a covered node with the mark: if its zone may be gone, what else fits of the hash of that
  };

  // A zone that is looked up or added, and its extent, which is summed up once.
  class Measured {
   public:
    Measured(const PassedList& states, ZoneView zone) : states_(states), zone_(zone) {}
    operator ZoneView() const { return zone_; }
    const zones::Extent& extent() {
      if (!extent_) extent_ = states_.extent_of(zone_);
      return *extent_;
    }
    // The scale has changed.
    void forget_extent() { extent_.reset(); }

   private:
    const PassedList& states_;
    ZoneView zone_;
    std::optional<zones::Extent> extent_;
  };

  bool is_long(std::uint32_t head) const { return head != no_node && (head & mark) != 0; }
  Antichain& chain(std::uint32_t head) { return chains_[head & ~mark]; }
  const Antichain& chain(std::uint32_t head) const { return chains_[head & ~mark]; }
  const Node& node(std::uint32_t number) const { return *reinterpret_cast<const Node*>(nodes_[number]); }
  std::uint32_t zone_of(std::uint32_t number) const { return node(number).zone & ~mark; }
  // The next in a short antichain; no_node behind the last.
  std::uint32_t next(std::uint32_t number) const {
    const std::uint32_t link = node(number).link;
    return (link & mark) != 0 ? no_node : link;
  }
  std::uint32_t coverer(std::uint32_t discrete, Measured& zone, const zones::ClockBounds* bounds) const;
  // Removes the members of an antichain that the zone covers.
  void thin_out(std::uint32_t discrete, Measured& zone, const zones::ClockBounds* bounds);
  bool is_above(std::uint32_t number, ZoneView zone, const zones::ClockBounds* bounds) const {
    return zones_.covers(zone_of(number), zone, bounds);
  }
  bool is_below(std::uint32_t number, ZoneView zone, const zones::ClockBounds* bounds) const {
    return zones_.is_covered(zone_of(number), zone, bounds);
  }
  void cover(std::uint32_t number, std::uint32_t discrete);
  std::uint32_t append_node(std::uint32_t discrete, std::uint32_t zone_number, std::uint32_t parent, Measured& zone);
  std::uint32_t add_uncovered(std::uint32_t discrete, Measured& zone, std::uint32_t parent,
                              const zones::ClockBounds* bounds);
  bool is_protected(std::uint32_t number) const { return number - protected_.first < protected_.count; }
  // True if an antichain has a member with this zone, which has this number.
  bool holds(std::uint32_t head, Measured& zone, std::uint32_t zone_number) const;
  void append(std::uint32_t discrete, std::uint32_t number, Measured& zone);
  void add_to(Antichain& members, std::uint32_t number, Measured& zone);
  zones::Extent extent_of(ZoneView zone) const {
    return zones_.operations(zone.dimension).extent(zone.data, zone.dimension, scale_.scale());
  }
  // Gives all members of long antichains extents in the scale that has just been chosen.
  void measure_anew();
  void fit_scale(const Antichain& members);
  // The first node of the antichain of a discrete part, or the number of a long one with the mark.
  std::uint32_t& head(std::uint32_t discrete) { return discretes_.note(discrete); }
  std::uint32_t head(std::uint32_t discrete) const { return discretes_.note(discrete); }
  Node& entry(std::uint32_t number) { return *reinterpret_cast<Node*>(nodes_[number]); }

  int dimension_;
  ZoneStore zones_;
  zones::ZoneBuffer buffer_;  // for a copy of one of them
  bool reclaim_;
  FittedScale scale_;
  DiscreteStates discretes_;
  RecordPool nodes_;
  Parents parents_;
  std::vector<Antichain> chains_;
  std::size_t chain_bytes_ = 0;
  std::uint32_t stored_ = 0;
  mutable std::uint64_t examined_ = 0;
  std::vector<std::uint32_t> covered_last_;
  std::uint32_t first_waiting_ = UINT32_MAX;
  struct {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  } protected_;
};

}  // namespace tachk::states
