// The states that have been seen: discrete parts and zones interned, and for each discrete part an antichain of zones.
// A node costs 8 bytes and its parent about one; a zone or a discrete part that many nodes share is held once. A
// covered node stays, because paths lead through it, but the memory of a zone that only covered nodes have is used
// again. Where several threads add states, they are divided into shares by their discrete parts, and a zone is held
// once in each.
#pragma once

#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "program/program.hpp"
#include "states/discrete.hpp"
#include "states/nodes.hpp"
#include "states/parents.hpp"
#include "states/share.hpp"
#include "states/zone_store.hpp"
#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk {

struct StoreOptions {
  bool reclaim = true;          // the zones of covered nodes are given up
  std::size_t chunk_words = 8;  // of the parts in which large discrete states are held; 0: in one
  // From how many zones on their rows are held once each, if that takes less memory; 0: they always are.
  std::uint32_t rows_after = 1024;
};

class PassedList {
 public:
  // `smaller`: as of a ZoneStore; all zones of a discrete state have one dimension. There are 2^share_bits shares.
  PassedList(const Program& program, const ZoneOperations& zones, const StoreOptions& options,
             const std::vector<ZoneOperations>& smaller = {}, unsigned share_bits = 0);
  PassedList(const PassedList&) = delete;
  PassedList& operator=(const PassedList&) = delete;

  // Sets the discrete state that the next `locate` looks up. Call it early, so that its memory is fetched in the
  // meantime. All slots in which it differs from the state unpacked last are in `written`.
  void announce(const std::int32_t* slots, const SlotSet& written) { discretes_.announce(slots, written); }
  // The number of that state, which is new if nobody has asked for it before.
  std::uint32_t locate() { return discretes_.locate(no_node); }

  // Whether a stored zone of this discrete state contains the zone; with `bounds` (may be null), simulates it.
  bool covers(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds = nullptr) const {
    return coverer(discrete, zone, bounds) != no_node;
  }
  // A stored state with this discrete part whose zone does; no_node if there is none.
  std::uint32_t coverer(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds = nullptr) const {
    return share_of(discrete).coverer(discrete, zone, bounds);
  }
  // The states with this number and larger ones wait, and are to be found by `unite`. To be told before any is added,
  // and whenever it grows.
  void wait_from(std::uint32_t first) {
    for (Share& share : shares_) share.wait_from(first);
  }
  // Unites a zone with those of this discrete state in nodes from `first` on, one after the other, where that makes a
  // zone which is larger. The union goes to `united`, the nodes are added to `parts`. How many zones were looked at.
  std::size_t unite(std::uint32_t discrete, ZoneView zone, std::uint32_t first, ZoneRef united,
                    std::vector<std::uint32_t>& parts);
  // How many states with this discrete part are stored.
  std::size_t count(std::uint32_t discrete) const { return share_of(discrete).count(discrete); }

  // The stored state with this discrete part and this zone; no_node if there is none.
  std::uint32_t find(std::uint32_t discrete, ZoneView zone) const { return share_of(discrete).find(discrete, zone); }

  // As `covers`; without `subsumption`, whether an equal zone is stored.
  bool contains(std::uint32_t discrete, ZoneView zone, bool subsumption) const;

  // Adds a state unless it is covered; removes the states that it covers. The number of the new node, or no_node.
  // With `subsumption` a state is covered by a state with a zone that contains its own, or simulates it, as for
  // `covers`; without by an equal one only.
  std::uint32_t add(std::uint32_t discrete, ZoneView zone, std::uint32_t parent, bool subsumption,
                    const ClockBounds* bounds = nullptr);

  // What several threads may ask at once, as long as nobody adds a state, each with a reader of its own.
  DiscreteStates::Reader reader() const { return discretes_.reader(); }
  void unpack(std::uint32_t number, std::int32_t* slots, DiscreteStates::Reader& reader) const {
    discretes_.unpack(discrete(number), slots, reader);
  }
  // As `announce` without a reader, of the state that this one unpacked last, and the number of the announced state or
  // HashIndex::absent.
  void announce(const std::int32_t* slots, const SlotSet& written, DiscreteStates::Reader& reader) const {
    discretes_.announce(slots, written, reader);
  }
  std::uint32_t locate(const DiscreteStates::Reader& reader) const { return discretes_.find(reader); }

