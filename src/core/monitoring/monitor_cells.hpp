// Cells of time. Cell 2t is the instant t, cell 2t + 1 the open interval between the instants t and t + 1 (in ticks).
// Signals that change at ticks only, and whatever the operators make of them, are constant on cells, so open and closed
// bounds and isolated points are exact matters of integers. Cell 0 is the first instant of the trace.
#pragma once

#include <cstdint>

#include "monitoring/monitor_program.hpp"

namespace tachk::monitoring {

using Cell = std::int64_t;

// After every cell. Ticks and sums of bounds stay below `largest_tick`, so that sums of cells cannot overflow.
inline constexpr Cell endless = Cell{1} << 62;
inline constexpr std::int64_t largest_tick = std::int64_t{1} << 59;

constexpr Cell cell_of_tick(std::int64_t tick) { return 2 * tick; }
constexpr bool is_instant(Cell cell) { return (cell & 1) == 0; }

// Moves a cell, or the number of known cells, by an offset; what is endless stays so.
constexpr Cell shifted(Cell cell, Cell offset) { return cell == endless ? endless : cell + offset; }

// Offsets of the first and the last cell of a window from the cell it belongs to. -endless and endless: no such end.
struct CellOffsets {
  Cell first = 0;
  Cell last = 0;
  bool operator==(const CellOffsets&) const = default;
};

// A window as seen from instants (even cells) and from the intervals between them (odd cells); they differ if a bound
// is open, because an open interval shifted by t leaves out the shifted bound only when t is an instant.
struct CellWindow {
  CellOffsets even;
  CellOffsets odd;
  bool empty = false;  // such as (a,a)
  bool uniform() const { return even == odd; }
};

constexpr CellWindow future_window(std::int64_t lower, std::int64_t upper, bool lower_closed, bool upper_closed) {
  CellWindow window;
  window.odd = {2 * lower, upper == unbounded ? endless : 2 * upper};
  window.even = {2 * lower + (lower_closed ? 0 : 1), upper == unbounded ? endless : 2 * upper - (upper_closed ? 0 : 1)};
  window.empty = upper != unbounded && (upper < lower || (upper == lower && !(lower_closed && upper_closed)));
  return window;
}

constexpr CellWindow mirrored(const CellWindow& window) {
  return {{-window.even.last, -window.even.first}, {-window.odd.last, -window.odd.first}, window.empty};
}

constexpr CellWindow future_window(const MonitorNode& node) {
  return future_window(node.lower, node.upper, node.lower_closed, node.upper_closed);
}
constexpr CellWindow past_window(const MonitorNode& node) { return mirrored(future_window(node)); }

}  // namespace tachk::monitoring
