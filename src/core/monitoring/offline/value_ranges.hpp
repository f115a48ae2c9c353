// The certain truth of an atom whose columns have values at different times: each of them has any of the values between
// the least and the greatest that it has in a segment of samples.
#pragma once

#include <cstddef>
#include <vector>

#include "monitoring/monitor_program.hpp"
#include "monitoring/offline/monitor_stream.hpp"

namespace tachk::monitoring::offline {

// The columns that an atom reads, each once.
std::vector<std::size_t> columns_of(const MonitorAtom& atom);

// For each sample the first later one, up to which the atom does not certainly keep the truth that it has at the
// sample; the number of samples if there is none. The segment includes both.
std::vector<std::size_t> first_uncertain(const MonitorAtom& atom, const std::vector<std::vector<double>>& columns,
                                         const std::vector<Truth>& holding);

}  // namespace tachk::monitoring::offline
