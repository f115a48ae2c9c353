// The formula as the online engines compute it: few operators, negation on the arrows between them.
//
// `f U[a,b] g` is G[0,a) f && F[a,b] g && (g || f V g shifted by a), where V is the strict until without bounds: g at
// some later instant t', f from now to before t'. The equation holds for truth, for robustness and under Kleene's rules
// (Donze, Ferrere and Maler 2013 split until likewise). Since is its mirror image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "monitoring/monitor_cells.hpp"
#include "monitoring/monitor_program.hpp"

namespace tachk::monitoring::online {

enum class OnlineKind : std::uint8_t {
  constant_false,
  atom,
  change,
  either,        // left or right
  window,        // left somewhere in a window ahead or behind
  strict_until,  // at some later t', right; left from now to before t'
  strict_since,  // at some earlier t', right; left from after t' to now
  just_before,   // left just before an instant, left itself between two instants; false at 0
};

// A node, or its negation.
struct Literal {
  std::uint32_t node = 0;
  bool negated = false;
  Literal operator!() const { return {node, !negated}; }
};

struct OnlineNode {
  OnlineKind kind = OnlineKind::constant_false;
  Literal left;
  Literal right;
  std::size_t atom = 0;
  CellWindow window;        // of `window`
  bool to_the_end = false;  // looks ahead as far as the trace goes: its end, not more time, decides what is left open
};

struct OnlineGraph {
  std::vector<OnlineNode> nodes;  // operands before operators
  Literal root;

  Literal falsity();
  Literal either(Literal left, Literal right);
  Literal both(Literal left, Literal right) { return !either(!left, !right); }
  Literal somewhere(const CellWindow& window, Literal operand);
  Literal everywhere(const CellWindow& window, Literal operand) { return !somewhere(window, !operand); }
  Literal add(const OnlineNode& node);

  bool is_everywhere_ahead(Literal operand) const;  // G without bounds
};

// The program must be valid.
OnlineGraph make_online_graph(const MonitorProgram& program);

// Which cells have a given cell, or only cells of a given run, in their windows. Cells before 0 count as part of a run
// that begins at 0; a run may be endless.
struct WindowShape {
  explicit WindowShape(const CellWindow& window)
      : first(window.odd.first),
        last(window.odd.last),
        first_open(window.even.first != window.odd.first),
        last_open(window.even.last != window.odd.last) {}

  // The first and the last cell whose window meets the run.
  Cell meets_from(Cell run_first) const {
    if (last == endless) return 0;
    return run_first - last + (last_open && is_instant(run_first) ? 1 : 0);
  }
  Cell meets_to(Cell run_last) const {
    if (first == -endless || run_last >= endless - 1) return endless - 1;
    return run_last - first - (first_open && is_instant(run_last) ? 1 : 0);
  }
  // The first and the last cell whose window lies in the run; beyond every cell, or before, if there is none.
  Cell within_from(Cell run_first) const {
    if (run_first <= 0) return 0;
    if (first == -endless) return endless;
    return run_first - first - (first_open && !is_instant(run_first) ? 1 : 0);
  }
  Cell within_to(Cell run_last) const {
    if (run_last >= endless - 1) return endless - 1;
    if (last == endless) return -1;
    return run_last - last + (last_open && !is_instant(run_last) ? 1 : 0);
  }

  Cell first;
  Cell last;
  bool first_open;
  bool last_open;
};

}  // namespace tachk::monitoring::online
