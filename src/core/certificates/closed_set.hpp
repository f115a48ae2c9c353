// The check that a set of symbolic states is closed: it covers the initial state and every successor of its states.
// Then it has all reachable states (Wimmer and von Mutius 2020). Those that satisfy the second goal of the program must
// be in ranked elements, from which each run meets the first goal: successors have smaller ranks or satisfy it, and
// nothing can stay in one for ever (Wimmer, Herbreteau and van de Pol 2020). If the first goal is empty, that says that
// the second one is not reached, for nothing has ranks then. If there is no second goal, the initial state has a rank.
// A state need not be in the set if neither the goal nor a run-time error can follow it: for each disjunct of the goal,
// and for each process that may have an error, the state lies in a set that no run leaves and in which that disjunct or
// error does not occur (`Traps`). Processes of the program may be interchangeable. Then each state stands for all
// states that come from it by exchanging them, and the set of all of these is closed. The set is a proof only if each
// permutation maps the program and the goals onto themselves. tachk.meaning.judge.closed_set is the same check in
// Python, which does without the compiler as well.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "certificates/arrangements.hpp"
#include "certificates/network.hpp"
#include "certificates/traps.hpp"

namespace tachk::certificates {

// The reason why a set is rejected, and where: the discrete state, the zone among those of this discrete state, and the
// edges of the action that leads out of the set.
struct Objection {
  std::string reason;
  std::vector<std::int32_t> discrete;
  std::size_t zone = 0;
  std::vector<std::uint32_t> edges;
};

// Discrete states one behind the other, with the numbers of their zones among all that have been listed, and new zones:
// of each the matrix of bounds. Otherwise as tachk.meaning.judge.certificate.Columns.
struct Block {
  std::span<const std::int32_t> discretes;
  std::span<const std::int64_t> zones, ranks, shapes, bounds;
};

class ClosedSet final {
 public:
  ClosedSet(program::Program program, Traps traps)
      : network_(std::move(program)), traps_(std::move(traps)), initial_(network_.initial()) {}

  // Throws std::invalid_argument for what is no state of the program.
  void add(const Block& block) {
    const std::size_t n = network_.n, width = network_.program.state_slots;
    for (auto from = block.bounds.begin(); from < block.bounds.end(); from += n * n) {
      const Zone given{n, {from, from + n * n}};
      for (std::size_t i = 0; i < n; ++i) expect(given.at(i, i) >= zones::raw_zero, "a zone is empty");
      const Constraints constraints = given.constraints();
      for (const zones::Atom& atom : constraints)
        expect(std::abs(atom.raw) < zones::Raw{1} << 42, "a constraint that cannot be");
      shapes_.push_back({constraints, Zone::universe(n).within(constraints)});
      expect(!shapes_.back().zone.empty(), "a zone is empty");
    }
    for (std::size_t group = 0, e = 0; group < block.zones.size(); ++group) {
      const auto slots = block.discretes.subspan(group * width, width);
      for (std::size_t slot = 0; slot < width; ++slot)
        expect(slots[slot] >= network_.program.slots[slot].low && slots[slot] <= network_.program.slots[slot].high,
               "a discrete state has a value out of its range");
      if (block.zones[group] == 0) continue;  // as if it were not there
      const bool ranked = block.ranks[e] > 0;
      for (std::int64_t left = block.zones[group]; left > 0; --left, ++e) {
        elements_.push_back({static_cast<std::uint64_t>(block.shapes[e]), block.ranks[e]});
        expect(elements_.back().shape < shapes_.size(), "a zone that has not been listed");
        expect(block.ranks[e] >= 0 && (block.ranks[e] > 0) == ranked, "ranks that cannot be");
      }
      const auto [entry, fresh] = numbers_.emplace(key(slots, ranked), states_.size());
      expect(fresh, "a discrete state occurs twice");
      states_.push_back(&entry->first);
      first_.push_back(elements_.size());
    }
  }
  // Checks at most so many more discrete states; true once there is nothing left to check, or an objection.
  bool check(std::size_t states) {
    for (; states > 0 && next_ <= states_.size() && !objection_; --states, ++next_) try {
        network_.taking_part.clear();
        next_ == 0 ? check_initial() : check_state(next_ - 1);
      } catch (const char* reason) {
        object(reason);
      } catch (const machine::ModelFault&) {
        object("something in the model cannot be evaluated");
      }
    return objection_ || next_ > states_.size();
  }
  const std::optional<Objection>& objection() const { return objection_; }

