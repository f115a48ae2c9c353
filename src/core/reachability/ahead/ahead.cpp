#include "reachability/ahead/ahead.hpp"

#include <algorithm>
#include <new>

namespace tachk {

Ahead::Ahead(const ZoneGraph& graph, PassedList& passed, unsigned threads)
    : graph_(graph), passed_(passed), finders_(threads), taken_(passed.shares()) {
  for (std::uint32_t n = 0; n < passed.shares(); ++n) keepers_.push_back(std::make_unique<Keeper>(passed, n, graph));
}

void Ahead::make_finders() {
  std::atomic<bool> failed{false};
  team_->share([&](unsigned member) {
    try {
      if (!finders_[member]) finders_[member] = std::make_unique<Finder>(graph_, passed_, member);
    } catch (const std::bad_alloc&) {
      failed = true;
    }
  });
  if (failed) throw std::bad_alloc();
}

std::size_t Ahead::find(std::span<const std::uint32_t> nodes, const GoalWatch& goals,
                        const std::vector<std::uint8_t>& taken, const Finder::Manner& manner) {
  if (!team_) {
    team_.emplace(static_cast<unsigned>(finders_.size()));
    finders_.resize(team_->members());
    make_finders();
  }
  threads_ = std::max(threads_, team_->members());
  for (const std::unique_ptr<Finder>& finder : finders_) finder->begin(goals, taken, manner);
  expansions_.assign(nodes.size(), {});
  next_ = 0;
  first_event_ = static_cast<std::uint32_t>(nodes.size());
  team_->share([&](unsigned member) { find(member, nodes); });
  const bool unknown =
      std::any_of(finders_.begin(), finders_.end(), [](const auto& finder) { return finder->has_unknown(); });
  if (unknown) divide();
  std::size_t count = 0;
  while (count < nodes.size() && expansions_[count].done && !expansions_[count].eventful) ++count;
  return count;
}

void Ahead::find(unsigned member, std::span<const std::uint32_t> nodes) {
  constexpr std::uint32_t at_once = 8;
  Finder& finder = *finders_[member];
  while (!finder.full()) {
    const std::uint32_t first = next_.fetch_add(at_once);
    if (first >= first_event_) return;
    const auto last = std::min(first + at_once, static_cast<std::uint32_t>(nodes.size()));
    for (std::uint32_t place = first; place < last; ++place) {
      finder.expand(nodes[place], place, expansions_[place]);
      if (!expansions_[place].eventful) continue;
      std::uint32_t event = first_event_;
      while (place < event && !first_event_.compare_exchange_weak(event, place)) continue;
      break;
    }
  }
}

void Ahead::divide() {
  for (const std::unique_ptr<Finder>& finder : finders_) {
    if (!finder->has_unknown()) continue;
    Harvest& harvest = finder->harvest();
    for (Found& found : harvest.found)
      if (!found.known) {
        passed_.announce(harvest.slots(found.slots), SlotSet::all());
        found.key = harvest.keep(passed_.announced().key);
        found.hash = passed_.announced().hash;
        found.known = true;
      }
    finder->divide();
  }
}

std::size_t Ahead::found() const {
  std::size_t sum = 0;
  for (const std::unique_ptr<Finder>& finder : finders_) sum += finder->harvest().found.size();
  return sum;
}

void Ahead::store(std::size_t count, const Keeper::Terms& terms) {
  each_share([&](Keeper& keeper, unsigned member) {
    keeper.keep(finders_, static_cast<std::uint32_t>(count), terms, finders_[member]->graph());
  });
}

}  // namespace tachk
