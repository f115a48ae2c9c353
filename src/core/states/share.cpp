#include "states/share.hpp"

#include <utility>

namespace tachk {

Share::Share(ZoneStore zones, const ZoneOperations& scaled, int dimension, bool reclaim, Nodes& nodes,
             DiscreteStates& discretes)
    : dimension_(dimension),
      zones_(std::move(zones)),
      buffer_(zones_.operations(dimension)),
      scaled_(scaled),
      reclaim_(reclaim),
      scale_(choose_scale(scaled_, dimension_, 0)),
      nodes_(nodes),
      discretes_(discretes) {}

std::uint32_t Share::coverer(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds) const {
  const std::uint32_t first = head(discrete);
  std::uint32_t found = no_node;
  const auto accept = [&](std::uint32_t number) {
    if (!is_above(number, zone, bounds)) return false;
    found = number;
    return true;
  };
  if (is_long(first))
    chain(first).any_above(bounds == nullptr ? extent_of(zone) : Extent::below_all(), accept);
  else
    for (std::uint32_t number = first; number != no_node && !accept(number);) number = nodes_.next(number);
  return found;
}

std::size_t Share::count(std::uint32_t discrete) const {
  const std::uint32_t first = head(discrete);
  if (is_long(first)) return chain(first).size();
  std::size_t length = 0;
  for (std::uint32_t member = first; member != no_node; member = nodes_.next(member)) ++length;
  return length;
}

std::uint32_t Share::find(std::uint32_t discrete, ZoneView zone) const {
  std::uint32_t found = no_node;
  const auto equal = [&](std::uint32_t number) {
    if (!zones_.equals(nodes_.zone(number), zone)) return false;
    found = number;
    return true;
  };
  const std::uint32_t first = head(discrete);
  if (is_long(first))
    chain(first).any_above(extent_of(zone), equal);
  else
    for (std::uint32_t number = first; number != no_node && !equal(number);) number = nodes_.next(number);
  return found;
}

bool Share::unite(ZoneRef united, int dimension, std::uint32_t zone) {
  return zones_.operations(dimension).unite(united, zones_.read(zone, buffer_.get()).data, dimension);
}

std::uint32_t Share::give_up(std::uint32_t zone) {
  if (!reclaim_) return zone | mark;
  const std::uint32_t upper_hash = zones_.upper_hash(zone);
  zones_.release(zone);
  return upper_hash | mark;
}

void Share::cover(std::uint32_t number, std::uint32_t discrete) {
  Node& node = nodes_[number];
  node.link = discrete | mark;
  node.zone = give_up(node.zone);
  covered_.push_back(number);
}

void Share::thin_out(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds) {
  std::uint32_t& head = this->head(discrete);
  if (!is_long(head)) {
    std::uint32_t before = no_node;
    for (std::uint32_t number = head; number != no_node;) {
      const std::uint32_t link = nodes_[number].link;
      const std::uint32_t behind = nodes_.next(number);
      if (!is_below(number, zone, bounds) || nodes_.is_protected(number)) {
        before = number;
      } else {
        if (before == no_node)
          head = behind;
        else
          nodes_[before].link = link;
        cover(number, discrete);
      }
      number = behind;
    }
    return;
  }
  Antichain& members = chain(head);
  chain_bytes_ -= members.bytes();
  members.remove_below(bounds == nullptr ? extent_of(zone) : Extent::above_all(), [&](std::uint32_t number) {
    if (!is_below(number, zone, bounds) || nodes_.is_protected(number)) return false;
    cover(number, discrete);
    return true;
  });
  chain_bytes_ += members.bytes();
}

bool Share::holds(std::uint32_t discrete, ZoneView zone, std::uint32_t zone_number) const {
  const std::uint32_t first = head(discrete);
  if (is_long(first))
    return chain(first).any_above(extent_of(zone),
                                  [&](std::uint32_t number) { return nodes_.zone(number) == zone_number; });
  for (std::uint32_t number = first; number != no_node; number = nodes_.next(number))
    if (nodes_.zone(number) == zone_number) return true;
  return false;
}

void Share::rescale(Raw largest_entry) {
  scale_ = choose_scale(scaled_, dimension_, largest_entry + largest_entry / 2);
  for (Antichain& members : chains_) {
    chain_bytes_ -= members.bytes();
    members.measure_anew([&](std::uint32_t number) { return extent_of(zone(number)); });
    chain_bytes_ += members.bytes();
  }
}

void Share::add_to(Antichain& members, std::uint32_t number) {
  ZoneView zone = this->zone(number);
  const Raw largest_entry = zones_.operations(zone.dimension).largest_entry(zone.data, zone.dimension);
  if (largest_entry > scale_.limit) {
    rescale(largest_entry);
    zone = this->zone(number);  // where others have been meanwhile
  }
  chain_bytes_ -= members.bytes();
  members.add(extent_of(zone), number, first_waiting_);
  chain_bytes_ += members.bytes();
}

void Share::append(std::uint32_t discrete, std::uint32_t number) {
  std::uint32_t& head = this->head(discrete);
  if (!is_long(head)) {
    std::size_t length = 0;
    for (std::uint32_t member = head; member != no_node; member = nodes_.next(member)) ++length;
    if (length < short_chain) {
      if (head != no_node) nodes_[number].link = head;
      head = number;
      return;
    }
    std::vector<std::uint32_t> members;  // the newest comes first
    for (std::uint32_t member = head; member != no_node; member = nodes_.next(member)) members.push_back(member);
    head = static_cast<std::uint32_t>(chains_.size()) | mark;
    chain_bytes_ += chains_.emplace_back().bytes();
    for (auto member = members.rbegin(); member != members.rend(); ++member) {
      add_to(chains_.back(), *member);
      nodes_[*member].link = discrete | mark;
    }
  }
  add_to(chain(head), number);
}

}  // namespace tachk
