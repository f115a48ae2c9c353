#include "tachk/store.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace tachk {
PassedList::PassedList(const Program& program, const ZoneOperations& zones, std::size_t chunk_words)
    : dimension_(program.dimension()),
      operations_(zones),
      scale_(choose_scale(zones, dimension_, program.largest_constant)),
      discretes_(program, chunk_words),
      zones_(zones.bytes),
      nodes_(sizeof(Node)) {}

std::uint32_t PassedList::intern_zone(const void* zone) {
  const std::uint64_t hash = operations_.hash(zone, dimension_);
  const std::uint32_t found = zone_index_.find(
      hash, [&](std::uint32_t number) { return std::memcmp(zones_[number], zone, operations_.bytes) == 0; });
  if (found != HashIndex::absent) return found;
  const std::uint32_t fresh = zones_.append();
  std::memcpy(zones_[fresh], zone, operations_.bytes);
  zone_index_.insert(hash, fresh);
  return fresh;
}

bool PassedList::covers(std::uint32_t discrete, const void* zone) const {
  const std::uint32_t first = head(discrete);
  if (!is_long(first)) {
    for (std::uint32_t number = first; number != no_node; number = node(number).next)
      if (operations_.includes(zones_[node(number).zone], zone, dimension_)) return true;
    return false;
  }
  const Chain& members = chain(first);
  const Extent extent = extent_of(zone);
  const Extent* extents = members.extents.data();
  const std::size_t count = members.extents.size();
  for (std::size_t n = 0; n < count; ++n)
    if (extents[n].may_include(extent) && operations_.includes(zones_[node(members.nodes[n]).zone], zone, dimension_))
      return true;
  return false;
}

void PassedList::cover(std::uint32_t number) {
  entry(number).next = covered_mark;
  --stored_;
}

void PassedList::thin_out(std::uint32_t& head, const void* zone) {
  if (!is_long(head)) {
    for (std::uint32_t* link = &head; *link != no_node;) {
      const std::uint32_t number = *link;
      Node& old = entry(number);
      if (operations_.includes(zone, zones_[old.zone], dimension_)) {
        *link = old.next;
        cover(number);
      } else {
        link = &old.next;
      }
    }
    return;
  }
  Chain& members = chain(head);
  const Extent extent = extent_of(zone);
  for (std::size_t n = members.extents.size(); n-- > 0;) {
    if (!extent.may_include(members.extents[n]) ||
        !operations_.includes(zone, zones_[node(members.nodes[n]).zone], dimension_))
      continue;
    cover(members.nodes[n]);
    members.extents[n] = members.extents.back();
    members.nodes[n] = members.nodes.back();
    members.extents.pop_back();
    members.nodes.pop_back();
  }
}

bool PassedList::holds(std::uint32_t head, std::uint32_t zone_number) const {
  if (is_long(head)) {
    const std::vector<std::uint32_t>& nodes = chain(head).nodes;
    return std::any_of(nodes.begin(), nodes.end(),
                       [&](std::uint32_t number) { return node(number).zone == zone_number; });
  }
  for (std::uint32_t number = head; number != no_node; number = node(number).next)
    if (node(number).zone == zone_number) return true;
  return false;
}

void PassedList::append(std::uint32_t& head, std::uint32_t number) {
  const auto add_to = [&](Chain& members, std::uint32_t member) {
    const std::size_t before = members.bytes();
    members.extents.push_back(extent_of(zones_[node(member).zone]));
    members.nodes.push_back(member);
    chain_bytes_ += members.bytes() - before;
  };
  if (!is_long(head)) {
    std::size_t length = 0;
    for (std::uint32_t member = head; member != no_node; member = node(member).next) ++length;
    if (length < short_chain) {
      entry(number).next = std::exchange(head, number);
      return;
    }
    Chain members;
    for (std::uint32_t member = head; member != no_node;) {
      add_to(members, member);
      member = std::exchange(entry(member).next, no_node);
    }
    head = static_cast<std::uint32_t>(chains_.size()) | chain_mark;
    chains_.push_back(std::move(members));
  }
  add_to(chain(head), number);
}

std::uint32_t PassedList::add(std::uint32_t discrete, const void* zone, std::uint32_t parent, bool subsumption) {
  if (subsumption) {
    if (covers(discrete, zone)) return no_node;
    thin_out(head(discrete), zone);
  }
  const std::uint32_t zone_number = intern_zone(zone);
  if (!subsumption && holds(head(discrete), zone_number)) return no_node;
  const std::uint32_t fresh = nodes_.append();
  if (fresh >= chain_mark) throw std::length_error("more states than node numbers");
  entry(fresh) = {discrete, zone_number, parent, no_node};
  append(head(discrete), fresh);
  ++stored_;
  return fresh;
}

bool PassedList::equals(const Node& node, const std::int32_t* slots, const void* zone) {
  return discretes_.equals(node.discrete, slots) && std::memcmp(zones_[node.zone], zone, operations_.bytes) == 0;
}

std::size_t PassedList::bytes() const {
  return discretes_.bytes() + zones_.bytes() + nodes_.bytes() + zone_index_.bytes() + chain_bytes_ +
         chains_.capacity() * sizeof(Chain);
}

}  // namespace tachk
