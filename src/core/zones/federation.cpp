#include "zones/federation.hpp"

#include <utility>

#include "zones/patience.hpp"

namespace tachk::zones {

void tighter_constraints(const ZoneOperations& operations, int dimension, ConstZoneRef zone, ConstZoneRef other,
                         std::vector<Atom>& atoms) {
  atoms.resize(static_cast<std::size_t>(dimension) * static_cast<std::size_t>(dimension));
  atoms.resize(operations.tighter(zone, other, dimension, atoms.data()));
}

void Federation::add(ConstZoneRef zone) {
  if (count_ == zones_.size()) zones_.emplace_back(operations_);
  zones_[count_++].assign(zone);
}

void Federation::subtract(const std::vector<Atom>& atoms) {
  // From the back, so that a zone that takes the place of one used up has been dealt with.
  constexpr std::size_t many = 32;
  for (std::size_t number = count_; number-- > 0;) {
    if (number % many == many - 1) Patience::check();
    if (!operations_.meets_each(zones_[number].get(), dimension_, atoms.data(), atoms.size())) continue;
    for (const Atom& atom : atoms) {
      if (operations_.entry(zones_[number].get(), dimension_, atom.left, atom.right) <= atom.raw) continue;
      const Atom outside = negated(atom);
      add(zones_[number].get());
      if (!operations_.intersect(zones_[count_ - 1].get(), dimension_, &outside, 1)) --count_;
      if (!operations_.intersect(zones_[number].get(), dimension_, &atom, 1)) break;
    }
    std::swap(zones_[number], zones_[--count_]);
  }
}

}  // namespace tachk::zones
