// The race of the processes: each draws the moment at which it acts, and the least one wins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "simulation/present.hpp"
#include "simulation/process_set.hpp"
#include "simulation/tournament.hpp"

namespace tachk::simulation {

enum class Wait : std::uint8_t {
  to_act,
  parked,     // nothing was possible when it was to act
  to_resume,  // what hybrid clocks allow is known up to here only
};

// When edges of a process can be taken: the first and the last moment, and the first one of urgent edges.
struct Openings {
  flow::Ticks first = flow::never;
  flow::Ticks last = -flow::never;
  flow::Ticks at_once = flow::never;

  void add(flow::Window window, bool urgent);
};

class Race {
 public:
  explicit Race(std::size_t processes) : due_(processes), limit_(processes), waits_(processes), parked_(processes) {}

  // Draws when the process acts if nothing changes, by its own guards: receivers are checked when the
  // moment has come. Without one it is parked: it waits for the next moment when a receiver may be there, and draws
  // again from there.
  void refresh(Present& present, std::size_t process);
  void park(Present& present, std::size_t process);
  // All draw anew, from what is left of their waits.
  void resume(Present& present);
  // Those that are parked are scheduled again, as something has changed.
  void refresh_parked(Present& present);

  // The moment of the next action that is drawn, and the one at which an invariant ends.
  std::pair<flow::Ticks, flow::Ticks> next_moments() const { return {due_.least(), limit_.least()}; }
  // The process that acts at the moment of the next action: drawn only when it has come, so that a run that is stopped
  // before and goes on is the same.
  std::size_t winner_at(flow::Ticks moment, Random& random) const;
  bool is_due(std::size_t process, flow::Ticks now) const {
    return due_[process] == now && waits_[process] != Wait::to_resume;
  }
  bool resumes(std::size_t process) const { return waits_[process] == Wait::to_resume; }

 private:
  void wait_for(Present& present, std::size_t process, const Openings& openings, flow::Ticks limit, Wait wait);
  static flow::Ticks drawn(Present& present, std::size_t process, flow::Ticks first, flow::Ticks last,
                           flow::Ticks limit);

  Tournament due_;    // when it acts
  Tournament limit_;  // when its invariant ends
  std::vector<Wait> waits_;
  ProcessSet parked_;  // those that wait so
};

}  // namespace tachk::simulation
