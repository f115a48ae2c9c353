#include "reachability/passing.hpp"

#include <utility>

namespace tachk {

bool PassingStates::will_be_left(const std::int32_t* slots) const {
  std::size_t committed = 0;
  for (std::size_t process = 0; process < graph_.program().processes.size(); ++process)
    committed += graph_.semantics().location(process, slots).committed;
  return committed == 1;
}

bool PassingStates::next(SymbolicState& state) {
  if (waiting_.empty()) {
    actions_.clear();
    return false;
  }
  state = std::move(waiting_.back().state);
  actions_ = std::move(waiting_.back().actions);
  waiting_.pop_back();
  return true;
}

Path PassingStates::actions_to(const Successor& successor) const {
  Path actions = actions_;
  if (!successor.edges.empty()) actions.emplace_back(successor.edges.begin(), successor.edges.end());
  return actions;
}

}  // namespace tachk
