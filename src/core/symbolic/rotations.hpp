// The rotations of a cyclic orbit of processes that make the slots of a state least.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "program/program.hpp"

namespace tachk::symbolic {

class Rotations final {
 public:
  explicit Rotations(const program::Interchangeable& orbit);

  // By how many places members may move to the front so that the state is least; valid until the next call.
  const std::vector<std::size_t>& least(const std::int32_t* slots);

 private:
  // Slots of which the same is known, one for each member; or one that no member owns.
  struct Track {
    std::vector<std::uint32_t> slots;
    std::vector<std::uint32_t> tables;  // in which its values may be names
  };

  // The content of a slot: a plain value, or the name of a member, which counts from the first place.
  struct Content {
    std::int64_t kind;
    std::size_t named;
  };
  Content content(const Track& track, std::int32_t value) const;
  // The value at a place after a rotation; without names it is the same for all rotations.
  std::int64_t turned(const Content& content, std::size_t by) const {
    return content.kind < named ? content.kind
                                : content.kind + static_cast<std::int64_t>((content.named + members_ - by) % members_);
  }
  void keep_least(const Track& track, const std::int32_t* slots);

  static constexpr std::int64_t named = std::int64_t{1} << 40;

  std::size_t members_;
  std::vector<Track> tracks_;
  std::vector<std::vector<std::int32_t>> tables_;
  std::vector<std::size_t> least_;
  std::vector<Content> contents_;
};

}  // namespace tachk::symbolic
