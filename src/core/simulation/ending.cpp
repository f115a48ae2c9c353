// What is known of a run behind its end.
#include <algorithm>

#include "simulation/simulator.hpp"

namespace tachk::simulation {

// A tick may be too long: where x < 5 ends time, some passes at each moment before 5.
bool Simulator::time_passes() {
  machine_.draw_from(&random_);  // this may be a copy of another simulator
  if (frozen()) return false;
  for (std::size_t p = 0; p < processes(); ++p) {
    const Station& here = place(p);
    if (!here.outlook.has_invariant) continue;
    const program::Condition& invariant = here.location->invariant;
    if (clock_window(invariant, 1).last <= now_) return false;
    if (!invariant.flow.empty() && end_of(invariant, now_ + 1) <= now_) return false;
  }
  return true;
}

void Simulator::retreat() {
  if (!change_.under_way) return;
  undo();
  state_.committed = 0;
  state_.urgent = 0;
  for (std::size_t p = 0; p < processes(); ++p) {
    look_from(p);
    state_.committed += outlooks_[p].committed ? 1 : 0;
    state_.urgent += outlooks_[p].urgent ? 1 : 0;
  }
}

}  // namespace tachk::simulation
