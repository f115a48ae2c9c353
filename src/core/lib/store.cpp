#include "tachk/store.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace tachk {
PassedList::PassedList(const Program& program, const ZoneOperations& zones, std::size_t chunk_words, bool reclaim)
    : dimension_(program.dimension()),
      operations_(zones),
      reclaim_(reclaim),
      scale_(choose_scale(zones, dimension_, 0)),
      discretes_(program, chunk_words),
      zones_(zones.bytes),
      nodes_(sizeof(Node)) {}

std::uint32_t PassedList::intern_zone(const void* zone) {
  const std::uint64_t hash = operations_.hash(zone, dimension_);
  const std::uint32_t found = zone_index_.find(
      hash, [&](std::uint32_t number) { return std::memcmp(zones_[number], zone, operations_.bytes) == 0; });
  if (found != HashIndex::absent) {
    ++zone_uses_[found].nodes;
    return found;
  }
  std::uint32_t fresh;
  if (free_zones_.empty()) {
    fresh = zones_.append();
    zone_uses_.emplace_back();
  } else {
    fresh = free_zones_.back();
    free_zones_.pop_back();
  }
  zone_uses_[fresh] = {1, static_cast<std::uint32_t>(hash >> 32)};
  std::memcpy(zones_[fresh], zone, operations_.bytes);
  zone_index_.insert(hash, fresh);
  return fresh;
}

void PassedList::release_zone(std::uint32_t number) {
  if (--zone_uses_[number].nodes != 0) return;
  zone_index_.erase(zone_uses_[number].upper_hash, number);
  free_zones_.push_back(number);
}

bool PassedList::covers(std::uint32_t discrete, const void* zone) const {
  const std::uint32_t first = head(discrete);
  if (!is_long(first)) {
    for (std::uint32_t number = first; number != no_node; number = node(number).next)
      if (operations_.includes(zones_[node(number).zone], zone, dimension_)) return true;
    return false;
  }
  return chain(first).any_above(extent_of(zone), [&](std::uint32_t number) {
    return operations_.includes(zones_[node(number).zone], zone, dimension_);
  });
}

void PassedList::cover(std::uint32_t number) {
  Node& node = entry(number);
  node.next = covered_mark;
  --stored_;
  if (!reclaim_) return;
  const std::uint32_t upper_hash = zone_uses_[node.zone].upper_hash;
  release_zone(node.zone);
  node.zone = upper_hash;
}

void PassedList::thin_out(std::uint32_t& head, const void* zone) {
  if (!is_long(head)) {
    for (std::uint32_t* link = &head; *link != no_node;) {
      const std::uint32_t number = *link;
      Node& old = entry(number);
      if (operations_.includes(zone, zones_[old.zone], dimension_) && !is_protected(number)) {
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
  members.remove_below(extent_of(zone), [&](std::uint32_t number) {
    if (!operations_.includes(zone, zones_[node(number).zone], dimension_) || is_protected(number)) return false;
    cover(number);
    return true;
  });
  chain_bytes_ += members.bytes();
}

bool PassedList::holds(std::uint32_t head, std::uint32_t zone_number) const {
  if (is_long(head))
    return chain(head).any_above(extent_of(zones_[zone_number]),
                                 [&](std::uint32_t number) { return node(number).zone == zone_number; });
  for (std::uint32_t number = head; number != no_node; number = node(number).next)
    if (node(number).zone == zone_number) return true;
  return false;
}

void PassedList::rescale(Raw largest_entry) {
  scale_ = choose_scale(operations_, dimension_, largest_entry + largest_entry / 2);
  for (Antichain& members : chains_) {
    chain_bytes_ -= members.bytes();
    Antichain fresh;
    members.for_each([&](std::uint32_t number) { fresh.add(extent_of(zones_[node(number).zone]), number); });
    members = std::move(fresh);
    chain_bytes_ += members.bytes();
  }
}

void PassedList::add_to(Antichain& members, std::uint32_t number) {
  const void* zone = zones_[node(number).zone];
  const Raw largest_entry = operations_.largest_entry(zone, dimension_);
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

std::uint32_t PassedList::add(std::uint32_t discrete, const void* zone, std::uint32_t parent, bool subsumption) {
  if (subsumption) {
    if (covers(discrete, zone)) return no_node;
    thin_out(head(discrete), zone);
  }
  const std::uint32_t zone_number = intern_zone(zone);
  if (!subsumption && holds(head(discrete), zone_number)) {
    release_zone(zone_number);
    return no_node;
  }
  const std::uint32_t fresh = nodes_.append();
  if (fresh >= chain_mark) throw std::length_error("more states than node numbers");
  entry(fresh) = {discrete, zone_number, parent, no_node};
  append(head(discrete), fresh);
  ++stored_;
  return fresh;
}

bool PassedList::may_equal(const Node& node, const void* zone) const {
  if (reclaim_ && node.next == covered_mark)
    return static_cast<std::uint32_t>(operations_.hash(zone, dimension_) >> 32) == node.zone;
  return std::memcmp(zones_[node.zone], zone, operations_.bytes) == 0;
}

std::size_t PassedList::bytes() const {
  return discretes_.bytes() + zones_.bytes() + zone_uses_.capacity() * sizeof(ZoneUse) +
         free_zones_.capacity() * sizeof(std::uint32_t) + nodes_.bytes() + zone_index_.bytes() + chain_bytes_ +
         chains_.capacity() * sizeof(Antichain);
}

}  // namespace tachk