  // What was announced last, and not to a reader.
  const DiscreteStates::Reader& announced() const { return discretes_.announced(); }

  // What several threads may add, each to a share of its own. `locate`: as without arguments, for what was announced to
  // a reader.
  std::size_t shares() const { return shares_.size(); }
  Share& parts(std::size_t share) { return shares_[share]; }
  std::size_t key_words() const { return discretes_.key_words(); }
  std::uint32_t locate(const std::uint64_t* key, std::uint64_t hash) { return discretes_.locate(key, hash, no_node); }
  // The number of a node that is going to be settled.
  std::uint32_t append(std::uint32_t parent);
  Nodes& nodes() { return nodes_; }
  // So many more states are stored, less those that were covered.
  void count_stored(std::int64_t more) {
    stored_ = static_cast<std::uint32_t>(static_cast<std::int64_t>(stored_) + more);
  }

  // The nodes that the last `add` has removed.
  const std::vector<std::uint32_t>& covered_last() const { return *covered_last_; }

  // From now on these nodes, whose numbers rise, and those from `first` to `last`, without it, are not covered by
  // others.
  void protect(std::vector<std::uint32_t> nodes, std::uint32_t first, std::uint32_t last) {
    nodes_.protect(std::move(nodes), first, last);
  }

  std::uint32_t size() const { return nodes_.size(); }
  std::uint32_t stored() const { return stored_; }
  // How many discrete states there are.
  std::uint32_t discrete_states() const { return discretes_.size(); }
  bool covered(std::uint32_t number) const { return nodes_.covered(number); }
  // The number of the discrete state of a node.
  std::uint32_t discrete(std::uint32_t number) const { return nodes_.discrete(number); }
  // The node that a node has been reached from; no_node for the initial state.
  std::uint32_t parent(std::uint32_t number) const { return parents_[number]; }
  // The zone of a node that is not covered, or a copy of it in the buffer.
  ZoneView zone(std::uint32_t number, ZoneBuffer& buffer) const {
    return zones_of(number).read(nodes_.zone(number), buffer.get());
  }
  // Writes that zone.
  void copy_zone(std::uint32_t number, ZoneBuffer& zone) const {
    const ZoneView held = this->zone(number, zone);
    if (held.data.bytes != zone.get().bytes)
      std::memcpy(zone.get().bytes, held.data.bytes, zones_of(number).operations(held.dimension).bytes);
  }
  // Whether the zone of a node that is not covered contains this one of the same discrete state.
  bool includes(std::uint32_t number, ZoneView zone) const {
    return zones_of(number).covers(nodes_.zone(number), zone);
  }
  void unpack(std::uint32_t number, std::int32_t* slots) { discretes_.unpack(discrete(number), slots); }
  void unpack_discrete(std::uint32_t discrete, std::int32_t* slots) { discretes_.unpack(discrete, slots); }
  // Whether a node has this discrete state.
  bool equals(std::uint32_t number, const std::int32_t* slots) { return discretes_.equals(discrete(number), slots); }
  // Whether a node has this zone; of a covered node, whether it has one with this hash.
  bool may_equal(std::uint32_t number, ZoneView zone) const;
  std::size_t bytes() const;

 private:
  Share& share_of(std::uint32_t discrete) { return shares_[discretes_.share_of(discrete)]; }
  const Share& share_of(std::uint32_t discrete) const { return shares_[discretes_.share_of(discrete)]; }
  const ZoneStore& zones_of(std::uint32_t node) const {
    return (shares_.size() == 1 ? shares_.front() : share_of(discrete(node))).zones();
  }

  Nodes nodes_;
  Parents parents_;
  DiscreteStates discretes_;
  std::vector<Share> shares_;
  bool reclaim_;
  std::uint32_t stored_ = 0;
  const std::vector<std::uint32_t>* covered_last_;  // of the share to which a state was added last
};

}  // namespace tachk
