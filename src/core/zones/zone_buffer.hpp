// Memory for single zones and rows of bounds, aligned for vector loads.
#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <utility>

#include "zones/zone.hpp"

namespace tachk::zones {

class AlignedBytes {
 public:
  explicit AlignedBytes(std::size_t count)
      : count_(count), data_(static_cast<std::byte*>(::operator new(count, alignment))) {}
  AlignedBytes(const AlignedBytes& other) : AlignedBytes(other.count_) { assign(other.data_); }
  AlignedBytes(AlignedBytes&& other) noexcept : count_(other.count_), data_(std::exchange(other.data_, nullptr)) {}
  AlignedBytes& operator=(AlignedBytes other) noexcept {
    std::swap(count_, other.count_);
    std::swap(data_, other.data_);
    return *this;
  }
  ~AlignedBytes() { ::operator delete(data_, alignment); }

  std::byte* get() { return data_; }
  const std::byte* get() const { return data_; }
  void assign(const std::byte* bytes) { std::memcpy(data_, bytes, count_); }

 private:
  static constexpr std::align_val_t alignment{64};
  std::size_t count_;
  std::byte* data_;
};

// A zone of one's own. It holds none until one is assigned or written.
class ZoneBuffer {
 public:
  explicit ZoneBuffer(const ZoneOperations& operations) : memory_(operations.bytes) {}

  ZoneRef get() { return {memory_.get()}; }
  ConstZoneRef get() const { return {memory_.get()}; }
  void assign(ConstZoneRef zone) { memory_.assign(zone.bytes); }

 private:
  AlignedBytes memory_;
};

// A row of bounds of one's own, by default with no bound for any clock.
class BoundRowBuffer {
 public:
  BoundRowBuffer(const ZoneOperations& operations, int dimension) : memory_(operations.row_bytes) {
    for (int clock = 0; clock < operations.stride; ++clock)
      operations.set_bound(get(), clock, clock == 0 || clock >= dimension ? no_bound : not_compared);
  }

  BoundRow get() { return {memory_.get()}; }
  ConstBoundRow get() const { return {memory_.get()}; }

 private:
  AlignedBytes memory_;
};

}  // namespace tachk::zones
