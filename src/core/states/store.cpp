#include "states/store.hpp"

#include <cstring>
#include <stdexcept>

namespace tachk {
namespace {

// The scale of extents must do for smaller zones too, whose rows may consist of more and shorter vectors.
ZoneOperations with_shorter_vectors(ZoneOperations operations, bool shorter) {
  if (shorter && operations.lanes > 1) operations.lanes /= 2;
  return operations;
}

}  // namespace

PassedList::PassedList(const Program& program, const ZoneOperations& zones, const StoreOptions& options,
                       const std::vector<ZoneOperations>& smaller, unsigned share_bits)
    : discretes_(program, options.chunk_words, share_bits), reclaim_(options.reclaim) {
  const std::size_t count = std::size_t{1} << share_bits;
  shares_.reserve(count);
  for (std::size_t share = 0; share < count; ++share)
    shares_.emplace_back(ZoneStore(zones, program.dimension(), smaller, options.rows_after),
                         with_shorter_vectors(zones, !smaller.empty()), program.dimension(), options.reclaim, nodes_,
                         discretes_);
  covered_last_ = &shares_.front().covered();
}

std::size_t PassedList::unite(std::uint32_t discrete, ZoneView zone, std::uint32_t first, ZoneRef united,
                              std::vector<std::uint32_t>& parts) {
  Share& share = share_of(discrete);
  std::memcpy(united.bytes, zone.data.bytes, share.zones().operations(zone.dimension).bytes);
  std::size_t looked = 0;
  for (std::size_t before = SIZE_MAX; before != parts.size();) {  // a larger zone may unite with what a smaller did not
    before = parts.size();
    share.for_each_waiting(discrete, first, parts, [&](std::uint32_t other) {
      ++looked;
      return share.unite(united, zone.dimension, other);
    });
  }
  return looked;
}

bool PassedList::contains(std::uint32_t discrete, ZoneView zone, bool subsumption) const {
  return subsumption ? covers(discrete, zone) : find(discrete, zone) != no_node;
}

std::uint32_t PassedList::add(std::uint32_t discrete, ZoneView zone, std::uint32_t parent, bool subsumption,
                              const ClockBounds* bounds) {
  Share& share = share_of(discrete);
  share.covered().clear();
  covered_last_ = &share.covered();
  if (subsumption) {
    if (covers(discrete, zone, bounds)) return no_node;
    share.thin_out(discrete, zone, bounds);
    stored_ -= static_cast<std::uint32_t>(share.covered().size());
  }
  const std::uint32_t zone_number = share.intern(zone);
  if (!subsumption && share.holds(discrete, zone, zone_number)) {
    share.release(zone_number);
    return no_node;
  }
  const std::uint32_t fresh = append(parent);
  if (((discrete | zone_number) & Nodes::mark) != 0) throw std::length_error("more states than node numbers");
  nodes_[fresh] = {discrete | Nodes::mark, zone_number};
  share.append(discrete, fresh);
  ++stored_;
  return fresh;
}

std::uint32_t PassedList::append(std::uint32_t parent) {
  const std::uint32_t fresh = nodes_.append();
  if ((fresh & Nodes::mark) != 0) throw std::length_error("more states than node numbers");
  parents_.append(parent);
  return fresh;
}

bool PassedList::may_equal(std::uint32_t number, ZoneView zone) const {
  const ZoneStore& zones = zones_of(number);
  if (reclaim_ && covered(number)) return (zones.upper_hash(zone) | Nodes::mark) == nodes_[number].zone;
  return zones.equals(nodes_.zone(number), zone);
}

std::size_t PassedList::bytes() const {
  std::size_t sum = discretes_.bytes() + nodes_.bytes() + parents_.bytes();
  for (const Share& share : shares_) sum += share.bytes();
  return sum;
}

}  // namespace tachk
