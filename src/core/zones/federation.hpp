// Unions of zones that are built up and cut down again and again: the memory of a zone is kept for the next one.
#pragma once

#include <cstddef>
#include <vector>

#include "zones/zone.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::zones {

// The constraints of a zone that are tighter than those of another one, upper bounds of clocks first: with them many of
// the differences follow, and subtracting those leaves nothing. They take the place of what is in `atoms`.
void tighter_constraints(const ZoneOperations& operations, int dimension, ConstZoneRef zone, ConstZoneRef other,
                         std::vector<Atom>& atoms);

class Federation {
 public:
  Federation(const ZoneOperations& operations, int dimension) : operations_(operations), dimension_(dimension) {}

  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  ConstZoneRef operator[](std::size_t number) const { return zones_[number].get(); }

  void add(ConstZoneRef zone);
  void remove_last() { --count_; }
  // Keeps what lies outside the conjunction of the atoms, as disjoint zones if those before were.
  void subtract(const std::vector<Atom>& atoms);

 private:
  ZoneOperations operations_;
  int dimension_;
  std::vector<ZoneBuffer> zones_;  // the first count_ are in use
  std::size_t count_ = 0;
};

}  // namespace tachk::zones
