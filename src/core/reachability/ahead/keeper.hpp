// What has been found for one share of the stored states is stored there, in the order in which one thread would.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "reachability/ahead/finder.hpp"
#include "states/arrivals.hpp"
#include "states/trial.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk {

class Keeper final {
 public:
  // What holds as long as a batch is stored.
  struct Terms {
    bool subsumption;
    bool simulation;              // whether it is asked if a state is simulated
    bool merging;                 // whether zones may be united
    bool unites;                  // whether they are to be
    std::uint32_t first_waiting;  // with those from this number on
  };
  // An arrival that was made of several states.
  struct Union {
    std::uint32_t arrival;
    std::vector<std::uint32_t> parts;  // nodes
    std::vector<std::uint32_t> own;    // arrivals of the same share
  };

  Keeper(PassedList& passed, std::uint32_t share, const ZoneGraph& graph);

  // Stores what was found of the first `count` states of a batch, which become arrivals. `graph`: of the thread that
  // does.
  void keep(std::span<const std::unique_ptr<Finder>> finders, std::uint32_t count, const Terms& terms,
            ZoneGraph& graph);
  std::span<const Arrivals::Arrival> arrivals() const { return arrivals_.all(); }
  // Ascending by their arrivals.
  std::span<const Union> unions() const { return unions_; }
  const TrialAnswers& simulated() const { return simulated_; }
  const TrialAnswers& united() const { return united_; }
  // How many more states are stored than before, and which are not any more.
  std::int64_t added() const { return arrivals_.added(); }
  const std::vector<std::uint32_t>& covered() const { return share_.covered(); }

  // The numbers of the arrivals, which become nodes.
  std::vector<std::uint32_t>& numbers() { return numbers_; }
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }
  void settle() { arrivals_.settle(passed_.nodes(), numbers_); }

 private:
  bool wants(const Found& found, std::uint32_t discrete, ZoneView zone, const std::int32_t* slots, ZoneGraph& graph);
  bool is_simulated(std::uint32_t discrete, ZoneView zone, const std::int32_t* slots, ZoneGraph& graph);
  void take(const Found& found, Harvest& harvest, ZoneGraph& graph);
  void store(std::uint64_t order, std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds);

  PassedList& passed_;
  Share& share_;
  std::uint32_t number_;
  bool whole_;  // zones have one abstraction each
  Terms terms_{};
  Arrivals arrivals_;
  TrialAnswers simulated_;
  TrialAnswers united_;
  ZoneBuffer union_;
  ZoneBuffer source_;
  std::vector<Union> unions_;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace tachk
