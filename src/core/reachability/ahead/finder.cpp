#include "reachability/ahead/finder.hpp"

#include <cstring>

namespace tachk {

Finder::Finder(const ZoneGraph& graph, const PassedList& passed, bool subsumption, std::uint32_t number)
    : passed_(passed),
      subsumption_(subsumption),
      number_(number),
      graph_(graph),
      goals_(graph_.program(), graph_.semantics(), graph_.operations(), false),
      deadlocks_(graph_, goals_),
      reader_(passed.reader()),
      source_(graph_.blank()) {}

void Finder::begin(const GoalWatch& goals, const std::vector<std::uint8_t>& taken) {
  goals_.follow(goals);
  taken_ = &taken;
  zones_used_ = 0;
  slots_.clear();
  found_.clear();
  edges_.clear();
  expansions_.clear();
}

// Keeps the successors that no stored state covers.
struct Finder::Receiving {
  Finder& finder;
  Expansion& expansion;
  std::uint32_t discrete = HashIndex::absent;
  std::uint32_t slots = 0;
  std::uint32_t zone = 0;
  bool further = false;

  bool counts() const { return finder.deadlocks_.counts(); }
  void possible(ConstZoneRef guarded, const Effect& effect) const { finder.deadlocks_.pass(guarded, effect); }
  void expect(const Effect& effect) const {
    finder.passed_.announce(effect.slots.data(), effect.written, finder.reader_);
  }
  bool wants(const Successor& successor) {
    ++expansion.transitions;
    for (const std::uint32_t edge : successor.edges)
      if ((*finder.taken_)[edge] == 0) finder.edges_.emplace_back(edge, expansion.transitions);
    discrete = finder.passed_.locate(finder.reader_);
    if (finder.subsumption_ && discrete != HashIndex::absent &&
        finder.passed_.covers(discrete, finder.graph_.packed(successor.slots, successor.zone)))
      return false;
    further = false;
    slots = static_cast<std::uint32_t>(finder.slots_.size());
    finder.slots_.insert(finder.slots_.end(), successor.slots, successor.slots + finder.graph_.program().state_slots);
    zone = finder.keep(successor.zone);
    return true;
  }
  void take(const Successor& successor) {
    const ConstZoneRef found = finder.zones_[zone].get();
    const bool same = std::memcmp(found.bytes, successor.zone.bytes, finder.graph_.operations().bytes) == 0;
    finder.found_.push_back({.discrete = discrete,
                             .slots = slots,
                             .zone = zone,
                             .abstract = same ? zone : finder.keep(successor.zone),
                             .transitions = expansion.transitions,
                             .finder = finder.number_,
                             .key = finder.passed_.key(finder.reader_),
                             .hash = 0,
                             .further = further,
                             .meets = true,
                             .apart = false});
    further = true;
    finder.look(finder.found_.back(), successor);
  }
};

std::uint32_t Finder::keep(ConstZoneRef zone) {
  if (zones_used_ == zones_.size()) zones_.emplace_back(graph_.operations());
  zones_[zones_used_].assign(zone);
  return static_cast<std::uint32_t>(zones_used_++);
}

void Finder::look(Found& found, const Successor& successor) {
  const ZoneView packed = graph_.packed(successor.slots, successor.zone);
  found.hash = passed_.hash(packed);
  // One of several pieces of a zone may be covered although the whole is not.
  const bool whole = graph_.program().diagonals.empty();
  found.apart = subsumption_ &&
                (found.discrete == HashIndex::absent ||
                 ((whole || !passed_.covers(found.discrete, packed)) && !passed_.would_cover(found.discrete, packed)));
  try {
    found.meets = goals_.meets_any(successor.slots, successor.zone);
  } catch (const ModelFault&) {  // the search will meet it as well
    found.meets = true;
  }
}

void Finder::expand(std::uint32_t number) {
  Expansion& expansion = expansions_.emplace_back();
  expansion.first = found_.size();
  expansion.first_edge = edges_.size();
  try {
    passed_.unpack(number, source_.slots.data(), reader_);
    graph_.unpack(passed_, number, source_);
    deadlocks_.begin(source_);
    graph_.expand(source_, Receiving{*this, expansion});
    deadlocks_.end(number, source_, expansion.stuck);
  } catch (...) {
    expansion.failure = std::current_exception();
  }
  expansion.last = found_.size();
  expansion.last_edge = edges_.size();
}

}  // namespace tachk
