#include "order/by_progress.hpp"

namespace tachk::order {

void ByProgress::start(const Beginning& at) {
  states::PassedList& states = at.states;
  std::vector<std::int32_t> before(at.program.slots.size());
  std::vector<std::int32_t> after(at.program.slots.size());
  std::vector<std::uint32_t> far_of;  // of each state
  for (std::uint32_t number = 0; number < states.size(); ++number) {
    const std::uint32_t parent = states.parent(number);
    std::uint32_t far = 0;
    if (parent != states::no_node) {
      states.unpack(parent, before.data());
      states.unpack(number, after.data());
      far = beyond(far_of[parent], progress_.between(before.data(), after.data()));
    }
    far_of.push_back(far);
    if (number >= at.first && !states.covered(number)) waiting_.add(number, far);
  }
}

}  // namespace tachk::order
