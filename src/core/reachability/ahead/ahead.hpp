// The successors of many states at once, found and stored by several threads: the same are stored, under the same
// numbers, as by one thread that takes the states one after the other.
//
// First all threads find the successors, and drop those that a stored state covers; nothing is stored meanwhile. Then
// each share of the discrete states is gone through by one thread, which compares what was found for it, in order, with
// what is stored there and with what comes before it. Last, when it is known how many are new, they get their numbers.
// That one state of the batch covers another one must not matter: so none may be removed as long as the batch lasts.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "reachability/ahead/finder.hpp"
#include "reachability/ahead/keeper.hpp"
#include "reachability/ahead/team.hpp"
#include "reachability/goals.hpp"
#include "states/store.hpp"
#include "symbolic/zone_graph.hpp"

namespace tachk {

class Ahead final {
 public:
  Ahead(const ZoneGraph& graph, PassedList& passed, unsigned threads);

  // Finds the successors of these states, which are not covered. How many of the first ones may be stored: up to one in
  // which a goal may be reached or which may lead to an error. Threads are started unless there are some.
  std::size_t find(std::span<const std::uint32_t> nodes, const GoalWatch& goals, const std::vector<std::uint8_t>& taken,
                   const Finder::Manner& manner);
  // How many successors have been found.
  std::size_t found() const;
  // Stores the successors of the first `count` of the states.
  void store(std::size_t count, const Keeper::Terms& terms);
  // Tells of each state, and of each state stored behind it, in order: begin(place, expansion, edges), and
  // add(harvest, found, union, keeper) which returns the number of the node. Then they are nodes.
  template <class Begin, class Add>
  void number(std::size_t count, Begin begin, Add add);

  std::span<const std::unique_ptr<Keeper>> keepers() const { return keepers_; }
  // The most threads that have worked at the same time.
  unsigned threads() const { return threads_; }
  // Ends the threads until there is more to do.
  void rest() { team_.reset(); }

 private:
  // The finder of each member, made by the thread that uses it, so that what two of them write does not lie side by
  // side.
  void make_finders();
  void find(unsigned member, std::span<const std::uint32_t> nodes);
  // Finds out to which shares states belong some part of which is new.
  void divide();
  // Calls work(keeper, member) for each share.
  template <class Work>
  void each_share(Work work);

  // Whether nobody has taken this share yet.
  bool takes(std::size_t share) { return !taken_[share].flag.exchange(true); }

  struct alignas(64) Taken {
    std::atomic<bool> flag{false};
  };

  const ZoneGraph& graph_;
  PassedList& passed_;
  std::vector<std::unique_ptr<Finder>> finders_;
  std::vector<Taken> taken_;  // of each share
  std::vector<std::unique_ptr<Keeper>> keepers_;
  std::vector<Expansion> expansions_;
  alignas(64) std::atomic<std::uint32_t> next_{0};
  alignas(64) std::atomic<std::uint32_t> first_event_{0};
  unsigned threads_ = 1;
  std::optional<Team> team_;  // ends before what it works on
};

template <class Begin, class Add>
void Ahead::number(std::size_t count, Begin begin, Add add) {
  struct Source {
    Keeper* keeper;
    const Arrivals::Arrival* next;
    const Arrivals::Arrival* last;
    const Keeper::Union* next_union;
  };
  constexpr std::uint64_t end = UINT64_MAX;
  std::vector<Source> sources;
  for (const std::unique_ptr<Keeper>& keeper : keepers_) {
    const std::span<const Arrivals::Arrival> all = keeper->arrivals();
    sources.push_back({keeper.get(), all.data(), all.data() + all.size(), keeper->unions().data()});
  }
  for (std::size_t place = 0; place < count; ++place) {
    const Expansion& expansion = expansions_[place];
    Harvest& harvest = finders_[expansion.finder]->harvest();
    begin(place, expansion,
          std::span(harvest.edges).subspan(expansion.first_edge, expansion.last_edge - expansion.first_edge));
    for (;;) {
      Source* first = nullptr;
      std::uint64_t least = end;
      for (Source& source : sources)
        if (source.next != source.last && source.next->order < least) {
          least = source.next->order;
          first = &source;
        }
      if (least >> 32 != place) break;
      const auto arrival = static_cast<std::uint32_t>(first->keeper->numbers().size());
      const std::span<const Keeper::Union> unions = first->keeper->unions();
      const bool united = first->next_union != unions.data() + unions.size() && first->next_union->arrival == arrival;
      first->keeper->numbers().push_back(add(harvest, harvest.found[static_cast<std::uint32_t>(least)],
                                             united ? first->next_union++ : nullptr, *first->keeper));
      ++first->next;
    }
  }
  each_share([](Keeper& keeper, unsigned) { keeper.settle(); });
}

// Each begins with those that it has worked on before, as a rule.
template <class Work>
void Ahead::each_share(Work work) {
  for (Taken& taken : taken_) taken.flag = false;
  const std::size_t shares = keepers_.size();
  const std::size_t members = team_->members();
  team_->share([&](unsigned member) {
    for (std::size_t n = 0; n < shares; ++n)
      if (const std::size_t share = (member * shares / members + n) % shares; takes(share))
        work(*keepers_[share], member);
  });
}

}  // namespace tachk
