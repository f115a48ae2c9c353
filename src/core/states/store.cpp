#include "states/store.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace tachk::states {

using zones::ClockBounds;
using zones::ZoneOperations;

namespace {

// The scale of extents must do for smaller zones too, whose rows may consist of more and shorter vectors.
ZoneOperations with_shorter_vectors(ZoneOperations operations, bool shorter) {
  if (shorter && operations.lanes > 1) operations.lanes /= 2;
  return operations;
}

}  // namespace

PassedList::PassedList(const program::Program& program, const ZoneOperations& zones, const StoreOptions& options,
                       const std::vector<ZoneOperations>& smaller)
    : dimension_(program.dimension()),
      zones_(zones, dimension_, smaller, {options.rows_after, options.reduced_after}),
      buffer_(zones),
      reclaim_(options.reclaim),
      scale_(with_shorter_vectors(zones, !smaller.empty()), dimension_),
      discretes_(program, options.chunk_words),
      nodes_(sizeof(Node)) {}

std::uint32_t PassedList::coverer(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds) const {
  Measured measured(*this, zone);
  return coverer(discrete, measured, bounds);
}

std::uint32_t PassedList::coverer(std::uint32_t discrete, Measured& zone, const ClockBounds* bounds) const {
  const std::uint32_t first = head(discrete);
  std::uint32_t found = no_node;
  const auto accept = [&](std::uint32_t number) {
    if (!is_above(number, zone, bounds)) return false;
    found = number;
    return true;
  };
  if (is_long(first))
    chain(first).any_above(bounds == nullptr ? zone.extent() : zones::Extent::below_all(), accept, examined_);
  else
    for (std::uint32_t number = first; number != no_node && !accept(number);) number = next(number);
  return found;
}

std::size_t PassedList::count(std::uint32_t discrete) const {
  const std::uint32_t first = head(discrete);
  if (is_long(first)) return chain(first).size();
  std::size_t length = 0;
  for (std::uint32_t member = first; member != no_node; member = next(member)) ++length;
  return length;
}

std::size_t PassedList::merge(std::uint32_t discrete, ZoneView zone, std::uint32_t first, zones::ZoneRef merged,
                              std::vector<std::uint32_t>& parts) {
  const ZoneOperations& operations = zones_.operations(zone.dimension);
  std::memcpy(merged.bytes, zone.data.bytes, operations.bytes);
  std::size_t compared = 0;
  for (std::size_t before = SIZE_MAX;
       before != parts.size();) {  // a larger zone may merge with zones that a smaller did not
    before = parts.size();
    const auto try_to_merge = [&](std::uint32_t number) {
      if (number < first || covered(number)) return;
      ++compared;
      if (operations.convex_union(merged, this->zone(number, buffer_).data, zone.dimension)) parts.push_back(number);
    };
    if (const std::uint32_t newest = head(discrete); is_long(newest))
      chain(newest).for_each_waiting(first, try_to_merge);
    else
      for (std::uint32_t number = newest; number != no_node; number = next(number)) try_to_merge(number);
  }
  return compared;
}

std::uint32_t PassedList::find(std::uint32_t discrete, ZoneView zone) const {
  std::uint32_t found = no_node;
  const auto equal = [&](std::uint32_t number) {
    if (!zones_.equals(zone_of(number), zone)) return false;
    found = number;
    return true;
  };
  const std::uint32_t first = head(discrete);
  if (is_long(first))
    chain(first).any_above(extent_of(zone), equal, examined_);
  else
    for (std::uint32_t number = first; number != no_node && !equal(number);) number = next(number);
  return found;
}

bool PassedList::contains(std::uint32_t discrete, ZoneView zone, bool subsumption) const {
  return subsumption ? covers(discrete, zone) : find(discrete, zone) != no_node;
}

void PassedList::cover(std::uint32_t number, std::uint32_t discrete) {
  Node& node = entry(number);
  node.link = discrete | mark;
  --stored_;
  covered_last_.push_back(number);
  if (reclaim_) {
    const std::uint32_t upper_hash = zones_.upper_hash(node.zone);
    zones_.release(node.zone);
    node.zone = upper_hash;
  }
  node.zone |= mark;
}

void PassedList::thin_out(std::uint32_t discrete, Measured& zone, const ClockBounds* bounds) {
  std::uint32_t& head = this->head(discrete);
  if (!is_long(head)) {
    std::uint32_t before = no_node;
    for (std::uint32_t number = head; number != no_node;) {
      const std::uint32_t link = node(number).link;
      const std::uint32_t behind = next(number);
      if (!is_below(number, zone, bounds) || is_protected(number)) {
        before = number;
      } else {
        if (before == no_node)
          head = behind;
        else
          entry(before).link = link;
        cover(number, discrete);
      }
      number = behind;
    }
    return;
  }
  Antichain& members = chain(head);
  chain_bytes_ -= members.bytes();
  members.remove_below(bounds == nullptr ? zone.extent() : zones::Extent::above_all(), [&](std::uint32_t number) {
    if (!is_below(number, zone, bounds) || is_protected(number)) return false;
    cover(number, discrete);
    return true;
  });
  chain_bytes_ += members.bytes();
}

