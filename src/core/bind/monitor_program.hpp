// Reads tachk.recordings.traces.monitor_program.MonitorProgram, and columns as NumPy holds them.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <vector>

#include "monitoring/monitor_program.hpp"
#include "monitoring/monitor_samples.hpp"

namespace tachk::bind {

using TickArray = nanobind::ndarray<const std::int64_t, nanobind::ndim<1>, nanobind::c_contig, nanobind::device::cpu>;

// The program as C++ has it, validated.
monitoring::MonitorProgram monitor_program_from(nanobind::handle program);

// Samples of ticks and columns (float64, uint8 or bool; contiguous) without copying; the arrays must outlive them.
class NB_HIDDEN SampleView {
 public:
  SampleView(const TickArray& ticks, const nanobind::sequence& columns)
      : SampleView(ticks.data(), ticks.shape(0), columns) {}
  SampleView(const std::int64_t* ticks, std::size_t count, const nanobind::sequence& columns);
  const monitoring::Samples& samples() const { return samples_; }

 private:
  std::vector<nanobind::object> held_;
  std::vector<monitoring::Column> columns_;
  monitoring::Samples samples_;
};

}  // namespace tachk::bind
