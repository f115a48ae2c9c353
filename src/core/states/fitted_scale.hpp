// The scale in which extents are summed up. Where a few entries are far larger than the others, what distinguishes
// zones is lost in the sums; then larger ones are cut off. Where that pays is tried out on zones of a long antichain:
// none of them contains another one, so that each pair that extents do not tell apart costs a comparison for nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "zones/extent.hpp"
#include "zones/zone.hpp"

namespace tachk::states {

class FittedScale {
 public:
  static constexpr std::size_t sample = 64;  // zones of one antichain

  FittedScale(const zones::ZoneOperations& operations, int dimension);

  const zones::ExtentScale& scale() const { return scale_; }
  // Records the largest entry of a further zone; true if that changes the scale.
  bool admit(zones::Raw largest_entry);
  // True if a scale is to be tried out once more.
  bool is_due() const { return zones_ >= next_fit_; }
  // Tries scales out on these zones; true if that changes the scale. `extent_of(zone, scale)` gives extents.
  template <class Zone, class ExtentOf>
  bool fit(const std::vector<Zone>& zones, ExtentOf extent_of) {
    next_fit_ = zones_ * 4;
    unsigned best = cut_;
    double fewest = better * static_cast<double>(confused(zones, extent_of, cut_));
    for (unsigned cut = 0; range_ >> cut > 0; ++cut) {
      if (cut == cut_) continue;
      const auto confusions = static_cast<double>(confused(zones, extent_of, cut));
      if (confusions >= fewest) continue;
      best = cut;
      fewest = confusions;
    }
    return choose(best);
  }

 private:
  static constexpr double better = 0.75;  // a change is worth it for so many confusions less
  static constexpr std::uint64_t first_fit = 512;

  zones::ExtentScale scale_of(unsigned cut) const;
  bool choose(unsigned cut);
  // How many pairs of zones are not told apart.
  template <class Zone, class ExtentOf>
  std::size_t confused(const std::vector<Zone>& zones, ExtentOf extent_of, unsigned cut) const {
    const zones::ExtentScale scale = scale_of(cut);
    std::vector<zones::Extent> extents;
    extents.reserve(zones.size());
    for (const Zone& zone : zones) extents.push_back(extent_of(zone, scale));
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < extents.size(); ++i)
      for (std::size_t j = 0; j < extents.size(); ++j)
        if (i != j && extents[i].may_include(extents[j])) ++pairs;
    return pairs;
  }

  zones::ZoneOperations operations_;
  int dimension_;
  zones::Raw range_ = 0;  // no entry is larger
  unsigned cut_ = 0;      // entries are cut off at this power of two part of the range
  zones::ExtentScale scale_;
  std::uint64_t zones_ = 0;
  std::uint64_t next_fit_ = first_fit;
};

}  // namespace tachk::states
