#include "reachability/passing.hpp"

#include <utility>

namespace tachk::reachability {

bool PassingStates::will_be_left(const std::int32_t* slots) const {
  std::size_t committed = 0;
  for (std::size_t process = 0; process < graph_.program().processes.size(); ++process)
    committed += graph_.semantics().location(process, slots).committed;
  return committed == 1;
}

void PassingStates::add(const symbolic::Successor& successor) {
  const std::size_t slots = graph_.program().state_slots * sizeof(std::int32_t);
  std::string key(reinterpret_cast<const char*>(successor.slots), slots);
  key.append(reinterpret_cast<const char*>(successor.zone.bytes), graph_.operations().bytes);
  bytes_each_ = 2 * key.size();  // the state that waits has as much, until it is its turn
  const auto [known, is_new] = seen_.try_emplace(std::move(key), actions_.size());
  if (!is_new && known->second <= actions_.size()) return;
  known->second = actions_.size();
  waiting_.push_back({graph_.copy(successor), actions_to(successor)});
}

bool PassingStates::next(symbolic::SymbolicState& state) {
  if (waiting_.empty()) {
    actions_.clear();
    return false;
  }
  state = std::move(waiting_.back().state);
  actions_ = std::move(waiting_.back().actions);
  waiting_.pop_back();
  return true;
}

symbolic::Path PassingStates::actions_to(const symbolic::Successor& successor) const {
  symbolic::Path actions = actions_;
  if (!successor.edges.empty()) actions.emplace_back(successor.edges.begin(), successor.edges.end());
  return actions;
}

}  // namespace tachk::reachability
