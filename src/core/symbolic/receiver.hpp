// Receivers of the successors of a state, and one type for all of them: the zone graph is compiled once, not for each
// search.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include "symbolic/successor.hpp"
#include "zones/zone.hpp"

namespace tachk::symbolic {

// A step to a symbolic state, valid during the call that passes it.
struct Successor {
  std::span<const std::uint32_t> edges;  // of the action; none for an initial state
  std::int32_t* slots;
  zones::ConstZoneRef zone;
};

// The receiver of the successors of a state. Where processes are interchangeable, actions that differ by a permutation
// that leaves the state as it is have successors that do, too: the graph reports one of them in full, of the others at
// most that they are possible. For each action it calls these functions of the receiver, in this order:
//   counts()                   optional, called first: whether the receiver needs `possible` for every action
//   admits(edges)              optional: whether the action is followed at all; if not, no other call is made for it
//   possible(guarded, effect)  the action breaks no integer part of an invariant; `guarded`: where its guard holds
//   expect(effect)             the zone of a successor is going to be computed
//   enters(entry, invariant)   optional: whether the step goes on from here, where no time has passed yet; if not, the
//                              receiver has dealt with it. Processes are not sorted yet: `ZoneGraph::sorted` does that
//                              for a receiver that takes parts of what it is given here
//   wants(successor)           whether this successor is of interest; its zone is not abstracted yet, because most
//                              successors end here
//   take(successor)            the successor, abstracted
template <class R>
concept Receiver =
    requires(R& receiver, zones::ConstZoneRef guarded, const Effect& effect, const Successor& successor) {
      receiver.possible(guarded, effect);
      receiver.expect(effect);
      { receiver.wants(successor) } -> std::same_as<bool>;
      receiver.take(successor);
    };

// Any receiver, as the zone graph sees it.
class ReceiverOfSuccessors {
 public:
  virtual bool counts() = 0;
  virtual bool admits(const Edges& edges) = 0;
  virtual void possible(zones::ConstZoneRef guarded, const Effect& effect) = 0;
  virtual void expect(const Effect& effect) = 0;
  virtual bool enters(const Successor& entry, const std::vector<zones::Atom>& invariant) = 0;
  virtual bool wants(const Successor& successor) = 0;
  virtual void take(const Successor& successor) = 0;

 protected:
  ~ReceiverOfSuccessors() = default;
};

// A receiver during a call. Where it lacks an optional function, every action is followed to its end.
template <Receiver R>
class ReceiverReference final : public ReceiverOfSuccessors {
 public:
  explicit ReceiverReference(R& receiver) : receiver_(receiver) {}

  bool counts() override {
    if constexpr (requires { receiver_.counts(); }) return receiver_.counts();
    return true;
  }
  bool admits([[maybe_unused]] const Edges& edges) override {
    if constexpr (requires { receiver_.admits(edges); }) return receiver_.admits(edges);
    return true;
  }
  void possible(zones::ConstZoneRef guarded, const Effect& effect) override { receiver_.possible(guarded, effect); }
  void expect(const Effect& effect) override { receiver_.expect(effect); }
  bool enters([[maybe_unused]] const Successor& entry,
              [[maybe_unused]] const std::vector<zones::Atom>& invariant) override {
    if constexpr (requires { receiver_.enters(entry, invariant); }) return receiver_.enters(entry, invariant);
    return true;
  }
  bool wants(const Successor& successor) override { return receiver_.wants(successor); }
  void take(const Successor& successor) override { receiver_.take(successor); }

 private:
  R& receiver_;
};

}  // namespace tachk::symbolic
