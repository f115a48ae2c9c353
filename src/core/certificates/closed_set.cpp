#include "certificates/closed_set.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <utility>

#include "certificates/network.hpp"
#include "certificates/states.hpp"

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
  struct Shape {  // a zone, which many discrete states may have
    Constraints constraints;
    Zone zone;
  };
  struct Element {
    std::uint64_t shape;
    std::int64_t rank;
  };

  Checker(Program given, Claim claimed)
      : network(std::move(given)), program(network.program), claim(claimed), states(program), first(1) {
    current.slots = network.initial();
  }

  // ---- the elements -------------------------------------------------------------------------------------------------

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
  void expect_in_range(std::size_t slot, std::int64_t value) const {
    expect(value >= program.slots[slot].low && value <= program.slots[slot].high,
           "a discrete state has a value out of its range");
  }
  void add_group(CertificateColumns& columns, const std::int32_t* slots, std::int64_t zones) {
    if (zones == 0) return;
    for (; zones > 0; --zones) {
      const auto shape = static_cast<std::uint64_t>(taken(columns.shapes));
      elements.push_back({shape, taken(columns.ranks)});
      expect(shape < shapes.size(), "a zone that has not been told");
      expect(elements.back().rank >= 0 && (elements.back().rank > 0) == (elements[first.back()].rank > 0),
             "ranks that cannot be");
    }
    expect(states.add(slots, elements.back().rank > 0), "a discrete state occurs twice");
    first.push_back(elements.size());
  }
  std::span<const Element> elements_of(std::size_t state) const {
    return {elements.begin() + static_cast<std::ptrdiff_t>(first[state]),
            elements.begin() + static_cast<std::ptrdiff_t>(first[state + 1])};
  }
  // By one zone of the set, as a rule, else by several together: of the rank 0, or ranked ones below a rank.
  bool covers(const Situation& there, const Zone& zone, std::int64_t below) const {
    const std::uint32_t state = states.find(there.slots.data(), below > 0);
    if (state == certificates::States::none) return zone.empty();
    const auto counts = [&](const Element& element) { return below == 0 || element.rank < below; };
    for (const Element& element : elements_of(state))
      if (counts(element) && zone.lies_in(shapes[element.shape].constraints)) return true;
    Zones rest{zone};
    for (const Element& element : elements_of(state))
      if (counts(element)) rest = without(rest, shapes[element.shape].constraints);
    return rest.empty();
  }

  // ---- the check ----------------------------------------------------------------------------------------------------

  // A zone is in the set with what it becomes by waiting; in ranked elements, as far as the goal is not met before.
  void require(Situation& there, Zone& zone, std::int64_t below, const char* otherwise,
               std::span<const std::uint32_t> edges = {}) {
    if (zone.empty()) return;
    bool is_covered = true;
    if (below == 0) {
      network.wait(there, zone);
      is_covered = covers(there, zone, 0);
    } else {
      for (const Zone& part : network.avoiding(program.goals[0], there, zone))
        is_covered = is_covered && covers(there, part, below);
    }
    if (!is_covered) throw Objection{otherwise, {}, 0, {edges.begin(), edges.end()}};
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
    Zone later = zone;
    network.wait(here, later);
    for (Zone& met : network.where(program.goals[0], here, later, false)) {
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
      for (Zone& part : network.where(program.goals[1], here, zone, true))
        require(here, part, any_rank, "it is not shown that the goal is met from here");
    }
    for (const Zone& part : parts)
      for (Step& step : network.steps(here, part, room)) {
        network.taking_part = step.edges;
        require(step.target, step.reach(), rank, "a successor is not in the set", step.edges);
      }
  }
  // Objections are thrown without the place, which is added here.
  template <class Check>
  void note(std::size_t zone, Check&& check) {
    network.taking_part.clear();
    try {
      return check();
    } catch (const Objection& found) {
      objection = found;
    } catch (const ModelFault&) {
      objection = Objection{"something in the model cannot be evaluated", {}, 0, network.taking_part};
    }
    objection->zone = zone;
  }
  void check_initial() {
    note(0, [&] {
      network.describe(current);
      const bool ranked = claim == Claim::inevitable && program.goals.size() == 1;
      Zone zone = Zone::filled(network.n, raw_zero).within(current.limits);
      if (current.possible) require(current, zone, ranked ? any_rank : 0, "the initial state is not in the set");
    });
  }
  void check_state(std::size_t state) {
    states.read(state, current.slots.data());
    for (std::size_t number = 0; number < elements_of(state).size() && !objection; ++number) {
      note(number, [&] {
        if (number == 0) network.describe(current);
        const auto [shape, rank] = elements_of(state)[number];
        const Zone zone = shapes[shape].zone.within(current.limits);
        if (current.possible && !zone.empty()) check_zone(current, zone, rank);
      });
      if (objection) objection->discrete.assign(current.slots.begin(), current.slots.begin() + program.state_slots);
    }
  }

  Network network;
  const Program& program;
  Claim claim;
  std::vector<Shape> shapes;
  certificates::States states;
  std::vector<Element> elements;   // one state after the other
  std::vector<std::size_t> first;  // of each state its first element, and the end of all
  Situation current;               // what is being checked
  certificates::Steps room;
  std::size_t next = 0;
  std::optional<Objection> objection;
};

ClosedSet::ClosedSet(Program program, Claim claim) : checker_(std::make_unique<Checker>(std::move(program), claim)) {}
ClosedSet::~ClosedSet() = default;

void ClosedSet::add(CertificateColumns columns) {
  Checker& checker = *checker_;
  for (const std::int64_t count : columns.constraints) checker.add_shape(columns, count);
  std::vector<std::int32_t> slots(checker.program.state_slots, 0);
  for (std::size_t group = 0; group < columns.zones.size(); ++group) {
    for (std::int64_t left = columns.changes[group]; left > 0; --left) {
      const auto slot = static_cast<std::size_t>(taken(columns.positions));
      const std::int64_t value = slots.at(slot) + taken(columns.differences);
      checker.expect_in_range(slot, value);
      slots[slot] = static_cast<std::int32_t>(value);
    }
    for (std::size_t slot = 0; group == 0 && slot < slots.size(); ++slot) checker.expect_in_range(slot, slots[slot]);
    checker.add_group(columns, slots.data(), columns.zones[group]);
  }
}

bool ClosedSet::check(std::size_t states) {
  Checker& checker = *checker_;
  if (checker.next == 0) checker.check_initial();
  for (; states > 0 && checker.next < checker.states.size() && !checker.objection; --states)
    checker.check_state(checker.next++);
  return checker.objection || checker.next == checker.states.size();
}

const std::optional<Objection>& ClosedSet::objection() const { return checker_->objection; }

}  // namespace tachk
