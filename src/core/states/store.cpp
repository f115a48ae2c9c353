#include "states/store.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace tachk {
namespace {

// The scale of extents must do for smaller zones too, whose rows may consist of more and shorter vectors.
ZoneOperations with_shorter_vectors(ZoneOperations operations, bool shorter) {
  if (shorter && operations.lanes > 1) operations.lanes /= 2;
  return operations;
}

}  // namespace

PassedList::PassedList(const Program& program, const ZoneOperations& zones, std::size_t chunk_words, bool reclaim,
                       std::vector<ZoneOperations> smaller)
    : dimension_(program.dimension()),
      zones_(zones, dimension_, smaller),
      scaled_(with_shorter_vectors(zones, !smaller.empty())),
      reclaim_(reclaim),
      scale_(choose_scale(scaled_, dimension_, 0)),
      discretes_(program, chunk_words),
      nodes_(sizeof(Node)) {}

std::uint32_t PassedList::coverer(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds) const {
  const std::uint32_t first = head(discrete);
  std::uint32_t found = no_node;
  const auto is_above = [&](std::uint32_t number) {
    if (!covers(zones_[node(number).zone], zone.data, zone.dimension, bounds)) return false;
    found = number;
    return true;
  };
  if (is_long(first))
    chain(first).any_above(bounds == nullptr ? extent_of(zone) : Extent::below_all(), is_above);
  else
    for (std::uint32_t number = first; number != no_node && !is_above(number);) number = node(number).next;
  return found;
}

std::size_t PassedList::count(std::uint32_t discrete) const {
  const std::uint32_t first = head(discrete);
  if (is_long(first)) return chain(first).size();
  std::size_t length = 0;
  for (std::uint32_t member = first; member != no_node; member = node(member).next) ++length;
  return length;
}

std::size_t PassedList::unite(std::uint32_t discrete, ZoneView zone, std::uint32_t first, ZoneRef united,
                              std::vector<std::uint32_t>& parts) const {
  const ZoneOperations& operations = zones_.operations(zone.dimension);
  std::memcpy(united.bytes, zone.data.bytes, operations.bytes);
  std::size_t looked = 0;
  for (std::size_t before = SIZE_MAX; before != parts.size();) {  // a larger zone may unite with what a smaller did not
    before = parts.size();
    for_each_member(head(discrete), [&](std::uint32_t number) {
      if (number < first) return;
      ++looked;
      if (operations.unite(united, zones_[node(number).zone], zone.dimension)) parts.push_back(number);
    });
  }
  return looked;
}

std::uint32_t PassedList::find(std::uint32_t discrete, ZoneView zone) const {
  std::uint32_t found = no_node;
  const auto equal = [&](std::uint32_t number) {
    if (!zones_.equals(node(number).zone, zone)) return false;
    found = number;
    return true;
  };
  const std::uint32_t first = head(discrete);
  if (is_long(first))
    chain(first).any_above(extent_of(zone), equal);
  else
    for (std::uint32_t number = first; number != no_node && !equal(number);) number = node(number).next;
  return found;
}

bool PassedList::contains(std::uint32_t discrete, ZoneView zone, bool subsumption) const {
  return subsumption ? covers(discrete, zone) : find(discrete, zone) != no_node;
}

void PassedList::cover(std::uint32_t number) {
  Node& node = entry(number);
  node.next = covered_mark;
  --stored_;
  covered_last_.push_back(number);
  if (!reclaim_) return;
  const std::uint32_t upper_hash = zones_.upper_hash(node.zone);
  zones_.release(node.zone);
  node.zone = upper_hash;
}

void PassedList::thin_out(std::uint32_t& head, ZoneView zone, const ClockBounds* bounds) {
  if (!is_long(head)) {
    for (std::uint32_t* link = &head; *link != no_node;) {
      const std::uint32_t number = *link;
      Node& old = entry(number);
      if (covers(zone.data, zones_[old.zone], zone.dimension, bounds) && !is_protected(number)) {
        *link = old.next;
        cover(number);
      } else {
        link = &old.next;
      }
    }
    return;
  }
  Antichain& members = chain(head);
  chain_bytes_ -= members.bytes();
  members.remove_below(bounds == nullptr ? extent_of(zone) : Extent::above_all(), [&](std::uint32_t number) {
    if (!covers(zone.data, zones_[node(number).zone], zone.dimension, bounds) || is_protected(number)) return false;
    cover(number);
    return true;
  });
  chain_bytes_ += members.bytes();
}

