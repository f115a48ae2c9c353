#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <utility>

#include "zones/zone.hpp"

namespace tachk {

// Memory for one zone, aligned for vector loads.
class ZoneBuffer {
 public:
  explicit ZoneBuffer(const ZoneOperations& operations)
      : bytes_(operations.bytes), data_(static_cast<std::byte*>(::operator new(bytes_, alignment))) {}
  ZoneBuffer(const ZoneBuffer& other)
      : bytes_(other.bytes_), data_(static_cast<std::byte*>(::operator new(bytes_, alignment))) {
    assign(other.get());
  }
  ZoneBuffer(ZoneBuffer&& other) noexcept : bytes_(other.bytes_), data_(std::exchange(other.data_, nullptr)) {}
  ZoneBuffer& operator=(ZoneBuffer other) noexcept {
    std::swap(bytes_, other.bytes_);
    std::swap(data_, other.data_);
    return *this;
  }
  ~ZoneBuffer() { ::operator delete(data_, alignment); }

  void* get() { return data_; }
  const void* get() const { return data_; }
  void assign(const void* zone) { std::memcpy(data_, zone, bytes_); }

 private:
  static constexpr std::align_val_t alignment{64};
  std::size_t bytes_;
  std::byte* data_;
};

}  // namespace tachk
