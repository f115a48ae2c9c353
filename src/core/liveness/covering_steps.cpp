#include "liveness/covering_steps.hpp"

#include <utility>

namespace tachk::liveness {

using states::no_node;

// A step is the difference of its target to the one before, with the sign in the lowest bit, plus 1: in groups of seven
// bits, the lowest first, the eighth bit for all but the last. 0 stands behind the last step.

bool CoveringSteps::Reader::next(State& target) {
  std::uint64_t value = 0;
  unsigned shift = 0;
  std::uint8_t byte;
  do {
    byte = steps_->byte(place_++);
    value |= std::uint64_t{byte & 0x7fU} << shift;
    shift += 7;
  } while (byte >= 0x80);
  if (value-- == 0) return false;
  const std::uint32_t distance = static_cast<std::uint32_t>(value >> 1);
  last_ = (value & 1) != 0 ? last_ - distance : last_ + distance;
  target = last_;
  return true;
}

void CoveringSteps::write(std::uint8_t byte) {
  if (size_ % block_bytes == 0) blocks_.emplace_back(block_bytes);
  blocks_.back()[size_++ % block_bytes] = byte;
}

void CoveringSteps::begin(State source) {
  last_ = source == no_node ? 0 : source;
  if (source == no_node) return;
  if (links_.size() <= source) links_.resize(std::size_t{source} + 1);
  while (bases_.size() <= source >> group) bases_.push_back(size_);
  links_[source] = static_cast<std::uint32_t>(size_ - bases_[source >> group]);
}

void CoveringSteps::add(State target) {
  const std::uint32_t distance = target < last_ ? last_ - target : target - last_;
  std::uint64_t value = (std::uint64_t{distance} << 1 | (target < last_ ? 1U : 0U)) + 1;
  for (; value >= 0x80; value >>= 7) write(static_cast<std::uint8_t>(value | 0x80));
  write(static_cast<std::uint8_t>(value));
  last_ = target;
}

void CoveringSteps::cover(State covered, State by) {
  if (links_.size() <= covered) links_.resize(std::size_t{covered} + 1);
  links_[covered] = by;
}

CoveringSteps::State CoveringSteps::uncovered(const states::PassedList& states, State state) {
  State last = state;
  while (states.covered(last)) last = links_[last];
  while (state != last) state = std::exchange(links_[state], last);
  return last;
}

}  // namespace tachk::liveness
