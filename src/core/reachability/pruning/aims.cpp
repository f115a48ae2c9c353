#include "reachability/pruning/aims.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "machine/edge_effects.hpp"
#include "reachability/pruning/pairs.hpp"

namespace tachk::reachability::pruning {
namespace {

using program::Condition;
using program::Program;
using program::Test;
using zones::Atom;

constexpr std::size_t most_edges = 20'000;
constexpr std::size_t most_pairs = 1 << 16;  // of one process and clock, counted with the edges
constexpr std::size_t most_work = 1 << 21;   // of all of them: then the rest of a goal says nothing

// The clock of a constraint on it alone; 0 for others.
std::uint16_t only_clock(const Atom& atom) {
  if (atom.right == 0) return atom.left;
  return atom.left == 0 ? atom.right : std::uint16_t{0};
}

class Builder {
 public:
  explicit Builder(const Program& program)
      : program_(program), reader_(program), writers_(static_cast<std::size_t>(program.clocks) + 1) {
    for (const program::Process& process : program.processes) {
      EdgesOfProcess& steps = steps_.emplace_back();
      steps.from.resize(process.locations.size());
      steps.to.resize(process.locations.size());
    }
    effects_.reserve(program.edges.size());
    for (const program::Edge& edge : program.edges) {
      effects_.push_back(reader_.of(edge));
      for (const auto& clock : effects_.back().clocks) writers_[clock.clock].insert(edge.process);
    }
    for (std::size_t number = 0; number < program.edges.size(); ++number) {
      const program::Edge& edge = program.edges[number];
      EdgesOfProcess& steps = steps_[edge.process];
      steps.from[static_cast<std::size_t>(edge.source)].push_back({&edge, &effects_[number]});
      steps.to[static_cast<std::size_t>(edge.target)].push_back({&edge, &effects_[number]});
      ++steps.count;
    }
  }

  Aims build() {
    for (std::uint32_t process = 0; process < program_.processes.size(); ++process) {
      if (!can_fail(process)) continue;
      aims_.errors.push_back(aim_at_errors(process));
      if (aims_.errors.back().is_trivial()) return std::move(aims_);
    }
    for (const program::Goal& goal : program_.goals) {
      std::vector<Aim>& aims = aims_.goals.emplace_back();
      bool always = goal.disjuncts.empty() && goal.decides;
      for (const program::Disjunct& disjunct : goal.disjuncts) {
        always = always || disjunct.deadlock != program::DeadlockLiteral::absent;
        if (always) break;
        aims.push_back(aim_at(disjunct.condition));
        always = aims.back().is_trivial();
      }
      aims_.always.push_back(always);
    }
    return std::move(aims_);
  }

 private:
  bool is_own(std::uint32_t process, std::uint16_t clock) const {
    const std::set<std::uint32_t>& writers = writers_[clock];
    return writers.empty() || (writers.size() == 1 && writers.contains(process));
  }

  // Those that the process compares with constants and nobody else sets; 0 where there are none.
  std::set<std::uint16_t> clocks_of(std::uint32_t process, const std::vector<Atom>& more) const {
    std::set<std::uint16_t> clocks;
    const auto add = [&](const std::vector<Atom>& atoms) {
      for (const Atom& atom : atoms)
        if (const std::uint16_t clock = only_clock(atom); clock != 0 && is_own(process, clock)) clocks.insert(clock);
    };
    for (const std::vector<EdgeWithEffects>& steps : steps_[process].from)
      for (const EdgeWithEffects& step : steps) add(step.edge->guard.atoms);
    for (const program::Location& location : program_.processes[process].locations) add(location.invariant.atoms);
    add(more);
    if (clocks.empty()) clocks.insert(0);
    return clocks;
  }

  View view(std::uint32_t process, std::uint16_t clock, const std::vector<Atom>& more) const {
    std::vector<std::int64_t> constants;
    const auto add = [&](const std::vector<Atom>& atoms) {
      for (const Atom& atom : atoms)
        if (clock != 0 && only_clock(atom) == clock) constants.push_back(std::abs(zones::raw_value(atom.raw)));
    };
    for (const std::vector<EdgeWithEffects>& steps : steps_[process].from)
      for (const EdgeWithEffects& step : steps) add(step.edge->guard.atoms);
    for (const program::Location& location : program_.processes[process].locations) add(location.invariant.atoms);
    add(more);
    View made{&program_, process, Intervals(clock, std::move(constants)), &steps_[process]};
    if ((made.steps->count + made.locations().size()) * made.intervals.size() > most_pairs)
      made.intervals = Intervals(0, {});
    return made;
  }

  // Adds the places from which the targets are reached, unless the process never leaves them.
  void add_places(const View& view, const PairSet& targets, Aim& aim) {
    work_ += targets.size() + view.steps->count;
    if (work_ > most_work) return;
    const auto key = std::tuple(view.process, view.intervals.clock(), view.intervals.size(), targets);
    const auto [known, fresh] = known_.try_emplace(key, nothing);
    if (fresh) {
      const PairSet pairs = backward(view, targets);
      if (may_leave(view, pairs)) {
        known->second = aims_.places.size();
        aims_.places.push_back(places_of(view, pairs));
      }
    }
    if (known->second != nothing) aim.places.push_back(known->second);
  }

  static Places places_of(const View& view, const PairSet& pairs) {
    Places places{view.process, {}};
    for (std::size_t location = 0; location < view.locations().size(); ++location) {
      auto& intervals = places.intervals.emplace_back();
      const std::size_t count = view.intervals.size();
      for (std::size_t first = 0; first < count; ++first) {
        if (!pairs[view.number(location, first)]) continue;
        std::size_t last = first;
        while (last + 1 < count && pairs[view.number(location, last + 1)]) ++last;
        intervals.push_back(view.intervals.atoms(first, last));
        first = last;
      }
    }
    return places;
  }

