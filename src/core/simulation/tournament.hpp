// A moment for each process. Of few processes all are looked at to find the least moment; of more there is a tree of
// the least ones (a tournament, D. Knuth, "The Art of Computer Programming", volume 3, section 5.2.3): the least is
// known at once, and to change one takes as many steps as the logarithm of the number of processes.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <vector>

#include "flow/clock_values.hpp"

namespace tachk::simulation {

// So many processes are looked at one by one faster than sets and trees of them are kept.
inline constexpr std::size_t few_processes = 16;

class Tournament {
 public:
  explicit Tournament(std::size_t processes)
      : inner_(processes <= few_processes ? 0 : std::bit_ceil(processes)), least_(inner_ + processes, flow::never) {
    if (inner_ != 0) least_.resize(2 * inner_, flow::never);
  }

  flow::Ticks operator[](std::size_t process) const { return least_[inner_ + process]; }
  flow::Ticks least() const {
    if (inner_ != 0) return least_[1];
    flow::Ticks least = flow::never;
    for (const flow::Ticks moment : least_) least = std::min(least, moment);
    return least;
  }

  void set(std::size_t process, flow::Ticks moment) {
    std::size_t place = inner_ + process;
    if (inner_ == 0) {
      least_[place] = moment;
      return;
    }
    while (least_[place] != moment) {
      least_[place] = moment;
      if ((place /= 2) == 0) return;
      moment = std::min(least_[2 * place], least_[2 * place + 1]);
    }
  }

  // Calls visit(process) for each process with this moment, which is the least, in the order of their numbers.
  template <class Visit>
  void for_each_at(flow::Ticks moment, Visit&& visit) const {
    if (inner_ != 0) return visit_from(1, moment, visit);
    for (std::size_t process = 0; process < least_.size(); ++process)
      if (least_[process] == moment) visit(process);
  }

 private:
  template <class Visit>
  void visit_from(std::size_t place, flow::Ticks moment, Visit&& visit) const {
    if (least_[place] != moment) return;
    if (place >= inner_) return visit(place - inner_);
    visit_from(2 * place, moment, visit);
    visit_from(2 * place + 1, moment, visit);
  }

  std::size_t inner_;               // the number of inner nodes of the tree, of which 1 is the root, and one more
  std::vector<flow::Ticks> least_;  // of the subtree of each node; the leaves are the processes
};

}  // namespace tachk::simulation
