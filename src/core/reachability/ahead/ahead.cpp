#include "reachability/ahead/ahead.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

namespace tachk {

Ahead::Ahead(const ZoneGraph& graph, const PassedList& passed, bool subsumption, unsigned threads)
    : passed_(passed), graph_(graph), latest_(threads) {
  for (std::uint32_t n = 0; n < threads; ++n)
    finders_.push_back(std::make_unique<Finder>(graph, passed, subsumption, n));
}

void Ahead::look(std::vector<std::uint32_t> nodes, const GoalWatch& goals, const std::vector<std::uint8_t>& taken) {
  constexpr std::size_t at_once = 16;
  if (!team_) team_.emplace(static_cast<unsigned>(finders_.size()));
  threads_ = std::max(threads_, team_->members());
  nodes_ = std::move(nodes);
  places_.assign(nodes_.size(), {nobody, 0});
  next_ = 0;
  first_unknown_ = passed_.size();
  doubtful_ = false;
  goals_then_ = goals.changes();
  std::atomic<std::size_t> next{0};
  for (const std::unique_ptr<Finder>& finder : finders_) finder->begin(goals, taken);
  team_->share([&](unsigned member) {
    Finder& finder = *finders_[member];
    while (!finder.full()) {
      const std::size_t first = next.fetch_add(at_once);
      const std::size_t last = std::min(first + at_once, nodes_.size());
      for (std::size_t n = first; n < last; ++n) {
        places_[n] = {member, static_cast<std::uint32_t>(finder.expansions())};
        finder.expand(nodes_[n]);
      }
      if (first >= nodes_.size()) break;
    }
  });
  const std::uint64_t shares = 2 * finders_.size();
  std::atomic<std::uint64_t> share{0};
  team_->share([&](unsigned member) {
    for (std::uint64_t n = share++; n < shares; n = share++) sift(n, shares, latest_[member]);
  });
}

bool Ahead::same_discrete(const Found& one, const Found& other) const {
  if (one.key != other.key) return false;
  if (one.discrete != HashIndex::absent || other.discrete != HashIndex::absent) return one.discrete == other.discrete;
  return std::equal(finders_[one.finder]->slots(one), finders_[one.finder]->slots(one) + graph_.program().state_slots,
                    finders_[other.finder]->slots(other));
}

void Ahead::compare(Found& found, Found* before) const {
  const int dimension = graph_.program().dimension();
  const ZoneOperations& operations = graph_.operations();
  const ConstZoneRef zone = finders_[found.finder]->zone(found.zone);
  const ConstZoneRef abstract = finders_[found.finder]->zone(found.abstract);
  const bool whole = graph_.program().diagonals.empty();  // or a piece may be covered although the zone is not
  found.before = before;
  for (Found* other = before; other != nullptr; other = other->before) {
    const ConstZoneRef earlier = finders_[other->finder]->zone(other->abstract);
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
  for (const Place place : places_) {
    if (place.finder == nobody) continue;
    Finder& finder = *finders_[place.finder];
    const Finder::Expansion& expansion = finder.expansion(place.expansion);
    for (std::size_t n = expansion.first; n < expansion.last; ++n) {
      Found& found = finder.found(n);
      if (found.key % shares != share) continue;
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
  if (goals.changes() != goals_then_) return std::nullopt;  // what was found may be an error in one that is closed
  while (next_ < nodes_.size() && nodes_[next_] != node) ++next_;
  if (next_ >= nodes_.size() || places_[next_].finder == nobody) return std::nullopt;
  Finder& finder = *finders_[places_[next_].finder];
  return Result{&finder, &finder.expansion(places_[next_].expansion)};
}

}  // namespace tachk