bool PassedList::holds(std::uint32_t head, std::uint32_t zone_number) const {
  if (is_long(head))
    return chain(head).any_above(extent_of(zones_.view(zone_number)),
                                 [&](std::uint32_t number) { return node(number).zone == zone_number; });
  for (std::uint32_t number = head; number != no_node; number = node(number).next)
    if (node(number).zone == zone_number) return true;
  return false;
}

void PassedList::rescale(Raw largest_entry) {
  scale_ = choose_scale(scaled_, dimension_, largest_entry + largest_entry / 2);
  for (Antichain& members : chains_) {
    chain_bytes_ -= members.bytes();
    Antichain fresh;
    members.for_each([&](std::uint32_t number) { fresh.add(extent_of(zones_.view(node(number).zone)), number); });
    members = std::move(fresh);
    chain_bytes_ += members.bytes();
  }
}

void PassedList::add_to(Antichain& members, std::uint32_t number) {
  const ZoneView zone = zones_.view(node(number).zone);
  const Raw largest_entry = zones_.operations(zone.dimension).largest_entry(zone.data, zone.dimension);
  if (largest_entry > scale_.limit) rescale(largest_entry);
  chain_bytes_ -= members.bytes();
  members.add(extent_of(zone), number);
  chain_bytes_ += members.bytes();
}

void PassedList::append(std::uint32_t& head, std::uint32_t number) {
  if (!is_long(head)) {
    std::size_t length = 0;
    for (std::uint32_t member = head; member != no_node; member = node(member).next) ++length;
    if (length < short_chain) {
      entry(number).next = std::exchange(head, number);
      return;
    }
    const std::uint32_t first = std::exchange(head, static_cast<std::uint32_t>(chains_.size()) | chain_mark);
    chain_bytes_ += chains_.emplace_back().bytes();
    for (std::uint32_t member = first; member != no_node;) {
      add_to(chains_.back(), member);
      member = std::exchange(entry(member).next, no_node);
    }
  }
  add_to(chain(head), number);
}

std::uint32_t PassedList::add(std::uint32_t discrete, ZoneView zone, std::uint32_t parent, bool subsumption,
                              const ClockBounds* bounds) {
  covered_last_.clear();
  if (subsumption) {
    if (covers(discrete, zone, bounds)) return no_node;
    thin_out(head(discrete), zone, bounds);
  }
  const std::uint32_t zone_number = zones_.intern(zone);
  if (!subsumption && holds(head(discrete), zone_number)) {
    zones_.release(zone_number);
    return no_node;
  }
  return append_node(discrete, zone_number, parent);
}

std::uint32_t PassedList::add_apart(std::uint32_t discrete, ZoneView zone, std::uint64_t hash, std::uint32_t parent) {
  covered_last_.clear();
  return append_node(discrete, zones_.intern(zone, hash), parent);
}

std::uint32_t PassedList::append_node(std::uint32_t discrete, std::uint32_t zone_number, std::uint32_t parent) {
  const std::uint32_t fresh = nodes_.append();
  if (fresh >= chain_mark) throw std::length_error("more states than node numbers");
  entry(fresh) = {discrete, zone_number, parent, no_node};
  append(head(discrete), fresh);
  ++stored_;
  return fresh;
}

bool PassedList::would_cover(std::uint32_t discrete, ZoneView zone) const {
  const auto is_below = [&](std::uint32_t number) {
    return covers(zone.data, zones_[node(number).zone], zone.dimension, nullptr);
  };
  const std::uint32_t first = head(discrete);
  if (is_long(first)) return chain(first).any_below(extent_of(zone), is_below);
  std::uint32_t number = first;
  while (number != no_node && !is_below(number)) number = node(number).next;
  return number != no_node;
}

// In a short antichain the newest comes first; what has covered it is newer.
bool PassedList::has_since(std::uint32_t discrete, std::uint32_t first) const {
  const std::uint32_t newest = head(discrete);
  if (newest == no_node) return false;
  return (is_long(newest) ? chain(newest).newest() : newest) >= first;
}

bool PassedList::may_equal(const Node& node, ZoneView zone) const {
  return reclaim_ && node.next == covered_mark ? zones_.upper_hash(zone) == node.zone : zones_.equals(node.zone, zone);
}

std::size_t PassedList::bytes() const {
  return discretes_.bytes() + zones_.bytes() + nodes_.bytes() + chain_bytes_ + chains_.capacity() * sizeof(Antichain);
}

}  // namespace tachk
