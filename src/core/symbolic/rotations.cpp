#include "symbolic/rotations.hpp"

#include <algorithm>
#include <numeric>

namespace tachk::symbolic {

Rotations::Rotations(const program::Interchangeable& orbit) : members_(orbit.slots.size()), tables_(orbit.tables) {
  for (std::size_t role = 0; role < orbit.slots.front().size(); ++role) {
    Track& track = tracks_.emplace_back();
    for (const std::vector<std::uint32_t>& own : orbit.slots) track.slots.push_back(own[role]);
  }
  for (const program::Interchangeable::Name& name : orbit.names) {
    auto track = std::find_if(tracks_.begin(), tracks_.end(), [&](const Track& each) {
      return std::find(each.slots.begin(), each.slots.end(), name.slot) != each.slots.end();
    });
    if (track == tracks_.end()) track = tracks_.insert(tracks_.end(), Track{{name.slot}, {}});
    if (std::find(track->tables.begin(), track->tables.end(), name.table) == track->tables.end())
      track->tables.push_back(name.table);
  }
}

Rotations::Content Rotations::content(const Track& track, std::int32_t value) const {
  for (const std::uint32_t table : track.tables) {
    const auto number = std::find(tables_[table].begin(), tables_[table].end(), value);
    if (number != tables_[table].end())
      return {named + static_cast<std::int64_t>(table * members_),
              static_cast<std::size_t>(number - tables_[table].begin())};
  }
  return {value, 0};
}

const std::vector<std::size_t>& Rotations::least(const std::int32_t* slots) {
  least_.resize(members_);
  std::iota(least_.begin(), least_.end(), std::size_t{0});
  for (const Track& track : tracks_) {
    if (least_.size() == 1) break;
    keep_least(track, slots);
  }
  return least_;
}

// Of the rotations found so far, those that make one track least.
void Rotations::keep_least(const Track& track, const std::int32_t* slots) {
  contents_.clear();
  for (const std::uint32_t slot : track.slots) contents_.push_back(content(track, slots[slot]));
  std::size_t count = 1;
  for (std::size_t candidate = 1; candidate < least_.size(); ++candidate) {
    const std::size_t best = least_.front();
    const std::size_t by = least_[candidate];
    int order = 0;
    for (std::size_t place = 0; place < contents_.size() && order == 0; ++place) {
      // A slot that no member owns stays where it is.
      const std::int64_t one = turned(contents_[(place + by) % contents_.size()], by);
      const std::int64_t other = turned(contents_[(place + best) % contents_.size()], best);
      order = one < other ? -1 : one > other ? 1 : 0;
    }
    if (order > 0) continue;
    if (order < 0) count = 0;
    least_[count++] = by;
  }
  least_.resize(count);
}

}  // namespace tachk::symbolic
