#include "reachability/ahead/ahead.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "zones/patience.hpp"

namespace tachk::reachability::ahead {

using zones::ConstZoneRef;
using zones::Patience;

Ahead::Ahead(const symbolic::ZoneGraph& graph, const states::PassedList& passed, bool subsumption, unsigned threads)
    : passed_(passed), graph_(graph), latest_(threads) {
  for (std::uint32_t n = 0; n < threads; ++n)
    finders_.push_back(std::make_unique<Finder>(graph, passed, subsumption, n));
}

void Ahead::interrupt() {
  stop_ = true;
  if (team_) team_->finish();
  stop_ = false;
}

void Ahead::rest() {
  interrupt();
  team_.reset();
}

void Ahead::look(std::vector<std::uint32_t> nodes, std::size_t block, const GoalWatch& goals,
                 const std::vector<std::uint8_t>& taken) {
  interrupt();
  if (!team_) team_.emplace(static_cast<unsigned>(finders_.size()));
  threads_ = std::max(threads_, team_->members());
  std::vector<std::uint32_t> further(nodes.begin() + static_cast<std::ptrdiff_t>(std::min(block, nodes.size())),
                                     nodes.end());
  nodes.resize(nodes.size() - further.size());
  block_ = {.nodes = std::move(nodes), .first_unknown = passed_.size(), .goals_then = goals.changes()};
  block_.places.assign(block_.nodes.size(), {nobody, 0});
  find(goals, taken);
  sift_and_go_on(std::move(further));
}

std::size_t Ahead::place_early() {
  block_.early.assign(block_.nodes.size(), {nobody, 0});
  std::size_t done = 0;
  auto place = block_.nodes.begin();
  for (std::uint32_t member = 1; member < finders_.size(); ++member) {
    const std::span<const std::uint32_t> early = finders_[member]->early();
    done += early.size();
    for (std::uint32_t n = 0; n < early.size(); ++n) {
      const auto found = std::find(place, block_.nodes.end(), early[n]);
      if (found == block_.nodes.end()) continue;  // it has been covered since
      block_.early[static_cast<std::size_t>(found - block_.nodes.begin())] = {member, n};
      place = found;
    }
  }
  return done;
}

void Ahead::find(const GoalWatch& goals, const std::vector<std::uint8_t>& taken) {
  for (const std::unique_ptr<Finder>& finder : finders_) finder->begin(goals, taken);
  const std::size_t done = place_early();
  const std::size_t noted = early_ * (finders_.size() - 1);
  if (done == noted)
    early_ = std::min(2 * early_, most_early);
  else if (2 * done < noted)
    early_ = std::max(early_ / 2, fewest_early);
  std::atomic<std::size_t> next{0};
  team_->share([&, patience = Patience::current()](unsigned member) {
    const Patience::Shared shared(patience);
    find(member, next);
  });
}

void Ahead::find(unsigned member, std::atomic<std::size_t>& next) {
  constexpr std::size_t at_once = 16;
  Finder& finder = *finders_[member];
  const auto place = [&] { return Place{member, static_cast<std::uint32_t>(finder.harvest().expansions.size())}; };
  for (std::size_t n = 0; n < block_.nodes.size(); ++n)
    if (block_.early[n].finder == member) {
      block_.places[n] = place();
      finder.look_up(block_.early[n].expansion);
    }
  while (!finder.full()) {
    const std::size_t first = next.fetch_add(at_once);
    const std::size_t last = std::min(first + at_once, block_.nodes.size());
    for (std::size_t n = first; n < last; ++n)
      if (block_.early[n].finder == nobody) {
        block_.places[n] = place();
        finder.expand(block_.nodes[n]);
      }
    if (first >= block_.nodes.size()) break;
  }
}

void Ahead::sift_and_go_on(std::vector<std::uint32_t> further) {
  const std::uint64_t shares = 2 * finders_.size();
  const std::size_t early = early_;
  share_ = 0;
  sifting_ = team_->members() - 1;
  const auto sift_all = [this, shares](unsigned member) {
    for (std::uint64_t n = share_++; n < shares; n = share_++) sift(n, shares, latest_[member]);
  };
  team_->begin([this, sift_all, early, further = std::move(further), patience = Patience::current()](unsigned member) {
    const Patience::Shared shared(patience);
    Finder& finder = *finders_[member];
    sift_all(member);
    const std::size_t first = std::min((member - 1) * early, further.size());
    finder.note(std::span(further).subspan(first, std::min(early, further.size() - first)));
    if (--sifting_ == 0) sifting_.notify_one();
    while (!stop_.load(std::memory_order_relaxed) && finder.expand_early()) continue;
  });
  sift_all(0);
  for (std::uint32_t sifting = sifting_; sifting != 0; sifting = sifting_) await_change(sifting_, sifting);
}

bool Ahead::same_discrete(const Found& one, const Found& other) const {
  if (one.key != other.key) return false;
  if (one.discrete != states::HashIndex::absent || other.discrete != states::HashIndex::absent)
    return one.discrete == other.discrete;
  const std::int32_t* slots = harvest(one).slots(one.slots);
  return std::equal(slots, slots + graph_.program().state_slots, harvest(other).slots(other.slots));
}

void Ahead::compare(Found& found, Found* before) const {
  const int dimension = graph_.program().dimension();
  const zones::ZoneOperations& operations = graph_.operations();
  const ConstZoneRef zone = harvest(found).zone(found.zone);
  const ConstZoneRef abstract = harvest(found).zone(found.abstract);
  const bool whole = graph_.program().diagonals.empty();  // or a piece may be covered although the zone is not
  found.before = before;
  for (Found* other = before; other != nullptr; other = other->before) {
    const ConstZoneRef earlier = harvest(*other).zone(other->abstract);
    if (!found.further && operations.includes(earlier, zone, dimension)) {
      found.coverer = other;
      return;
    }
    found.apart = found.apart && !operations.includes(abstract, earlier, dimension) &&
                  (whole || !operations.includes(earlier, abstract, dimension));
  }
}

// Those that are covered stay out of the lists: as a rule they will not be stored.
void Ahead::sift(std::uint64_t share, std::uint64_t shares, std::vector<Found*>& latest) {
  constexpr std::size_t places = std::size_t{1} << 12;
  latest.assign(places, nullptr);
  for (const Place place : block_.places) {
    if (place.finder == nobody) continue;
    Harvest& harvest = finders_[place.finder]->harvest();
    const Expansion& expansion = harvest.expansions[place.expansion];
    for (std::size_t n = expansion.first; n < expansion.last; ++n) {
      Found& found = harvest.found[n];
      if (found.key % shares != share) continue;
      if (found.own_coverer != Found::none) {
        found.coverer = &harvest.found[found.own_coverer];
        continue;
      }
      Found*& head = latest[found.key / shares % places];
      // Discrete states that share a place are not compared.
      if (head != nullptr && !same_discrete(found, *head)) {
        found.apart = false;
        continue;
      }
      compare(found, head);
      if (found.coverer == nullptr) head = &found;
    }
  }
}

std::optional<Ahead::Result> Ahead::result(std::uint32_t node, const GoalWatch& goals) {
  if (goals.changes() != block_.goals_then)
    return std::nullopt;  // what was found may be an error in one that is closed
  while (block_.next < block_.nodes.size() && block_.nodes[block_.next] != node) ++block_.next;
  if (block_.next >= block_.nodes.size() || block_.places[block_.next].finder == nobody) return std::nullopt;
  Harvest& harvest = finders_[block_.places[block_.next].finder]->harvest();
  return Result{&harvest, &harvest.expansions[block_.places[block_.next].expansion]};
}

}  // namespace tachk::reachability::ahead
