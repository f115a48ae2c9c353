// The states that have been seen: discrete parts bit-packed and interned, zones interned, and for each discrete part an
// antichain of zones. A node costs 16 bytes; a zone or a discrete part that many nodes share is held once.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "tachk/memory.hpp"
#include "tachk/program.hpp"
#include "tachk/zone.hpp"

namespace tachk {

// Packs the slots of a state into 64-bit words; a slot with one legal value takes no bits, no slot crosses a word.
class StateLayout {
 public:
  explicit StateLayout(const Program& program);

  std::size_t words() const { return words_; }
  void pack(const std::int32_t* slots, std::uint64_t* words) const;
  // Fills all state slots; meta slots get their initial values.
  void unpack(const std::uint64_t* words, std::int32_t* slots) const;

 private:
  struct Field {
    std::uint32_t slot;
    std::uint32_t word;
    std::uint32_t shift;
    std::uint64_t mask;
    std::int32_t low;
  };
  std::vector<Field> fields_;
  std::vector<std::int32_t> initial_;
  std::size_t words_ = 1;
};

inline constexpr std::uint32_t no_node = UINT32_MAX;

struct Node {
  std::uint32_t discrete;
  std::uint32_t zone;
  std::uint32_t parent;  // no_node for the initial state
  std::uint32_t next;    // in the antichain of the discrete part; covered_mark once a larger zone has come
};

inline constexpr std::uint32_t covered_mark = UINT32_MAX - 1;

class PassedList {
 public:
  PassedList(const Program& program, const ZoneOperations& zones);

  // The number of a discrete state, which is new if nobody has asked for it before.
  std::uint32_t locate(const std::int32_t* slots);

  // Whether a stored zone of this discrete state contains the zone.
  bool covers(std::uint32_t discrete, const void* zone) const;

  // Adds a state unless it is covered; removes the states that it covers. The number of the new node, or no_node.
  // With `subsumption` a state is covered by a state with a zone that contains its own, without by an equal one only.
  std::uint32_t add(std::uint32_t discrete, const void* zone, std::uint32_t parent, bool subsumption);

  std::uint32_t size() const { return nodes_.size(); }
  std::uint32_t stored() const { return stored_; }
  const Node& node(std::uint32_t number) const { return *reinterpret_cast<const Node*>(nodes_[number]); }
  bool covered(std::uint32_t number) const { return node(number).next == covered_mark; }
  const void* zone(const Node& node) const { return zones_[node.zone]; }
  void unpack(const Node& node, std::int32_t* slots) const {
    layout_.unpack(reinterpret_cast<const std::uint64_t*>(discretes_[node.discrete]), slots);
  }
  // Whether a node has exactly this state.
  bool equals(const Node& node, const std::int32_t* slots, const void* zone);
  std::size_t bytes() const;

 private:
  // A discrete part is its packed words followed by the head of its antichain.
  std::uint32_t intern_zone(const void* zone);
  std::uint32_t& head(std::uint32_t discrete) {
    return *reinterpret_cast<std::uint32_t*>(discretes_[discrete] + layout_.words() * sizeof(std::uint64_t));
  }
  std::uint32_t head(std::uint32_t discrete) const {
    return *reinterpret_cast<const std::uint32_t*>(discretes_[discrete] + layout_.words() * sizeof(std::uint64_t));
  }
  Node& entry(std::uint32_t number) { return *reinterpret_cast<Node*>(nodes_[number]); }

  int dimension_;
  ZoneOperations operations_;
  StateLayout layout_;
  std::vector<std::uint64_t> packed_;
  RecordPool discretes_;
  RecordPool zones_;
  RecordPool nodes_;
  HashIndex discrete_index_;
  HashIndex zone_index_;
  std::uint32_t stored_ = 0;
};

}  // namespace tachk
