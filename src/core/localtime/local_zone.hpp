// Zones over local times: sets of values of one time for each agent, and for each clock of the time at which it would
// have been zero. A clock x of an agent with the time t has the value t - x. Such a zone stands for what all orders
// lead to in which independent actions may happen (Bengtsson, Jonsson, Lilius, Yi 1998; Govind, Herbreteau, Srivathsan,
// Walukiewicz 2019, section 3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "zones/bound.hpp"

namespace tachk::localtime {

using LocalEntry = std::int32_t;

// The operations on canonical difference bound matrices of one size. Entry (i, j) bounds x_i - x_j; the times of the
// agents come first.
class LocalZones {
 public:
  static constexpr LocalEntry infinity = zones::BoundLimits<std::int32_t>::infinity;
  // Finite entries of zones that are gone on from lie below this.
  static constexpr LocalEntry legal = 1 << 26;

  // `of_clock`: the agent of each clock, by number from 1.
  LocalZones(std::size_t agents, std::vector<std::uint32_t> of_clock);

  std::size_t size() const { return size_ * size_; }
  std::size_t clocks() const { return of_clock_.size() - 1; }

  // All clocks are zero now, for all agents.
  void make_zero(LocalEntry* zone) const;
  // All these agents have the same time; false, and an unusable zone, if that leaves nothing.
  bool meet(LocalEntry* zone, std::span<const std::uint32_t> agents);
  // A constraint on the value of one clock, seen by its agent; false if that leaves nothing.
  bool constrain(LocalEntry* zone, zones::Atom atom);
  // Sets a clock, at the time of its agent.
  void reset(LocalEntry* zone, zones::ClockReset reset) const;
  // Lets the time of an agent pass.
  void elapse(LocalEntry* zone, std::uint32_t agent) const;
  // The values of the clocks where all agents have the same time, as an ordinary canonical zone: a row for the
  // reference clock and for each clock, without padding. False if there are none.
  bool synchronised(const LocalEntry* zone, LocalEntry* clocks);
  // The zone with its agents and clocks renamed, each by the number of the one that takes its place.
  void rename(LocalEntry* target, const LocalEntry* zone, std::span<const std::uint32_t> agents,
              std::span<const std::uint16_t> clocks) const;
  // True if all finite entries are small enough to go on from.
  bool is_legal(const LocalEntry* zone) const;

 private:
  bool tighten(LocalEntry* zone, std::size_t i, std::size_t j, LocalEntry bound);
  void shorten(LocalEntry* zone, const LocalEntry* from);
  // Sets `weak_` and `strict_`: what is added to a weak and to a strict bound for its sum with each of these.
  void prepare(const LocalEntry* bounds, std::size_t count);
  std::size_t row_of(std::size_t clock) const { return agents_ + clock - 1; }

  std::size_t agents_;
  std::vector<std::uint32_t> of_clock_;
  std::size_t size_;
  std::vector<LocalEntry> to_;  // of the operation under way
  std::vector<LocalEntry> from_;
  std::vector<LocalEntry> weak_;
  std::vector<LocalEntry> strict_;
};

}  // namespace tachk::localtime
