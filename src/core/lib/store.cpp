#include "tachk/store.hpp"

#include <bit>
#include <stdexcept>

namespace tachk {
namespace {

std::uint64_t hash_words(const std::uint64_t* words, std::size_t count) {
  std::uint64_t hash = 0x9E3779B97F4A7C15u;
  for (std::size_t n = 0; n < count; ++n) {
    hash = (hash ^ words[n]) * 0xD6E8FEB86659FD93u;
    hash ^= hash >> 32;
  }
  hash *= 0xD6E8FEB86659FD93u;
  return hash ^ (hash >> 29);
}

}  // namespace

StateLayout::StateLayout(const Program& program) {
  std::uint32_t used = 0;  // bits of the current word
  std::uint32_t word = 0;
  for (std::uint32_t s = 0; s < program.state_slots; ++s) {
    const Slot& slot = program.slots[s];
    initial_.push_back(slot.initial);
    const auto span = static_cast<std::uint64_t>(static_cast<std::int64_t>(slot.high) - slot.low);
    if (slot.meta || span == 0) continue;
    const auto bits = static_cast<std::uint32_t>(std::bit_width(span));
    if (used + bits > 64) {
      ++word;
      used = 0;
    }
    fields_.push_back({s, word, used, (std::uint64_t{1} << bits) - 1, slot.low});
    used += bits;
  }
  words_ = word + 1;
}

void StateLayout::pack(const std::int32_t* slots, std::uint64_t* words) const {
  for (std::size_t n = 0; n < words_; ++n) words[n] = 0;
  for (const Field& f : fields_)
    words[f.word] |= static_cast<std::uint64_t>(static_cast<std::int64_t>(slots[f.slot]) - f.low) << f.shift;
}

void StateLayout::unpack(const std::uint64_t* words, std::int32_t* slots) const {
  std::memcpy(slots, initial_.data(), initial_.size() * sizeof(std::int32_t));
  for (const Field& f : fields_)
    slots[f.slot] = static_cast<std::int32_t>(static_cast<std::int64_t>((words[f.word] >> f.shift) & f.mask) + f.low);
}

PassedList::PassedList(const Program& program, const ZoneOperations& zones)
    : dimension_(program.dimension()),
      operations_(zones),
      layout_(program),
      packed_(layout_.words()),
      discretes_((layout_.words() + 1) * sizeof(std::uint64_t)),
      zones_(zones.bytes),
      nodes_(sizeof(Node)) {}

std::uint32_t PassedList::locate(const std::int32_t* slots) {
  const std::size_t count = layout_.words();
  layout_.pack(slots, packed_.data());
  const auto words = [&](std::uint32_t number) { return reinterpret_cast<const std::uint64_t*>(discretes_[number]); };
  const std::uint64_t hash = hash_words(packed_.data(), count);
  const std::size_t bytes = count * sizeof(std::uint64_t);
  const std::uint32_t found = discrete_index_.find(
      hash, [&](std::uint32_t number) { return std::memcmp(words(number), packed_.data(), bytes) == 0; });
  if (found != HashIndex::absent) return found;
  const std::uint32_t fresh = discretes_.append();
  std::memcpy(discretes_[fresh], packed_.data(), bytes);
  head(fresh) = no_node;
  discrete_index_.insert(hash, fresh, [&](std::uint32_t number) { return hash_words(words(number), count); });
  return fresh;
}

std::uint32_t PassedList::intern_zone(const void* zone) {
  const std::uint64_t hash = operations_.hash(zone, dimension_);
  const std::uint32_t found = zone_index_.find(
      hash, [&](std::uint32_t number) { return std::memcmp(zones_[number], zone, operations_.bytes) == 0; });
  if (found != HashIndex::absent) return found;
  const std::uint32_t fresh = zones_.append();
  std::memcpy(zones_[fresh], zone, operations_.bytes);
  zone_index_.insert(hash, fresh, [&](std::uint32_t number) { return operations_.hash(zones_[number], dimension_); });
  return fresh;
}

bool PassedList::covers(std::uint32_t discrete, const void* zone) const {
  for (std::uint32_t number = head(discrete); number != no_node; number = node(number).next)
    if (operations_.includes(zones_[node(number).zone], zone, dimension_)) return true;
  return false;
}

std::uint32_t PassedList::add(std::uint32_t discrete, const void* zone, std::uint32_t parent, bool subsumption) {
  std::uint32_t* link = &head(discrete);
  if (subsumption) {
    if (covers(discrete, zone)) return no_node;
    while (*link != no_node) {
      Node& old = entry(*link);
      if (operations_.includes(zone, zones_[old.zone], dimension_)) {
        *link = old.next;
        old.next = covered_mark;
        --stored_;
      } else {
        link = &old.next;
      }
    }
  }
  const std::uint32_t zone_number = intern_zone(zone);
  if (!subsumption)
    for (std::uint32_t number = *link; number != no_node; number = node(number).next)
      if (node(number).zone == zone_number) return no_node;
  const std::uint32_t fresh = nodes_.append();
  if (fresh >= covered_mark) throw std::length_error("more states than node numbers");
  entry(fresh) = {discrete, zone_number, parent, head(discrete)};
  head(discrete) = fresh;
  ++stored_;
  return fresh;
}

bool PassedList::equals(const Node& node, const std::int32_t* slots, const void* zone) {
  layout_.pack(slots, packed_.data());
  return std::memcmp(discretes_[node.discrete], packed_.data(), packed_.size() * sizeof(std::uint64_t)) == 0 &&
         std::memcmp(zones_[node.zone], zone, operations_.bytes) == 0;
}

std::size_t PassedList::bytes() const {
  return discretes_.bytes() + zones_.bytes() + nodes_.bytes() + discrete_index_.bytes() + zone_index_.bytes();
}

}  // namespace tachk
