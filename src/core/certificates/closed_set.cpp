#include "certificates/closed_set.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "certificates/network.hpp"

namespace tachk {

using certificates::Constraints;
using certificates::Network;
using certificates::Situation;
using certificates::Step;
using certificates::Zone;
using certificates::Zones;

namespace {

constexpr std::int64_t any_rank = std::numeric_limits<std::int64_t>::max();
constexpr Raw largest_bound = Raw{1} << 42;

void expect(bool met, const char* otherwise) {
  if (!met) throw std::invalid_argument(otherwise);
}

std::int64_t taken(std::span<const std::int64_t>& column) {
  expect(!column.empty(), "a column is too short");
  const std::int64_t first = column.front();
  column = column.subspan(1);
  return first;
}

}  // namespace

class ClosedSet::Checker {
 public:
  // A discrete state, the value of each slot in as many bytes as its range needs.
  using Packed = std::string;
  struct Shape {  // a zone, which many discrete states may have
    Constraints constraints;
    Zone zone;
  };
  struct Element {
    std::uint64_t shape;
    std::int64_t rank;
  };
  using Groups = std::unordered_map<Packed, std::vector<Element>>;

  Checker(Program given, Claim claimed) : network(std::move(given)), program(network.program), claim(claimed) {
    for (std::size_t slot = 0; slot < program.state_slots; ++slot)
      widths.push_back(std::bit_width(static_cast<std::uint32_t>(program.slots[slot].high) -
                                      static_cast<std::uint32_t>(program.slots[slot].low)));
  }

  // ---- the elements -------------------------------------------------------------------------------------------------

  const Packed& packed(const std::int32_t* slots) const {
    Packed& bytes = room;
    bytes.resize(4 * widths.size());
    std::size_t size = 0;
    for (std::size_t slot = 0; slot < widths.size(); ++slot) {
      const auto value = static_cast<std::uint32_t>(slots[slot]) - static_cast<std::uint32_t>(program.slots[slot].low);
      for (int shift = 0; shift < widths[slot]; shift += 8) bytes[size++] = static_cast<char>(value >> shift);
    }
    bytes.resize(size);
    return bytes;
  }
  std::vector<std::int32_t> unpacked(const Packed& bytes) const {
    std::vector<std::int32_t> slots;
    auto byte = bytes.begin();
    for (std::size_t slot = 0; slot < widths.size(); ++slot) {
      auto value = static_cast<std::uint32_t>(program.slots[slot].low);
      for (int shift = 0; shift < widths[slot]; shift += 8)
        value += std::uint32_t{static_cast<unsigned char>(*byte++)} << shift;
      slots.push_back(static_cast<std::int32_t>(value));
    }
    return slots;
  }
  void add_shape(CertificateColumns& columns, std::int64_t count) {
    const auto n = static_cast<std::int64_t>(network.n);
    Constraints constraints;
    for (; count > 0; --count) {
      const std::int64_t place = taken(columns.places), bound = taken(columns.bounds);
      expect(place >= 0 && place < n * n && std::abs(bound) <= largest_bound, "a constraint that cannot be");
      constraints.push_back({static_cast<std::uint16_t>(place / n), static_cast<std::uint16_t>(place % n), bound});
    }
    shapes.push_back({constraints, Zone::universe(network.n).within(constraints)});
  }
  void add_group(CertificateColumns& columns, const std::vector<std::int64_t>& slots, std::int64_t zones) {
    for (std::size_t slot = 0; slot < slots.size(); ++slot)
      expect(slots[slot] >= program.slots[slot].low && slots[slot] <= program.slots[slot].high,
             "a discrete state has a value out of its range");
    std::vector<Element> elements;
    for (; zones > 0; --zones) {
      const auto shape = static_cast<std::uint64_t>(taken(columns.shapes));
      elements.push_back({shape, taken(columns.ranks)});
      expect(shape < shapes.size(), "a zone that has not been told");
      expect(elements.back().rank >= 0 && (elements.back().rank > 0) == (elements[0].rank > 0), "ranks that cannot be");
    }
    if (elements.empty()) return;
    const std::vector<std::int32_t> discrete(slots.begin(), slots.end());
    const auto [group, fresh] = groups[elements[0].rank > 0].emplace(packed(discrete.data()), std::move(elements));
    expect(fresh, "a discrete state occurs twice");
    order.push_back(&*group);
  }
  // By one zone of the set, as a rule, else by several together: of the rank 0, or ranked ones below a rank.
  bool covers(const Situation& there, const Zone& zone, std::int64_t below) const {
    const Groups& among = groups[below > 0];
    const auto found = among.find(packed(there.slots.data()));
    if (found == among.end()) return zone.empty();
    const auto counts = [&](const Element& element) { return below == 0 || element.rank < below; };
    for (const Element& element : found->second)
      if (counts(element) && zone.lies_in(shapes[element.shape].constraints)) return true;
    Zones rest{zone};
    for (const Element& element : found->second)
      if (counts(element)) rest = without(rest, shapes[element.shape].constraints);
    return rest.empty();
  }

  // ---- the check ----------------------------------------------------------------------------------------------------

