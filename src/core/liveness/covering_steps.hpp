// The steps of a search through all states: from each state that was expanded to the stored ones that cover its
// successors. They take about two bytes a step, and four a state.
#pragma once

#include <cstdint>
#include <vector>

#include "states/store.hpp"

namespace tachk::liveness {

class CoveringSteps final {
 public:
  using State = std::uint32_t;

  // The steps from one state, in the order in which they were added.
  class Reader final {
   public:
    // True if there is one more, which is then in `target`.
    bool next(State& target);

   private:
    friend class CoveringSteps;
    Reader(const CoveringSteps& steps, std::uint64_t place, State source)
        : steps_(&steps), place_(place), last_(source) {}

    const CoveringSteps* steps_;
    std::uint64_t place_;
    State last_;
  };

  // The steps that are added next leave this state; states come with growing numbers. states::no_node: the initial
  // states, which come first.
  void begin(State source);
  void add(State target);
  // No more steps leave it.
  void end() { write(0); }
  // A state that is stored now covers another one.
  void cover(State covered, State by);

  // What leaves a state that is not covered and has been expanded.
  Reader from(State source) const { return {*this, bases_[source >> group] + links_[source], source}; }
  // The initial states.
  Reader initial() const { return {*this, 0, 0}; }
  // The state that covers this one in the end, or itself.
  State uncovered(const states::PassedList& states, State state);

  std::size_t bytes() const { return blocks_.size() * block_bytes + (links_.capacity() + bases_.capacity() * 2) * 4; }

 private:
  static constexpr std::size_t block_bytes = std::size_t{1} << 16;
  static constexpr unsigned group = 10;  // the states of 2^10 numbers share a base

  std::uint8_t byte(std::uint64_t place) const { return blocks_[place / block_bytes][place % block_bytes]; }
  void write(std::uint8_t byte);

  std::vector<std::vector<std::uint8_t>> blocks_;
  std::uint64_t size_ = 0;
  // Of a covered state the one that covers it; of another one the place of its steps, counted from the base of its
  // group.
  std::vector<std::uint32_t> links_;
  std::vector<std::uint64_t> bases_;
  State last_ = 0;
};

}  // namespace tachk::liveness
