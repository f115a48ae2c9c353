// States that are added to one share together: they are compared with each other and with what is stored, one after
// the other, and become nodes once it is known how many have been added to the other shares in front of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "states/share.hpp"

namespace tachk {

class Arrivals final {
 public:
  struct Arrival {
    std::uint64_t order;  // which rises, and tells it from the arrivals of other shares
    std::uint32_t discrete;
    std::uint32_t zone;    // its number, or what is kept of it
    std::uint32_t before;  // among those that share a place
    bool covered;
  };

  explicit Arrivals(Share& share) : share_(share), latest_(places, none) {}

  // Whether one of them with this discrete state contains the zone; with `bounds` (may be null), simulates it.
  bool covers(std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds = nullptr) const;
  // How many states with this discrete state there are, with those that were stored before.
  std::size_t count(std::uint32_t discrete) const;
  // As PassedList::unite, also with arrivals, whose places in the list are added to `own`.
  std::size_t unite(std::uint32_t discrete, ZoneView zone, std::uint32_t first, ZoneRef united,
                    std::vector<std::uint32_t>& parts, std::vector<std::uint32_t>& own);
  // Adds a state that no other one covers, and removes those that it covers.
  void add(std::uint64_t order, std::uint32_t discrete, ZoneView zone, bool subsumption, const ClockBounds* bounds);

  std::span<const Arrival> all() const { return arrivals_; }
  // All of them become nodes with these numbers, which are there, but empty; none is left.
  void settle(Nodes& nodes, std::span<const std::uint32_t> numbers);
  // How many of them, less those that they cover, were added since `settle`; may be negative.
  std::int64_t added() const { return added_; }

 private:
  static constexpr std::uint32_t none = UINT32_MAX;
  static constexpr std::size_t places = std::size_t{1} << 12;

  static std::size_t place(std::uint32_t discrete) { return discrete * 0x9E3779B1u >> 20; }
  // Calls visit(place in the list, arrival) for those with this discrete state that are not covered, the newest first,
  // until it says that this is enough.
  template <class Visit>
  bool any(std::uint32_t discrete, Visit visit) const {
    for (std::uint32_t n = latest_[place(discrete)]; n != none; n = arrivals_[n].before)
      if (arrivals_[n].discrete == discrete && !arrivals_[n].covered && visit(n)) return true;
    return false;
  }

  Share& share_;
  std::vector<Arrival> arrivals_;
  std::vector<std::uint32_t> latest_;  // of those with discrete states that share a place
  std::int64_t added_ = 0;
};

}  // namespace tachk
