#include "reachability/ahead/finder.hpp"

#include <algorithm>
#include <cstring>

namespace tachk::reachability::ahead {

using states::HashIndex;
using symbolic::Effect;
using symbolic::Successor;
using zones::ConstZoneRef;

Finder::Finder(const symbolic::ZoneGraph& graph, const states::PassedList& passed, bool subsumption,
               std::uint32_t number)
    : passed_(passed),
      subsumption_(subsumption),
      whole_(graph.program().diagonals.empty()),
      number_(number),
      graph_(graph),
      goals_(graph_.program(), graph_.semantics(), graph_.operations(), false),
      deadlocks_(graph_, goals_),
      reader_(passed.reader()),
      source_(graph_.blank()),
      latest_(places) {}

void Finder::begin(const GoalWatch& goals, const std::vector<std::uint8_t>& taken) {
  if (goals_then_ != goals.changes()) early_.done = 0;
  now_ = 1 - now_;
  if (early_.done == 0) now().clear();
  goals_.follow(goals);
  deadlocks_.look_again();
  goals_then_ = goals.changes();
  taken_ = taken;
  std::fill(latest_.begin(), latest_.end(), Found::none);
}

// Keeps the successors that no stored state covers.
struct Finder::Receiving {
  Finder& finder;
  Expansion& expansion;
  Found found{};

  bool counts() const { return finder.deadlocks_.counts(); }
  void possible(ConstZoneRef guarded, const Effect& effect) const { finder.deadlocks_.pass(guarded, effect); }
  void expect(const Effect& effect) const {
    finder.passed_.announce(effect.slots.data(), effect.written, finder.reader_);
  }
  bool wants(const Successor& successor) {
    finder.count(successor.edges, expansion, finder.now());
    if (!is_new(successor)) return false;
    found.slots = finder.now().keep(successor.slots, finder.graph_.program().state_slots);
    found.zone = finder.now().keep(successor.zone, finder.graph_.operations());
    return !covered();
  }
  // Whether no stored state covers the successor that was announced.
  bool is_new(const Successor& successor) {
    found = {.discrete = finder.passed_.locate(finder.reader_),
             .slots = 0,
             .zone = 0,
             .abstract = Found::none,
             .transitions = expansion.transitions,
             .finder = finder.number_,
             .key = finder.passed_.key(finder.reader_)};
    return !finder.subsumption_ || found.discrete == HashIndex::absent ||
           !finder.passed_.covers(found.discrete, finder.graph_.packed(successor.slots, successor.zone));
  }
  // Whether one that was found before does.
  bool covered() {
    if (!finder.subsumption_ || !finder.whole_) return false;
    found.own_coverer = finder.own_coverer(found);
    if (found.own_coverer == Found::none) return false;
    finder.now().found.push_back(found);
    return true;
  }
  void take(const Successor& successor) {
    Harvest& harvest = finder.now();
    const bool same =
        std::memcmp(harvest.zone(found.zone).bytes, successor.zone.bytes, finder.graph_.operations().bytes) == 0;
    found.abstract = same ? found.zone : harvest.keep(successor.zone, finder.graph_.operations());
    finder.look(found, successor);
    finder.latest_[found.key % places] = static_cast<std::uint32_t>(harvest.found.size());
    harvest.found.push_back(found);
    found.further = true;
  }
};

// Keeps all steps.
struct Finder::Stepping {
  Finder& finder;
  Expansion& expansion;
  program::SlotSet written{};

