// Strongly connected components of a graph that is gone through depth first, known while they grow, each with marks
// that its states have (J.-M. Couvreur, "On-the-fly verification of linear temporal logic", FM 1999).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tachk::liveness {

class Components final {
 public:
  using State = std::uint32_t;
  using Marks = std::uint64_t;

  // A state more, which has not been entered.
  void add(Marks marks) { states_.push_back({0, marks}); }
  Marks marks(State state) const { return states_[state].marks; }
  bool is_new(State state) const { return states_[state].order == 0; }
  bool is_finished(State state) const { return states_[state].order == finished; }

  // A state is a component of its own when it is entered.
  void enter(State state) {
    states_[state].order = ++count_;
    members_.push_back(state);
    growing_.push_back({count_, states_[state].marks});
  }

  // The state on top of the path leads to this one, which is not finished: all that was entered since then is one
  // component. Its marks.
  Marks join(State state) {
    Marks marks = 0;
    while (growing_.back().order > states_[state].order) {
      marks |= growing_.back().marks;
      growing_.pop_back();
    }
    return growing_.back().marks |= marks;
  }

  // The state on top of the path has no more steps. If its component was entered by it, that is finished; calls
  // take(state) for each of its states.
  template <class Take>
  void leave(State state, Take&& take) {
    if (growing_.back().order != states_[state].order) return;
    growing_.pop_back();
    State member;
    do {
      member = members_.back();
      members_.pop_back();
      states_[member].order = finished;
      take(member);
    } while (member != state);
  }

  // True if a state belongs to the component that has grown last.
  bool is_in_newest(State state) const { return !is_finished(state) && states_[state].order >= growing_.back().order; }

  std::size_t bytes() const {
    return states_.capacity() * sizeof(Entry) + members_.capacity() * sizeof(State) +
           growing_.capacity() * sizeof(Component);
  }

 private:
  static constexpr std::uint32_t finished = UINT32_MAX;

  struct Entry {
    std::uint32_t order;  // in which states were entered, from 1 on; 0: not yet
    Marks marks;
  };
  struct Component {
    std::uint32_t order;  // of the state by which it was entered
    Marks marks;
  };

  std::vector<Entry> states_;
  std::vector<State> members_;  // of components that grow
  std::vector<Component> growing_;
  std::uint32_t count_ = 0;
};

}  // namespace tachk::liveness
