// Sets of clock values, for the checker alone: convex ones as difference bound matrices, others as lists of these.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "zones/bound.hpp"

namespace tachk::certificates {

inline constexpr zones::Raw unbounded = zones::Raw{1} << 60;

inline zones::Raw sum(zones::Raw a, zones::Raw b) {
  return a >= unbounded || b >= unbounded ? unbounded : a + b - ((a | b) & 1);
}

using Constraints = std::vector<zones::Atom>;

// A canonical difference bound matrix over `n` clocks, or no valuation at all (no entries).
struct Zone {
  std::size_t n = 0;
  std::vector<zones::Raw> entries;

  static Zone filled(std::size_t n, zones::Raw raw) { return {n, std::vector<zones::Raw>(n * n, raw)}; }
  static Zone universe(std::size_t n) {
    Zone zone = filled(n, unbounded);
    for (std::size_t i = 0; i < n; ++i) zone.at(0, i) = zone.at(i, i) = zones::raw_zero;
    return zone;
  }
  bool empty() const { return entries.empty(); }
  zones::Raw& at(std::size_t i, std::size_t j) { return entries[i * n + j]; }
  zones::Raw at(std::size_t i, std::size_t j) const { return entries[i * n + j]; }
  bool lies_in(const Constraints& constraints) const {
    return std::all_of(constraints.begin(), constraints.end(),
                       [&](const zones::Atom& atom) { return at(atom.left, atom.right) <= atom.raw; });
  }

  // Entries that are longer than the way over the new one become that way. No entry that is read on it changes.
  void tighten(const zones::Atom& atom) {
    if (empty() || atom.raw >= at(atom.left, atom.right)) return;
    if (sum(atom.raw, at(atom.right, atom.left)) < zones::raw_zero) return entries.clear();
    for (std::size_t i = 0; i < n; ++i)
      if (const zones::Raw there = sum(at(i, atom.left), atom.raw); there < unbounded)
        for (std::size_t j = 0; j < n; ++j) at(i, j) = std::min(at(i, j), sum(there, at(atom.right, j)));
  }
  void tighten(const Constraints& constraints) {
    for (const zones::Atom& atom : constraints) tighten(atom);
  }
  Zone within(const Constraints& constraints) const {
    Zone part = *this;
    part.tighten(constraints);
    return part;
  }
  Constraints constraints() const {
    Constraints found;
    for (std::size_t k = 0; k < entries.size(); ++k)
      if (k / n != k % n && entries[k] < unbounded)
        found.push_back({static_cast<std::uint16_t>(k / n), static_cast<std::uint16_t>(k % n), entries[k]});
    return found;
  }
  void reset(const zones::ClockReset& reset) {
    const std::size_t x = reset.clock;
    const std::size_t y = reset.source;
    for (std::size_t j = 0; j < n; ++j) at(x, j) = sum(zones::raw_bound(reset.value, false), at(y, j));
    for (std::size_t j = 0; j < n; ++j) at(j, x) = sum(at(j, y), zones::raw_bound(-zones::Raw{reset.value}, false));
    at(x, x) = zones::raw_zero;
  }
  void close() {  // Floyd and Warshall
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) at(i, j) = std::min(at(i, j), sum(at(i, k), at(k, j)));
  }
  // The valuations that delays reach; the smallest such zone if clocks stand still besides the reference clock.
  void go_on(const std::vector<bool>& stands) {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        if (stands[j] && !stands[i]) at(i, j) = unbounded;
    if (std::count(stands.begin(), stands.end(), true) > 1) close();
  }
  // From where the zone is reached when time passes.
  void go_back() {
    for (std::size_t j = 0; j < n; ++j) at(0, j) = zones::raw_zero;
    close();
  }
};

using Zones = std::vector<Zone>;

// The parts of the zones outside of the constraints, disjoint if the zones are.
inline Zones without(const Zones& zones, const Constraints& constraints) {
  Zones pieces;
  for (const Zone& zone : zones) {
    if (zone.lies_in(constraints)) continue;
    Zone rest = zone;
    for (std::size_t k = 0; k < constraints.size() && !rest.empty(); ++k) {
      if (Zone outside = rest.within({zones::negated(constraints[k])}); !outside.empty())
        pieces.push_back(std::move(outside));
      rest.tighten(constraints[k]);
    }
  }
  return pieces;
}

inline Zones without(Zones zones, const Zones& others) {
  for (const Zone& other : others) zones = without(zones, other.constraints());
  return zones;
}

}  // namespace tachk::certificates