  // ---- goals ----

  Aim aim_at(const Condition& condition) {
    // A predicate that may fail does so where its tests hold, whatever clocks show.
    const bool is_plain = condition.code == program::no_code && condition.computed.empty() && condition.flow.empty();
    const std::vector<Atom> atoms = is_plain ? condition.atoms : std::vector<Atom>{};
    std::set<std::uint32_t> processes;
    std::map<std::uint32_t, std::vector<Test>> of_variables;
    for (const Test& test : condition.tests)
      if (test.slot < program_.processes.size())
        processes.insert(test.slot);
      else
        of_variables[test.slot].push_back(test);
    for (const Atom& atom : atoms) add_owner(only_clock(atom), processes);
    Aim aim;
    for (const std::uint32_t process : processes)
      for (const std::uint16_t clock : clocks_of(process, atoms)) {
        const View made = view(process, clock, atoms);
        PairSet targets(made.locations().size() * made.intervals.size(), false);
        for (std::size_t location = 0; location < made.locations().size(); ++location)
          if (holds_in(condition.tests, process, location))
            for (std::size_t interval = 0; interval < made.intervals.size(); ++interval)
              targets[made.number(location, interval)] = made.intervals.satisfies(interval, atoms);
        add_places(made, targets, aim);
      }
    if (!of_variables.empty()) read_accesses();
    for (const auto& [slot, tests] : of_variables)
      if (std::optional<ValueSet> values = values_before(program_, effects_, slot, tests))
        aim.values.push_back(*std::move(values));
    return aim;
  }

  // Finds out which variables are written where that is not known yet.
  void read_accesses() {
    for (std::size_t number = 0; number < effects_.size(); ++number)
      if (std::exchange(effects_[number].any_slot, false))
        effects_[number].slots = reader_.slots_of(program_.edges[number]);
  }

  // The only process that sets a clock; if none does, any that is there already, or the first.
  void add_owner(std::uint16_t clock, std::set<std::uint32_t>& processes) const {
    if (clock == 0 || writers_[clock].size() > 1) return;
    if (!writers_[clock].empty())
      processes.insert(*writers_[clock].begin());
    else if (processes.empty() && !program_.processes.empty())
      processes.insert(0);
  }

  static bool holds_in(const std::vector<Test>& tests, std::uint32_t process, std::size_t location) {
    const auto here = static_cast<std::int32_t>(location);
    return std::all_of(tests.begin(), tests.end(), [&](Test test) {
      if (test.slot != process) return true;
      test.slot = 0;
      return test.holds(&here);
    });
  }

  // ---- run-time errors ----

  bool may_fail_in(std::uint32_t process, std::size_t location) {
    return reader_.can_fail(program_.processes[process].locations[location].invariant);
  }

  bool can_fail(std::uint32_t process) {
    for (std::size_t location = 0; location < program_.processes[process].locations.size(); ++location)
      if (may_fail_in(process, location)) return true;
    const auto& from = steps_[process].from;
    return std::any_of(from.begin(), from.end(), [](const std::vector<EdgeWithEffects>& steps) {
      return std::any_of(steps.begin(), steps.end(), [](const EdgeWithEffects& step) {
        return step.effects->guard_can_fail || step.effects->update_can_fail;
      });
    });
  }

  Aim aim_at_errors(std::uint32_t process) {
    Aim aim;
    for (const std::uint16_t clock : clocks_of(process, {})) {
      const View made = view(process, clock, {});
      PairSet targets(made.locations().size() * made.intervals.size(), false);
      const auto add = [&](std::size_t location, const std::vector<Atom>& atoms) {
        for (std::size_t interval = 0; interval < made.intervals.size(); ++interval)
          if (made.intervals.satisfies(interval, atoms)) targets[made.number(location, interval)] = true;
      };
      for (std::size_t location = 0; location < made.locations().size(); ++location)
        if (may_fail_in(process, location)) add(location, {});
      for (std::size_t source = 0; source < made.locations().size(); ++source)
        for (const EdgeWithEffects& step : made.steps->from[source])
          if (step.effects->guard_can_fail)
            add(source, {});
          else if (step.effects->update_can_fail || may_fail_in(process, static_cast<std::size_t>(step.edge->target)))
            add(source, step.edge->guard.atoms);
      add_places(made, targets, aim);
    }
    return aim;
  }

  static constexpr std::size_t nothing = SIZE_MAX;

  const Program& program_;
  machine::EffectReader reader_;
  std::vector<machine::EdgeEffects> effects_;     // of each edge
  std::vector<std::set<std::uint32_t>> writers_;  // of each clock the processes that set it
  std::vector<EdgesOfProcess> steps_;             // of each process
  std::map<std::tuple<std::uint32_t, std::uint16_t, std::size_t, PairSet>, std::size_t> known_;
  std::size_t work_ = 0;
  Aims aims_;
};

}  // namespace

bool Aims::none() const {
  const auto trivial = [](const Aim& aim) { return aim.is_trivial(); };
  return std::any_of(errors.begin(), errors.end(), trivial) ||
         std::find(always.begin(), always.end(), false) == always.end();
}

Aims aims_of(const Program& program) {
  if (program.has_stopwatches || !program.measures.empty() || program.edges.size() > most_edges) return {};
  return Builder(program).build();
}

}  // namespace tachk::reachability::pruning
