#include "reachability/ahead/finder.hpp"

#include <algorithm>

namespace tachk {

Finder::Finder(const ZoneGraph& graph, const PassedList& passed, std::uint32_t number)
    : passed_(passed),
      number_(number),
      graph_(graph),
      goals_(graph_.program(), graph_.semantics(), graph_.operations(), false),
      deadlocks_(graph_, goals_),
      measures_(graph_.program(), graph_.semantics(), graph_.operations()),
      reader_(passed.reader()),
      source_(graph_.blank()),
      latest_(places) {
  harvest_.shares.resize(passed.shares());
}

void Finder::begin(const GoalWatch& goals, const std::vector<std::uint8_t>& taken, const Manner& manner) {
  harvest_.clear();
  goals_.follow(goals);
  taken_ = taken;
  manner_ = manner;
  has_unknown_ = false;
  std::fill(latest_.begin(), latest_.end(), none);
}

// Keeps the successors that no stored state covers.
struct Finder::Receiving {
  Finder& finder;
  Expansion& expansion;
  std::uint64_t place;

  bool counts() const { return finder.deadlocks_.counts(); }
  void possible(ConstZoneRef guarded, const Effect& effect) const { finder.deadlocks_.pass(guarded, effect); }
  void expect(const Effect& effect) const {
    finder.passed_.announce(effect.slots.data(), effect.written, finder.reader_);
  }
  bool wants(const Successor& successor) {
    ++expansion.transitions;
    for (const std::uint32_t edge : successor.edges)
      if (finder.taken_[edge] == 0) finder.harvest_.edges.push_back(edge);
    const DiscreteStates::Reader& reader = finder.reader_;
    const std::uint32_t discrete = finder.passed_.locate(reader);
    std::uint32_t coverer = no_node;
    if (finder.manner_.subsumption) {
      if (discrete != HashIndex::absent)
        coverer = finder.passed_.coverer(discrete, finder.graph_.packed(successor.slots, successor.zone));
      // What simulates a state may be removed for what simulates that, and then it matters which one does.
      if (!finder.manner_.simulation && (coverer != no_node || finder.covers_itself(discrete, successor.zone)))
        return false;
    }
    keep(successor, discrete, coverer);
    // Otherwise it is abstracted only if it is stored.
    return finder.graph_.may_overflow() || !finder.graph_.program().measures.empty() ||
           finder.goals_.may_meet_any(successor.slots);
  }
  void take(const Successor& successor) {
    finder.measures_.check(0, successor.slots, successor.zone);
    expansion.eventful |= finder.goals_.meets_any(successor.slots, successor.zone);
  }

 private:
  void keep(const Successor& successor, std::uint32_t discrete, std::uint32_t coverer) const {
    Harvest& harvest = finder.harvest_;
    const DiscreteStates::Reader& reader = finder.reader_;
    const Program& program = finder.graph_.program();
    const bool all = finder.manner_.slots || !reader.possible;
    const auto number = static_cast<std::uint32_t>(harvest.found.size());
    Found& found = harvest.found.emplace_back();
    found.order = place << 32 | number;
    found.hash = reader.hash;
    found.zone = harvest.keep(successor.zone, finder.graph_.operations().bytes);
    found.discrete = discrete;
    found.key = discrete == HashIndex::absent && reader.possible ? harvest.keep(reader.key) : 0;
    found.slots = harvest.keep(successor.slots, all ? program.state_slots : program.processes.size());
    found.coverer = coverer;
    found.known = reader.possible;
    finder.has_unknown_ |= !reader.possible;
    if (!reader.possible) return;
    harvest.shares[finder.share(found)].push_back(number);
    finder.latest_[reader.hash % places] = number;
  }
};

std::uint32_t Finder::share(const Found& found) const {
  return static_cast<std::uint32_t>(found.hash) & static_cast<std::uint32_t>(passed_.shares() - 1);
}

bool Finder::covers_itself(std::uint32_t discrete, ConstZoneRef zone) const {
  const std::uint32_t latest = latest_[reader_.hash % places];
  // What is stored of a zone that diagonals split are its pieces.
  if (latest == none || !reader_.possible || !graph_.program().diagonals.empty()) return false;
  const Found& other = harvest_.found[latest];
  if (other.hash != reader_.hash || other.discrete != discrete) return false;
  if (discrete == HashIndex::absent && !std::equal(reader_.key.begin(), reader_.key.end(), harvest_.key(other.key)))
    return false;
  return graph_.operations().includes(other.zone, zone, graph_.program().dimension());
}

void Finder::expand(std::uint32_t node, std::uint32_t place, Expansion& expansion) {
  expansion.finder = number_;
  expansion.transitions = 0;
  expansion.eventful = false;
  expansion.first_edge = harvest_.edges.size();
  passed_.unpack(node, source_.slots.data(), reader_);
  graph_.unpack(passed_, node, source_);
  try {
    deadlocks_.begin(source_);
    graph_.expand(source_, Receiving{*this, expansion, place});
    expansion.eventful |= deadlocks_.ends(node, source_);
  } catch (...) {  // the search will meet it as well
    expansion.eventful = true;
  }
  expansion.last_edge = harvest_.edges.size();
  expansion.done = true;
}

void Finder::divide() {
  for (std::vector<std::uint32_t>& share : harvest_.shares) share.clear();
  for (std::uint32_t n = 0; n < harvest_.found.size(); ++n) harvest_.shares[share(harvest_.found[n])].push_back(n);
}

}  // namespace tachk