  // A zone is in the set with what it becomes by waiting; in ranked elements, as far as the goal is not met before.
  void require(Situation& there, const Zone& zone, std::int64_t below, const char* otherwise) {
    if (zone.empty()) return;
    const Zones waited =
        below == 0 ? Zones{network.later(there, zone)} : network.avoiding(program.goals[0], there, zone);
    for (const Zone& part : waited)
      if (!covers(there, part, below)) throw Objection{otherwise, {}, 0, {}};
  }
  // Time cannot pass for ever before the goal is met, and some step stays possible.
  void check_ends(Situation& here, const Zone& zone) {
    for (const Zone& later : network.avoiding(program.goals[0], here, zone)) {
      bool for_ever = here.waits;
      for (std::size_t i = 0; i < network.n; ++i)
        for_ever &= here.stands[i] || later.at(i, 0) >= certificates::unbounded;
      if (for_ever) throw Objection{"time can pass for ever, and the goal is not met", {}, 0, {}};
    }
    Zones dead = network.stuck(here, zone, true);
    for (Zone& met : network.where(program.goals[0], here, network.later(here, zone), false)) {
      if (here.waits && !here.stops) met.go_back();
      dead = without(std::move(dead), met.constraints());
    }
    if (!dead.empty()) throw Objection{"nothing can happen any more in some state, and the goal is not met", {}, 0, {}};
  }
  void check_zone(Situation& here, const Zone& zone, std::int64_t rank) {
    Zones parts{zone};
    if (rank > 0) {
      parts = without(std::move(parts), network.where(program.goals[0], here, zone, false));
      for (const Zone& part : parts) check_ends(here, part);
    } else if (claim == Claim::unreachable) {
      if (!network.where(program.goals[0], here, zone, true).empty())
        throw Objection{"some state of the zone is one that must not be reached", {}, 0, {}};
    } else if (program.goals.size() > 1) {
      for (const Zone& part : network.where(program.goals[1], here, zone, true))
        require(here, part, any_rank, "it is not shown that the goal is met from here");
    }
    for (const Zone& part : parts)
      for (Step& step : network.steps(here, part)) {
        network.taking_part = step.edges;
        require(step.target, step.reached(), rank, "a successor is not in the set");
      }
  }
  // Objections are thrown without the place, which is added here.
  template <class Check>
  void note(const std::vector<std::int32_t>& discrete, std::size_t zone, Check&& check) {
    network.taking_part.clear();
    try {
      return check();
    } catch (const Objection& found) {
      objection = found;
    } catch (const ModelFault&) {
      objection = Objection{"something in the model cannot be evaluated", {}, 0, {}};
    }
    objection->discrete = discrete;
    objection->zone = zone;
    objection->edges = std::move(network.taking_part);
  }
  void check_initial() {
    note({}, 0, [&] {
      Situation here = network.situation({});
      const bool ranked = claim == Claim::inevitable && program.goals.size() == 1;
      const Zone zone = Zone::filled(network.n, raw_zero).within(here.limits);
      if (here.possible) require(here, zone, ranked ? any_rank : 0, "the initial state is not in the set");
      network.taking_part.clear();
    });
  }
  void check_group(const Groups::value_type& group) {
    const std::vector<std::int32_t> discrete = unpacked(group.first);
    for (std::size_t number = 0; number < group.second.size() && !objection; ++number)
      note(discrete, number, [&] {
        Situation here = network.situation(discrete);
        const auto [shape, rank] = group.second[number];
        const Zone zone = shapes[shape].zone.within(here.limits);
        if (here.possible && !zone.empty()) check_zone(here, zone, rank);
      });
  }

  Network network;
  const Program& program;
  Claim claim;
  std::vector<int> widths;  // of each slot the bits that its range needs
  std::vector<Shape> shapes;
  std::array<Groups, 2> groups;  // of the rank 0, and ranked ones
  std::vector<const Groups::value_type*> order;
  mutable Packed room;
  std::size_t next = 0;
  std::optional<Objection> objection;
};

ClosedSet::ClosedSet(Program program, Claim claim) : checker_(std::make_unique<Checker>(std::move(program), claim)) {}
ClosedSet::~ClosedSet() = default;

void ClosedSet::add(CertificateColumns columns) {
  Checker& checker = *checker_;
  for (const std::int64_t count : columns.constraints) checker.add_shape(columns, count);
  std::vector<std::int64_t> slots(checker.widths.size(), 0);
  for (std::size_t group = 0; group < columns.zones.size(); ++group) {
    for (std::int64_t left = columns.changes[group]; left > 0; --left)
      slots.at(static_cast<std::size_t>(taken(columns.positions))) += taken(columns.differences);
    checker.add_group(columns, slots, columns.zones[group]);
  }
}

bool ClosedSet::check(std::size_t states) {
  Checker& checker = *checker_;
  if (checker.next == 0) checker.check_initial();
  for (; states > 0 && checker.next < checker.order.size() && !checker.objection; --states)
    checker.check_group(*checker.order[checker.next++]);
  return checker.objection || checker.next == checker.order.size();
}

const std::optional<Objection>& ClosedSet::objection() const { return checker_->objection; }

}  // namespace tachk
