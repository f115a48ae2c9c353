#include "runs/schedule.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "runs/concrete_semantics.hpp"

namespace tachk::runs {

using program::Goal;
using program::Program;
using zones::Atom;
using zones::ClockReset;
using zones::Raw;

namespace {

constexpr int infinitesimal_bits = 31;
constexpr Raw largest_bound = Raw{1} << 30;
constexpr std::size_t most_visits = 1000;  // of all moments, on average

// moment `to` - moment `from` >= weight.
struct Arc {
  std::size_t from;
  std::size_t to;
  std::int64_t weight;
};

// Moment 0 is the start, moment k the k-th transition, the last one is the end.
class Schedule {
 public:
  Schedule(const Program& program, const RunPath& path)
      : path_(path), semantics_(program), set_(static_cast<std::size_t>(program.dimension()), Set{0, 0}) {
    for (const ClockReset& start : program.starts) set_[start.clock].value = start.value;
  }

  // Collects what has to hold. False if that is impossible, or too large to compute with.
  bool collect(const Program& program, const Goal& goal);
  // The least moments; nothing if there are none or they take too long.
  std::optional<std::vector<std::int64_t>> least(std::size_t moments);

 private:
  struct Set {
    std::size_t moment;  // when a clock was set last
    std::int64_t value;  // to this
  };

  bool require(std::size_t now);
  bool require(const Atom& atom, std::size_t now);

  const RunPath& path_;
  ConcreteSemantics semantics_;
  std::vector<Set> set_;
  std::vector<Atom> required_;
  std::vector<Arc> arcs_;
};

// A clock is `now - moment of its reset + value`; without a clock there is `now - now + 0`.
bool Schedule::require(const Atom& atom, std::size_t now) {
  const Set left = atom.left != 0 ? set_[atom.left] : Set{now, 0};
  const Set right = atom.right != 0 ? set_[atom.right] : Set{now, 0};
  const Raw bound = zones::raw_value(atom.raw) - (left.value - right.value);
  if (bound >= largest_bound) return true;
  if (bound <= -largest_bound) return false;
  const std::int64_t weight = -bound * (std::int64_t{1} << infinitesimal_bits) + ((atom.raw & 1) == 0 ? 1 : 0);
  // right.moment - left.moment <= bound
  if (left.moment == right.moment) return weight <= 0;
  arcs_.push_back({right.moment, left.moment, weight});
  return true;
}

bool Schedule::require(std::size_t now) {
  return std::all_of(required_.begin(), required_.end(), [&](const Atom& atom) { return require(atom, now); });
}

bool Schedule::collect(const Program& program, const Goal& goal) {
  std::vector<ClockReset> resets;
  for (std::size_t k = 0;; ++k) {
    required_.clear();
    if (!semantics_.invariants(required_) || !require(k) || !require(k + 1)) return false;
    arcs_.push_back({k, k + 1, 0});
    if (!semantics_.waits()) arcs_.push_back({k + 1, k, 0});
    required_.clear();
    if (k == path_.size()) break;
    for (const std::uint32_t edge : path_[k])
      if (!semantics_.holds(program.edges[edge].guard, required_)) return false;
    if (!require(k + 1)) return false;
    resets.clear();
    semantics_.take(path_[k], resets);
    for (const ClockReset& reset : resets) {
      const Set copied = reset.source != 0 ? set_[reset.source] : Set{k + 1, 0};
      set_[reset.clock] = {copied.moment, copied.value + reset.value};
    }
  }
  const bool reached =
      std::any_of(goal.disjuncts.begin(), goal.disjuncts.end(), [&](const program::Disjunct& disjunct) {
        required_.clear();
        return disjunct.deadlock == program::DeadlockLiteral::absent && semantics_.holds(disjunct.condition, required_);
      });
  return reached && require(path_.size() + 1);
}

// Moments that were raised wait until their turn, the first of them next: most constraints look a little back.
std::optional<std::vector<std::int64_t>> Schedule::least(std::size_t moments) {
  std::vector<std::size_t> first(moments + 1, 0);
  for (const Arc& arc : arcs_) ++first[arc.from + 1];
  for (std::size_t k = 0; k < moments; ++k) first[k + 1] += first[k];
  std::vector<std::pair<std::size_t, std::int64_t>> targets(arcs_.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (const Arc& arc : arcs_) targets[next[arc.from]++] = {arc.to, arc.weight};

  std::vector<std::int64_t> found(moments, 0);
  std::vector<char> raised(moments, 1);
  std::size_t visits = 0;
  for (std::size_t k = 0; k < moments;) {
    if (raised[k] == 0) {
      ++k;
      continue;
    }
    if (++visits > most_visits * moments) return std::nullopt;
    raised[k] = 0;
    std::size_t turn = k + 1;
    for (std::size_t n = first[k]; n < first[k + 1]; ++n) {
      const auto [to, weight] = targets[n];
      if (found[k] + weight <= found[to]) continue;
      if (to == 0 || found[k] + weight > (largest_bound << infinitesimal_bits)) return std::nullopt;
      found[to] = found[k] + weight;
      raised[to] = 1;
      turn = std::min(turn, to);
    }
    k = turn;
  }
  return found;
}

}  // namespace

std::optional<Moments> earliest_moments(const Program& program, const RunPath& path, const Goal& goal) {
  if (program.has_stopwatches || path.size() >= (std::size_t{1} << infinitesimal_bits) / 2) return std::nullopt;
  Schedule schedule(program, path);
  if (!schedule.collect(program, goal)) return std::nullopt;
  const auto found = schedule.least(path.size() + 2);
  if (!found) return std::nullopt;
  // Infinitesimals become so small that no two moments swap places.
  constexpr std::int64_t mask = (std::int64_t{1} << infinitesimal_bits) - 1;
  Moments result;
  for (const std::int64_t moment : *found) result.unit = std::max(result.unit, 1 + (moment & mask));
  for (std::size_t k = 1; k < found->size(); ++k)
    result.ticks.push_back(((*found)[k] >> infinitesimal_bits) * result.unit + ((*found)[k] & mask));
  return result;
}

}  // namespace tachk::runs