bool PassedList::holds(std::uint32_t head, Measured& zone, std::uint32_t zone_number) const {
  if (is_long(head))
    return chain(head).any_above(
        zone.extent(), [&](std::uint32_t number) { return zone_of(number) == zone_number; }, examined_);
  for (std::uint32_t number = head; number != no_node; number = next(number))
    if (zone_of(number) == zone_number) return true;
  return false;
}

void PassedList::measure_anew() {
  for (Antichain& members : chains_) {
    chain_bytes_ -= members.bytes();
    members.measure_anew([this](std::uint32_t number) { return extent_of(zone(number, buffer_)); });
    chain_bytes_ += members.bytes();
  }
}

void PassedList::fit_scale(const Antichain& members) {
  std::vector<std::uint32_t> numbers;
  members.for_each([&](std::uint32_t number) { numbers.push_back(number); });
  for (std::size_t n = 0; n < FittedScale::sample; ++n) numbers[n] = numbers[n * numbers.size() / FittedScale::sample];
  numbers.resize(FittedScale::sample);
  const auto extent_of = [&](std::uint32_t number, const zones::ExtentScale& scale) {
    const ZoneView zone = this->zone(number, buffer_);
    return zones_.operations(zone.dimension).extent(zone.data, zone.dimension, scale);
  };
  if (scale_.fit(numbers, extent_of)) measure_anew();
}

void PassedList::add_to(Antichain& members, std::uint32_t number, Measured& zone) {
  const ZoneView view = zone;
  if (scale_.admit(zones_.operations(view.dimension).largest_entry(view.data, view.dimension))) {
    measure_anew();
    zone.forget_extent();
  }
  chain_bytes_ -= members.bytes();
  members.add(zone.extent(), number, first_waiting_,
              [this](std::uint32_t other) { return extent_of(this->zone(other, buffer_)); });
  chain_bytes_ += members.bytes();
  if (scale_.is_due() && members.size() >= FittedScale::sample) fit_scale(members);
}

void PassedList::append(std::uint32_t discrete, std::uint32_t number, Measured& zone) {
  std::uint32_t& head = this->head(discrete);
  if (!is_long(head)) {
    std::size_t length = 0;
    for (std::uint32_t member = head; member != no_node; member = next(member)) ++length;
    if (length < short_chain) {
      if (head != no_node) entry(number).link = head;
      head = number;
      return;
    }
    zones::ZoneBuffer buffer(buffer_);   // which others are read to
    std::vector<std::uint32_t> members;  // the newest comes first
    for (std::uint32_t member = head; member != no_node; member = next(member)) members.push_back(member);
    head = static_cast<std::uint32_t>(chains_.size()) | mark;
    chain_bytes_ += chains_.emplace_back().bytes();
    for (auto member = members.rbegin(); member != members.rend(); ++member) {
      Measured other(*this, this->zone(*member, buffer));
      add_to(chains_.back(), *member, other);
      entry(*member).link = discrete | mark;
    }
  }
  add_to(chain(head), number, zone);
}

std::uint32_t PassedList::add(std::uint32_t discrete, ZoneView zone, std::uint32_t parent, bool subsumption,
                              const ClockBounds* bounds) {
  Measured measured(*this, zone);
  if (subsumption) {
    const bool covered = coverer(discrete, measured, bounds) != no_node;
    return covered ? no_node : add_uncovered(discrete, measured, parent, bounds);
  }
  covered_last_.clear();
  const std::uint32_t zone_number = zones_.intern(zone);
  if (holds(head(discrete), measured, zone_number)) {
    zones_.release(zone_number);
    return no_node;
  }
  return append_node(discrete, zone_number, parent, measured);
}

std::uint32_t PassedList::add_uncovered(std::uint32_t discrete, ZoneView zone, std::uint32_t parent,
                                        const ClockBounds* bounds) {
  Measured measured(*this, zone);
  return add_uncovered(discrete, measured, parent, bounds);
}

std::uint32_t PassedList::add_uncovered(std::uint32_t discrete, Measured& zone, std::uint32_t parent,
                                        const ClockBounds* bounds) {
  covered_last_.clear();
  thin_out(discrete, zone, bounds);
  return append_node(discrete, zones_.intern(zone), parent, zone);
}

std::uint32_t PassedList::append_node(std::uint32_t discrete, std::uint32_t zone_number, std::uint32_t parent,
                                      Measured& zone) {
  const std::uint32_t fresh = nodes_.append();
  if (((fresh | discrete | zone_number) & mark) != 0) throw std::length_error("more states than node numbers");
  entry(fresh) = {discrete | mark, zone_number};
  parents_.append(parent);
  append(discrete, fresh, zone);
  ++stored_;
  return fresh;
}

bool PassedList::may_equal(std::uint32_t number, ZoneView zone) const {
  if (reclaim_ && covered(number)) return (zones_.upper_hash(zone) | mark) == node(number).zone;
  return zones_.equals(zone_of(number), zone);
}

std::size_t PassedList::bytes() const {
  return discretes_.bytes() + zones_.bytes() + nodes_.bytes() + parents_.bytes() + chain_bytes_ +
         chains_.capacity() * sizeof(Antichain);
}

}  // namespace tachk::states
