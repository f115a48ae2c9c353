#include "symbolic/active_clocks.hpp"

#include <algorithm>
#include <bit>

namespace tachk::symbolic {

using zones::ZoneOperations;

ActiveClocks::ActiveClocks(const program::Program& program, const Semantics& semantics,
                           const ZoneOperations& operations, const std::vector<ZoneOperations>& smaller)
    : program_(program),
      semantics_(semantics),
      operations_(operations),
      words_((static_cast<std::size_t>(program.dimension()) + 63) / 64),
      mask_(words_),
      packed_(operations) {
  if (smaller.empty()) return;
  for (const ZoneOperations& each : smaller) lengths_.push_back(each.stride);
  for (const program::Process& process : program.processes)
    for (const program::Location& location : process.locations) {
      const std::size_t first = masks_.size();
      masks_.resize(first + words_);
      for (const std::vector<program::ClockBound>* bounds : {&location.lower, &location.upper})
        for (const program::ClockBound& bound : *bounds)
          if (bound.value >= 0) masks_[first + bound.clock / 64] |= std::uint64_t{1} << (bound.clock % 64);
    }
}

void ActiveClocks::collect(const std::int32_t* slots) {
  std::fill(mask_.begin(), mask_.end(), 0);
  mask_.front() = 1;
  for (std::size_t p = 0; p < program_.processes.size(); ++p) {
    const std::uint64_t* location = masks_.data() + semantics_.location_number(p, slots[p]) * words_;
    for (std::size_t word = 0; word < words_; ++word) mask_[word] |= location[word];
  }
  clocks_.clear();
  for (std::size_t word = 0; word < words_; ++word)
    for (std::uint64_t rest = mask_[word]; rest != 0; rest &= rest - 1)
      clocks_.push_back(static_cast<std::uint16_t>(64 * word + static_cast<std::size_t>(std::countr_zero(rest))));
}

states::ZoneView ActiveClocks::pack(const std::int32_t* slots, zones::ConstZoneRef zone) {
  const int dimension = program_.dimension();
  collect(slots);
  const auto count = static_cast<int>(clocks_.size());
  if (count == dimension) return {zone, dimension};
  operations_.gather(packed_.get(), zone, dimension, clocks_.data(), count, lengths_[static_cast<std::size_t>(count)]);
  return {packed_.get(), count};
}

void ActiveClocks::scatter(const std::int32_t* slots, zones::ConstZoneRef packed, zones::ZoneBuffer& zone) {
  collect(slots);
  const auto count = static_cast<int>(clocks_.size());
  if (count == program_.dimension())
    zone.assign(packed);
  else
    operations_.scatter(zone.get(), packed, program_.dimension(), clocks_.data(), count,
                        lengths_[static_cast<std::size_t>(count)]);
}

}  // namespace tachk::symbolic
