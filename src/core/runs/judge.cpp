#include "runs/judge.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "runs/concrete_semantics.hpp"

namespace tachk::runs {

using program::Edge;
using program::Goal;
using program::Program;
using zones::Atom;
using zones::ClockReset;

namespace {

using EdgeNumbers = std::span<const std::uint32_t>;
using Verdict = const char*;  // what is wrong; null if nothing is

class Judge {
 public:
  Judge(const Program& program, std::int64_t unit);

  Verdict unsupported() const;
  Verdict begin();
  // Lets time pass until then.
  Verdict wait(std::int64_t until);
  Verdict fire(EdgeNumbers edges);
  bool reached(const Goal& goal);

 private:
  __extension__ using Wide = __int128;

  const Edge& edge(std::uint32_t number) const { return program_.edges[number]; }
  bool satisfied(const Atom& atom) const;
  bool holds(const program::Condition& condition);
  bool invariants();
  bool receives(std::uint32_t number, std::int32_t channel);
  Verdict takes_part(EdgeNumbers edges);
  Verdict synchronise(EdgeNumbers edges);
  bool a_receiver_stays_out(EdgeNumbers edges, std::int32_t channel);

  const Program& program_;
  const std::int64_t unit_;
  ConcreteSemantics semantics_;
  std::int64_t now_ = 0;
  std::vector<Wide> zero_;  // when each clock was, or would have been, 0
  std::vector<Atom> required_;
  std::vector<ClockReset> resets_;
  std::vector<std::vector<std::uint32_t>> receivers_;  // of each channel, the processes that may receive
};

Judge::Judge(const Program& program, std::int64_t unit)
    : program_(program),
      unit_(unit),
      semantics_(program),
      zero_(static_cast<std::size_t>(program.dimension()), 0),
      receivers_(program.channels.size()) {
  for (const ClockReset& start : program.starts) zero_[start.clock] = -Wide{start.value} * unit;
  for (const Edge& each : program.edges)
    for (std::uint32_t n = 0; !each.internal() && !each.sends && n < each.channels; ++n) {
      auto& receiving = receivers_[static_cast<std::size_t>(each.channel) + n];
      if (std::find(receiving.begin(), receiving.end(), each.process) == receiving.end())
        receiving.push_back(each.process);
    }
}

Verdict Judge::unsupported() const {
  if (program_.has_stopwatches) return "clocks can stop";
  if (program_.has_priorities) return "there are priorities";
  for (const Edge& each : program_.edges)
    for (std::uint32_t n = 0; !each.internal() && each.sends && n < each.channels; ++n)
      if (program_.channels[static_cast<std::size_t>(each.channel) + n].urgent) return "there are urgent channels";
  return nullptr;
}

bool Judge::satisfied(const Atom& atom) const {
  const Wide left = atom.left == 0 ? 0 : now_ - zero_[atom.left];
  const Wide right = atom.right == 0 ? 0 : now_ - zero_[atom.right];
  const Wide bound = Wide{zones::raw_value(atom.raw)} * unit_;
  return (atom.raw & 1) == 0 ? left - right < bound : left - right <= bound;
}

bool Judge::holds(const program::Condition& condition) {
  required_.clear();
  return semantics_.holds(condition, required_) &&
         std::all_of(required_.begin(), required_.end(), [&](const Atom& atom) { return satisfied(atom); });
}

bool Judge::invariants() {
  required_.clear();
  return semantics_.invariants(required_) &&
         std::all_of(required_.begin(), required_.end(), [&](const Atom& atom) { return satisfied(atom); });
}

Verdict Judge::begin() { return invariants() ? nullptr : "the initial state violates an invariant"; }

Verdict Judge::wait(std::int64_t until) {
  if (until < now_) return "a delay cannot be negative";
  if (until == now_) return nullptr;
  if (!semantics_.waits()) return "time cannot pass in an urgent or committed location";
  now_ = until;
  // Invariants are conjunctions of difference constraints, hence convex: both ends are enough.
  return invariants() ? nullptr : "the delay violates an invariant";
}

bool Judge::receives(std::uint32_t number, std::int32_t channel) {
  const Edge& other = edge(number);
  return !other.internal() && !other.sends && other.may_name(channel) && holds(other.guard) &&
         semantics_.channel(other) == channel;
}

bool Judge::a_receiver_stays_out(EdgeNumbers edges, std::int32_t channel) {
  for (const std::uint32_t p : receivers_[static_cast<std::size_t>(channel)]) {
    if (std::any_of(edges.begin(), edges.end(), [&](std::uint32_t each) { return edge(each).process == p; })) continue;
    const auto& leaving = semantics_.leaving(p);
    if (std::any_of(leaving.begin(), leaving.end(), [&](std::uint32_t each) { return receives(each, channel); }))
      return true;
  }
  return false;
}

// True if edges begin where their processes are, and the committed rule admits them.
Verdict Judge::takes_part(EdgeNumbers edges) {
  int most = 0;
  for (std::size_t p = 0; p < program_.processes.size(); ++p)
    most = std::max(most, semantics_.location(p).commitment());
  bool admitted = false;
  for (const std::uint32_t each : edges) {
    const auto& leaving = semantics_.leaving(edge(each).process);
    if (std::find(leaving.begin(), leaving.end(), each) == leaving.end()) return "an edge begins elsewhere";
    admitted |= semantics_.location(edge(each).process).may_go(most);
  }
  return admitted ? nullptr : "another process is in a committed location";
}

Verdict Judge::synchronise(EdgeNumbers edges) {
  const Edge& sender = edge(edges.front());
  if (sender.internal()) return edges.size() == 1 ? nullptr : "an internal edge takes nobody along";
  if (!sender.sends) return "nobody sends";
  const std::int32_t channel = semantics_.channel(sender);
  const bool broadcast = program_.channels[static_cast<std::size_t>(channel)].broadcast;
  if (!broadcast && edges.size() != 2) return "a sender takes one receiver along";
  for (std::size_t n = 1; n < edges.size(); ++n) {
    const std::uint32_t process = edge(edges[n]).process;
    if (process == sender.process || (n > 1 && process <= edge(edges[n - 1]).process))
      return "receivers are not in the order of their processes";
    if (!receives(edges[n], channel)) return "a receiver cannot receive";
  }
  return broadcast && a_receiver_stays_out(edges, channel) ? "somebody who can receive a broadcast stays out" : nullptr;
}

Verdict Judge::fire(EdgeNumbers edges) {
  if (edges.empty()) return "nobody takes part";
  if (std::any_of(edges.begin(), edges.end(), [&](std::uint32_t each) { return each >= program_.edges.size(); }))
    return "there is no such edge";
  if (const Verdict wrong = takes_part(edges)) return wrong;
  if (!holds(edge(edges.front()).guard)) return "a guard is false";
  if (const Verdict wrong = synchronise(edges)) return wrong;
  resets_.clear();
  semantics_.take(edges, resets_);
  for (const ClockReset& reset : resets_)
    zero_[reset.clock] = (reset.source != 0 ? zero_[reset.source] : Wide{now_}) - Wide{reset.value} * unit_;
  return invariants() ? nullptr : "the transition violates an invariant";
}

bool Judge::reached(const Goal& goal) {
  return std::any_of(goal.disjuncts.begin(), goal.disjuncts.end(), [&](const program::Disjunct& disjunct) {
    return disjunct.deadlock == program::DeadlockLiteral::absent && holds(disjunct.condition);
  });
}

}  // namespace

std::optional<RunObjection> objection_to(const Program& program, const RunPath& path, const Moments& moments,
                                         const Goal& goal) {
  constexpr std::int64_t latest = std::int64_t{1} << 61;
  if (moments.ticks.size() != path.size() + 1) return RunObjection{0, "there is not one moment for each transition"};
  if (moments.unit < 1 || moments.unit > (std::int64_t{1} << 30) || moments.ticks.back() > latest)
    return RunObjection{0, "the times are too fine or too late to be judged"};
  Judge judge(program, moments.unit);
  if (const Verdict unknown = judge.unsupported()) return RunObjection{0, unknown};
  if (const Verdict wrong = judge.begin()) return RunObjection{0, wrong};
  for (std::size_t k = 0; k < path.size(); ++k) {
    Verdict wrong = judge.wait(moments.ticks[k]);
    if (wrong == nullptr) wrong = judge.fire(path[k]);
    if (wrong != nullptr) return RunObjection{k + 1, wrong};
  }
  if (const Verdict wrong = judge.wait(moments.ticks.back())) return RunObjection{path.size() + 1, wrong};
  if (!judge.reached(goal)) return RunObjection{path.size() + 1, "the goal does not hold at the end"};
  return std::nullopt;
}

}  // namespace tachk::runs
