// The zone graph over local times: the successors of a state do not depend on the order in which independent actions
// have led to it.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "localtime/agents.hpp"
#include "localtime/local_symmetry.hpp"
#include "localtime/local_zone.hpp"
#include "program/program.hpp"
#include "reachability/options.hpp"
#include "symbolic/successor.hpp"
#include "symbolic/zone_graph.hpp"
#include "zones/patience.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::localtime {

// A step to a state, valid during the call that passes it.
struct LocalSuccessor {
  const symbolic::Edges& edges;  // of the action; none for the initial state
  symbolic::Effect& effect;
  const std::vector<LocalEntry>& zone;
  zones::ZoneBuffer& synchronised;  // the states of the network in it; to be used up
};

class LocalGraph final {
 public:
  // Throws std::invalid_argument where `find_agents` finds an obstacle, and without extrapolation.
  LocalGraph(program::Program program, const reachability::Options& options);
  LocalGraph(const LocalGraph&) = delete;
  LocalGraph& operator=(const LocalGraph&) = delete;

  const program::Program& program() const { return ordinary_.program(); }
  const Agents& agents() const { return agents_; }
  const LocalZones& zones() const { return zones_; }
  // The graph of the same network, to which the synchronised states belong.
  symbolic::ZoneGraph& ordinary() { return ordinary_; }
  // Where processes are interchangeable, successors have them sorted.
  LocalSymmetry& symmetry() { return symmetry_; }

  // Calls take(successor) for the initial state. Throws ModelFault, ConstantOverflow.
  template <class Take>
  void start(Take&& take) {
    if (!begin() || !synchronise()) return;
    if (symmetry_.active()) symmetry_.sort(effect_.slots.data(), synchronised_, target_);
    take(LocalSuccessor{no_edges_, effect_, target_, synchronised_});
  }

  // For each successor of a state in which all agents may have the same time: calls expect(effect) before its zone is
  // computed, unless that is needed to sort it, and take(successor). Throws ModelFault, ConstantOverflow.
  template <class Expect, class Take>
  void expand(std::int32_t* slots, const std::vector<LocalEntry>& zone, Expect&& expect, Take&& take) {
    // The guards of an action are looked at when its processes have met: here anything may hold.
    symbolic::Semantics& semantics = ordinary_.semantics();
    semantics.for_each_action(slots, anything_.get(), [&](const symbolic::Action& action, zones::ConstZoneRef) {
      target_ = zone;
      zones::Patience::check();  // an action takes the time of many looks
      if (!fire(action) || !semantics.apply(action.edges, slots, effect_)) return;
      const bool sorts = symmetry_.active();
      if (!sorts) expect(std::as_const(effect_));
      if (!enter() || !synchronise()) return;
      if (sorts) {
        symmetry_.sort(effect_.slots.data(), synchronised_, target_);
        effect_.written = program::SlotSet::all();
        expect(std::as_const(effect_));
      }
      take(LocalSuccessor{action.edges, effect_, target_, synchronised_});
    });
  }

 private:
  bool begin();
  // Brings the processes of an action together in `target_`, where its guard holds; false if nothing is left.
  bool fire(const symbolic::Action& action);
  // Resets clocks and lets the times of those who have met pass, within the invariant; false if nothing is left.
  bool enter();
  bool constrain(std::span<const zones::Atom> atoms);
  // Sets `synchronised_`; false if there is no time that all can have.
  bool synchronise();

  symbolic::ZoneGraph ordinary_;
  Agents agents_;
  LocalZones zones_;
  LocalSymmetry symmetry_;
  zones::ZoneBuffer anything_;  // all values of the clocks
  symbolic::Edges no_edges_;
  std::vector<std::uint32_t> met_;  // the agents of the action
  symbolic::Effect effect_;
  std::vector<LocalEntry> target_;
  std::vector<LocalEntry> clocks_;
  zones::ZoneBuffer synchronised_;
};

}  // namespace tachk::localtime
