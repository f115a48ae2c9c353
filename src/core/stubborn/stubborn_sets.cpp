#include "stubborn/stubborn_sets.hpp"

#include <algorithm>
#include <bit>

#include "machine/code_accesses.hpp"

namespace tachk::stubborn {

using machine::CodeAccesses;
using program::Edge;
using program::Location;
using zones::Atom;

namespace {

constexpr std::size_t most_processes = 64;
constexpr std::size_t most_locations = 2048;

// True if a condition sets a clock a bound that it may reach.
bool sets_a_bound(const Atom& atom) { return atom.left != 0 && atom.right == 0 && (atom.raw & zones::raw_zero) != 0; }

}  // namespace

bool StubbornSets::is_location(const program::Test& test) const {
  return test.slot < program_.processes.size() && test.constant >= 0 &&
         static_cast<std::size_t>(test.constant) < program_.processes[test.slot].locations.size();
}

struct StubbornSets::Place {
  std::vector<const Edge*> now;        // the edges from here
  std::vector<const Edge*> receiving;  // and the receiving ones from where these lead
  std::vector<const Edge*> ever;  // all edges that can be taken from now on without leaving the graph of the process
  CodeAccesses at_once;           // of the first, invariants included
  CodeAccesses in_future;         // of the last, likewise
};

StubbornSets::StubbornSets(const program::Program& program, const symbolic::Semantics& semantics,
                           const zones::ZoneOperations& operations, bool wanted)
    : program_(program), semantics_(semantics), operations_(operations) {
  if (!wanted || !applies()) return;
  locations_ = semantics_.location_count();
  find_dependencies(describe());
}

// Priorities and stopwatches are left out, and so is everything that asks for all states.
bool StubbornSets::applies() const {
  const bool stops =
      std::any_of(program_.processes.begin(), program_.processes.end(), [](const program::Process& process) {
        return std::any_of(process.locations.begin(), process.locations.end(), [](const Location& location) {
          const std::vector<Atom>& atoms = location.invariant.atoms;
          return location.urgent || location.committed || std::any_of(atoms.begin(), atoms.end(), sets_a_bound);
        });
      });
  const bool has_deadlock = std::any_of(program_.goals.begin(), program_.goals.end(), [](const program::Goal& goal) {
    return std::any_of(goal.disjuncts.begin(), goal.disjuncts.end(),
                       [](const program::Disjunct& one) { return one.deadlock != program::DeadlockLiteral::absent; });
  });
  return stops && !has_deadlock && !program_.has_priorities && !program_.has_stopwatches &&
         program_.diagonals.empty() && program_.goals.size() > 0 && program_.measures.empty() &&
         program_.processes.size() <= most_processes && semantics_.location_count() <= most_locations;
}

std::vector<StubbornSets::Place> StubbornSets::describe() const {
  std::vector<Place> places;
  for (std::size_t process = 0; process < program_.processes.size(); ++process) {
    const std::vector<Location>& locations = program_.processes[process].locations;
    std::vector<std::vector<const Edge*>> leaving(locations.size());
    for (const Edge& edge : program_.edges)
      if (edge.process == process) leaving[static_cast<std::size_t>(edge.source)].push_back(&edge);
    for (std::size_t here = 0; here < locations.size(); ++here) {
      Place& place = places.emplace_back(Place{leaving[here], {}, {}, CodeAccesses(program_), CodeAccesses(program_)});
      const auto add = [&](CodeAccesses& accesses, const Edge& edge) {
        const auto target = static_cast<std::size_t>(edge.target);
        accesses.add(edge.guard);
        accesses.add(edge.channel_code);
        accesses.add(edge.update);
        accesses.add(locations[target].invariant);
        if (edge.target != edge.source) accesses.writes.add_slots(edge.process, edge.process);
      };
      place.at_once.add(locations[here].invariant);
      place.in_future.add(locations[here].invariant);
      for (const Edge* edge : place.now) {
        add(place.at_once, *edge);
        for (const Edge* next : leaving[static_cast<std::size_t>(edge->target)])
          if (!next->internal() && !next->sends) place.receiving.push_back(next);
      }
      std::vector<std::size_t> open{here};
      std::vector<bool> known(locations.size());
      known[here] = true;
      while (!open.empty()) {
        const std::size_t from = open.back();
        open.pop_back();
        for (const Edge* edge : leaving[from]) {
          place.ever.push_back(edge);
          add(place.in_future, *edge);
          const auto target = static_cast<std::size_t>(edge->target);
          if (!known[target]) open.push_back(target);
          known[target] = true;
        }
      }
    }
  }
  return places;
}

void StubbornSets::find_dependencies(const std::vector<Place>& places) {
  CodeAccesses goals(program_);
  std::vector<bool> named(locations_);  // a goal asks whether a process is there
  for (const program::Goal& goal : program_.goals)
    for (const program::Disjunct& disjunct : goal.disjuncts) {
      program::Condition condition = disjunct.condition;
      std::erase_if(condition.tests, [&](const program::Test& test) {
        const bool is_location_test = is_location(test) && test.comparison == program::Comparison::equal;
        if (is_location_test) named[semantics_.location_number(test.slot, test.constant)] = true;
        return is_location_test;
      });
      goals.add(condition);
    }
  const auto share = [](const std::vector<const Edge*>& some, const std::vector<const Edge*>& others) {
    return std::any_of(some.begin(), some.end(), [&](const Edge* one) {
      return std::any_of(others.begin(), others.end(), [&](const Edge* other) { return one->may_meet(*other); });
    });
  };
  dependent_.assign(locations_ * locations_, false);
  for (std::size_t one = 0; one < locations_; ++one) {
    const Place& place = places[one];
    seen_.push_back(place.at_once.writes.meets(goals.reads) ||
                    std::any_of(place.now.begin(), place.now.end(), [&](const Edge* edge) {
                      return named[semantics_.location_number(edge->process, edge->source)] ||
                             named[semantics_.location_number(edge->process, edge->target)];
                    }));
    moves_.push_back(!place.now.empty());
    commitment_.push_back(0);
    for (const Edge* edge : place.now) {
      const Location& target = program_.processes[edge->process].locations[static_cast<std::size_t>(edge->target)];
      commitment_.back() = std::max(commitment_.back(), target.commitment());
    }
    for (std::size_t other = 0; other < locations_; ++other) {
      const Place& there = places[other];
      dependent_[one * locations_ + other] = place.at_once.writes.meets(there.in_future.reads) ||
                                             place.at_once.writes.meets(there.in_future.writes) ||
                                             place.at_once.reads.meets(there.in_future.writes) ||
                                             share(place.now, there.ever) || share(place.receiving, there.ever);
    }
  }
}

bool StubbornSets::has_ended(const Location& here, zones::ConstZoneRef zone) const {
  return here.has_invariant &&
         std::any_of(here.invariant.atoms.begin(), here.invariant.atoms.end(), [&](const Atom& atom) {
           const zones::Raw least = zones::raw_bound(-zones::raw_value(atom.raw), false);
           return sets_a_bound(atom) && operations_.entry(zone, program_.dimension(), 0, atom.left) <= least;
         });
}

StubbornSets::Members StubbornSets::enough(const std::int32_t* slots, zones::ConstZoneRef zone) const {
  if (dependent_.empty()) return 0;
  const std::size_t processes = program_.processes.size();
  int most = 0;
  for (std::size_t p = 0; p < processes; ++p) most = std::max(most, semantics_.location(p, slots).commitment());
  Members stopping = 0;
  for (std::size_t p = 0; p < processes; ++p) {
    const Location& here = semantics_.location(p, slots);
    if (most > 0 ? here.commitment() == most : here.urgent || has_ended(here, zone)) stopping |= Members{1} << p;
  }
  Members best = 0;
  for (Members left = stopping; left != 0; left &= left - 1) {
    const Members found = closure(static_cast<std::size_t>(std::countr_zero(left)), most, slots);
    if (found != 0 && (best == 0 || std::popcount(found) < std::popcount(best))) best = found;
  }
  return best;
}

StubbornSets::Members StubbornSets::closure(std::size_t process, int most, const std::int32_t* slots) const {
  const std::size_t processes = program_.processes.size();
  Members members = Members{1} << process;
  for (Members open = members; open != 0;) {
    const auto member = static_cast<std::size_t>(std::countr_zero(open));
    open &= open - 1;
    const std::size_t here = number(member, slots);
    // A member that becomes more committed than all would keep others from moving.
    if (seen_[here] || commitment_[here] > most) return 0;
    for (std::size_t other = 0; other < processes; ++other) {
      const Members bit = Members{1} << other;
      if ((members & bit) != 0 || !depends(here, number(other, slots))) continue;
      members |= bit;
      open |= bit;
    }
  }
  for (std::size_t other = 0; other < processes; ++other)
    if ((members >> other & 1) == 0 && moves_[number(other, slots)]) return members;
  return 0;
}

}  // namespace tachk::stubborn