  bool counts() const { return finder.deadlocks_.counts(); }
  void possible(ConstZoneRef guarded, const Effect& effect) const { finder.deadlocks_.pass(guarded, effect); }
  void expect(const Effect& effect) { written = effect.written; }
  bool wants(const Successor& successor) {
    Harvest& harvest = finder.next();
    finder.count(successor.edges, expansion, harvest);
    harvest.steps.push_back({harvest.keep(successor.slots, finder.graph_.program().state_slots),
                             harvest.keep(successor.zone, finder.graph_.operations()), expansion.transitions, written});
    return false;
  }
  void take(const Successor&) const {}
};

void Finder::count(std::span<const std::uint32_t> edges, Expansion& expansion, Harvest& harvest) const {
  ++expansion.transitions;
  for (const std::uint32_t edge : edges)
    if (taken_[edge] == 0) harvest.edges.emplace_back(edge, expansion.transitions);
}

std::uint32_t Finder::own_coverer(const Found& found) const {
  const std::uint32_t latest = latest_[found.key % places];
  if (latest == Found::none) return Found::none;
  const Harvest& harvest = now();
  const Found& other = harvest.found[latest];
  if (other.key != found.key || other.discrete != found.discrete) return Found::none;
  const std::int32_t* slots = harvest.slots(found.slots);
  if (found.discrete == HashIndex::absent &&
      !std::equal(slots, slots + graph_.program().state_slots, harvest.slots(other.slots)))
    return Found::none;
  const bool covers = graph_.operations().includes(harvest.zone(other.abstract), harvest.zone(found.zone),
                                                   graph_.program().dimension());
  return covers ? latest : Found::none;
}

void Finder::look(Found& found, const Successor& successor) {
  const states::ZoneView packed = graph_.packed(successor.slots, successor.zone);
  found.hash = passed_.hash(packed);
  // One of several pieces of a zone may be covered although the whole is not.
  found.apart = subsumption_ &&
                (found.discrete == HashIndex::absent ||
                 ((whole_ || !passed_.covers(found.discrete, packed)) && !passed_.would_cover(found.discrete, packed)));
  try {
    found.meets = goals_.meets_any(successor.slots, successor.zone);
  } catch (const machine::ModelFault&) {  // the search will meet it as well
    found.meets = true;
  }
}

template <class R>
void Finder::expand(symbolic::SymbolicState& source, std::uint32_t node, Harvest& harvest, Expansion& expansion,
                    R&& receiver) {
  expansion.first_edge = harvest.edges.size();
  try {
    deadlocks_.begin(node, source);
    graph_.expand(source, receiver);
    deadlocks_.end(node, source, expansion.stuck);
  } catch (...) {
    expansion.failure = std::current_exception();
  }
  expansion.last_edge = harvest.edges.size();
  expansion.alone = goals_.changes() != goals_then_;
}

void Finder::expand(std::uint32_t node) {
  Expansion& expansion = now().expansions.emplace_back();
  expansion.first = now().found.size();
  passed_.unpack(node, source_.slots.data(), reader_);
  graph_.unpack(passed_, node, source_);
  expand(source_, node, now(), expansion, Receiving{*this, expansion});
  expansion.last = now().found.size();
}

// ---- early ----------------------------------------------------------------------------------------------------------

void Finder::note(std::span<const std::uint32_t> nodes) {
  early_.nodes.assign(nodes.begin(), nodes.end());
  while (early_.sources.size() < early_.nodes.size()) early_.sources.push_back(graph_.blank());
  for (std::size_t n = 0; n < early_.nodes.size(); ++n) {
    passed_.unpack(early_.nodes[n], early_.sources[n].slots.data(), reader_);
    graph_.unpack(passed_, early_.nodes[n], early_.sources[n]);
  }
  early_.done = 0;
  early_.expansions.clear();
  next().clear();
}

bool Finder::expand_early() {
  if (early_.done == early_.nodes.size() || next().zones() * graph_.operations().bytes > most_bytes) return false;
  Expansion& expansion = early_.expansions.emplace_back();
  expansion.first = next().steps.size();
  expand(early_.sources[early_.done], early_.nodes[early_.done], next(), expansion, Stepping{*this, expansion});
  expansion.last = next().steps.size();
  ++early_.done;
  return true;
}

void Finder::look_up(std::size_t early) {
  Expansion& expansion = now().expansions.emplace_back(std::move(early_.expansions[early]));
  const std::size_t last = expansion.last;
  const std::uint32_t transitions = expansion.transitions;
  const std::size_t first_found = now().found.size();
  passed_.unpack(early_.nodes[early], source_.slots.data(), reader_);
  const bool sorted = graph_.representatives().active();  // and abstracted
  Receiving receiving{*this, expansion};
  for (std::size_t n = expansion.first; n < last; ++n) {
    const Step step = now().steps[n];
    std::int32_t* slots = source_.slots.data();
    std::copy_n(now().slots(step.slots), graph_.program().state_slots, slots);
    passed_.announce(slots, step.written, reader_);
    expansion.transitions = step.transitions;
    const Successor successor{{}, slots, now().zone(step.zone)};
    if (!receiving.is_new(successor)) continue;
    receiving.found.slots = step.slots;
    receiving.found.zone = step.zone;
    if (receiving.covered()) continue;
    source_.zone.assign(successor.zone);
    if (sorted)
      receiving.take({{}, slots, source_.zone.get()});
    else
      graph_.abstract(slots, source_.zone, [&](ConstZoneRef zone) { receiving.take({{}, slots, zone}); });
  }
  expansion.transitions = transitions;
  expansion.first = first_found;
  expansion.last = now().found.size();
}

}  // namespace tachk::reachability::ahead