 private:
  struct Shape {  // a zone, which many discrete states may have
    Constraints constraints;
    Zone zone;
  };
  struct Element {
    std::uint64_t shape;
    std::int64_t rank;
  };
  static constexpr std::int64_t any_rank = std::numeric_limits<std::int64_t>::max();

  static void expect(bool met, const char* otherwise) {
    if (!met) throw std::invalid_argument(otherwise);
  }
  // Of a discrete state: whether its elements have ranks, then the numbers that are not as in the initial state.
  const std::u32string& key(std::span<const std::int32_t> slots, bool ranked) {
    key_.assign(1, ranked);
    for (std::size_t slot = 0; slot < network_.program.state_slots; ++slot)
      if (slots[slot] != initial_[slot]) (key_ += static_cast<char32_t>(slot)) += static_cast<char32_t>(slots[slot]);
    return key_;
  }
  // By one zone of the set, as a rule, else by several together: of the rank 0, or ranked ones below a rank.
  bool covers(const std::vector<std::int32_t>& slots, const Zone& zone, std::int64_t below) {
    const auto found = numbers_.find(key(slots, below > 0));
    if (found == numbers_.end()) return zone.empty();
    const auto first = elements_.begin() + static_cast<std::ptrdiff_t>(first_[found->second]);
    const auto last = elements_.begin() + static_cast<std::ptrdiff_t>(first_[found->second + 1]);
    const auto counts = [below](const Element& element) { return below == 0 || element.rank < below; };
    const auto alone = [&](const Element& element) {
      return counts(element) && zone.lies_in(shapes_[element.shape].constraints);
    };
    if (std::any_of(first, last, alone)) return true;
    Zones rest{zone};
    for (auto element = first; element != last && !rest.empty(); ++element)
      if (counts(*element)) rest = without(rest, shapes_[element->shape].constraints);
    return rest.empty();
  }
  bool covers_some_arrangement(const Situation& there, const Zone& zone, std::int64_t below) {
    if (arrangements_.none()) return covers(there.slots, zone, below);
    return arrangements_.some(there.slots, zone,
                              [&](const auto& slots, const Zone& arranged) { return covers(slots, arranged, below); });
  }

  // The parts of a zone that are in no zone of the set.
  Zones uncovered(const std::vector<std::int32_t>& slots, const Zone& zone) {
    Zones rest{zone};
    const auto found = numbers_.find(key(slots, false));
    if (found == numbers_.end()) return rest;
    for (std::size_t e = first_[found->second]; e < first_[found->second + 1] && !rest.empty(); ++e)
      rest = without(rest, shapes_[elements_[e].shape].constraints);
    return rest;
  }
  bool may_be_left_out(const Situation& there, const Zone& zone) {
    if (traps_.none()) return false;
    const Zones rest = arrangements_.none() ? uncovered(there.slots, zone) : Zones{zone};
    return std::all_of(rest.begin(), rest.end(), [&](const Zone& part) { return traps_.have(there.slots, part); });
  }

  // The bound up to which elements and their successors are checked.
  const program::Goal& goal(std::int64_t rank) const {
    static const program::Goal never;
    return rank > 0 ? network_.program.goals[0] : never;
  }

  // A zone is in the set with what it becomes by waiting, as far as the goal is not met before.
  void require(Situation& there, const Zone& zone, std::int64_t below, const char* otherwise) {
    if (zone.empty()) return;
    for (const Zone& part : network_.avoiding(goal(below), there, zone))
      if (!covers_some_arrangement(there, part, below) && !may_be_left_out(there, part)) throw otherwise;
  }
  // Time cannot pass for ever before the goal is met, and some step stays possible.
  void check_ends(const Zone& zone) {
    for (const Zone& later : network_.avoiding(network_.program.goals[0], here_, zone)) {
      bool for_ever = here_.waits;
      for (std::size_t i = 0; i < network_.n; ++i) for_ever &= here_.stands[i] || later.at(i, 0) >= unbounded;
      if (for_ever) throw "time can pass for ever, and the goal is not met";
    }
    Zones dead = network_.stuck(here_, zone, true);
    for (Zone& met : network_.where(network_.program.goals[0], here_, network_.later(here_, zone), false)) {
      if (here_.waits && !here_.stops) met.go_back();
      dead = without(dead, met.constraints());
    }
    network_.taking_part.clear();
    if (!dead.empty()) throw "nothing can happen any more in some state, and the goal is not met";
  }
  void check_zone(const Zone& zone, std::int64_t rank) {
    const Zones parts = without({zone}, network_.where(goal(rank), here_, zone, false));
    if (rank > 0)
      for (const Zone& part : parts) check_ends(part);
    else if (network_.program.goals.size() > 1)
      for (Zone& part : network_.where(network_.program.goals[1], here_, zone, true))
        require(here_, part, any_rank,
                network_.program.goals[0].disjuncts.empty() ? "some state of the zone is one that must not be reached"
                                                            : "it is not shown that the goal is met from here");
    for (const Zone& part : parts)
      for (Step& step : network_.steps(here_, part, steps_)) {
        network_.taking_part = step.edges;
        require(step.target, step.reach(), rank, "a successor is not in the set");
      }
  }
  void check_initial() {
    here_.slots = initial_;
    network_.describe(here_);
    Zone zone = Zone::filled(network_.n, zones::raw_zero);
    for (const zones::ClockReset& start : network_.program.starts) zone.reset(start);
    zone.tighten(here_.limits);
    const std::int64_t below = network_.program.goals.size() > 1 ? 0 : any_rank;
    if (here_.possible) require(here_, zone, below, "the initial state is not in the set");
  }
  void check_state(std::size_t state) {
    here_.slots = initial_;
    for (std::size_t k = 1; k < states_[state]->size(); k += 2)
      here_.slots[(*states_[state])[k]] = static_cast<std::int32_t>((*states_[state])[k + 1]);
    zone_ = 0;
    network_.describe(here_);
    for (std::size_t e = first_[state]; e < first_[state + 1] && here_.possible; ++e) {
      zone_ = e - first_[state];
      network_.taking_part.clear();
      const Zone zone = shapes_[elements_[e].shape].zone.within(here_.limits);
      if (!zone.empty()) check_zone(zone, elements_[e].rank);
    }
  }
  void object(const char* reason) {
    objection_ = Objection{reason, {}, zone_, network_.taking_part};
    if (next_ > 0) objection_->discrete.assign(here_.slots.begin(), here_.slots.begin() + network_.program.state_slots);
  }

  Network network_;
  const Traps traps_;
  const Arrangements arrangements_{network_.program.interchangeable};
  const std::vector<std::int32_t> initial_;
  std::vector<Shape> shapes_;
  std::vector<Element> elements_;      // one state after the other
  std::vector<std::size_t> first_{0};  // of each state its first element, and the end of all
  std::u32string key_;
  std::unordered_map<std::u32string, std::size_t> numbers_;
  std::vector<const std::u32string*> states_;
  std::size_t next_ = 0;  // what is being checked: the initial state, then those of the set
  std::size_t zone_ = 0;
  Situation here_;
  Steps steps_;
  std::optional<Objection> objection_;
};

}  // namespace tachk::certificates
