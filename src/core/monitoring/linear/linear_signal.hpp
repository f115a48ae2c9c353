// Signals that are linear between their break points, where they may jump, over real time; and the operators on them.
// Donze, Ferrere, Maler (2013), with bounds that may be open and signals that may jump.
#pragma once

#include <limits>
#include <vector>

namespace tachk::monitoring::linear {

inline constexpr double without_end = std::numeric_limits<double>::infinity();

// From its start to the next piece, or without end.
struct LinearPiece {
  double start;
  double at;      // the value at the start itself
  double after;   // the limit at the start from the right
  double before;  // the limit at the end from the left; the last piece is constant
};

// Starts at 0; never empty. Infinite values are constant on a piece.
using LinearSignal = std::vector<LinearPiece>;

// An interval of offsets; -infinity and infinity: no such end.
struct LinearWindow {
  double first;
  double last;
  bool first_closed;
  bool last_closed;
};

LinearSignal constant_signal(double value);
LinearSignal negated(LinearSignal signal);
LinearSignal plus(const LinearSignal& left, const LinearSignal& right);
LinearSignal times(LinearSignal signal, double factor);
LinearSignal maximum(const LinearSignal& left, const LinearSignal& right);
LinearSignal minimum(const LinearSignal& left, const LinearSignal& right);
// signal(t + offset); -infinity where that is before 0.
LinearSignal moved(const LinearSignal& signal, double offset);
// At each instant the limit from the left; -infinity at 0.
LinearSignal left_limits(LinearSignal signal);
// The first signal up to an instant, included; the second one after it.
LinearSignal spliced(const LinearSignal& left, const LinearSignal& right, double end);
// The supremum over a window around each instant; before 0 the signal counts as -infinity.
LinearSignal supremum(const LinearSignal& signal, const LinearWindow& window);
// The strict until and since without bounds: sup over t' > t of min(g(t'), inf of f on [t,t')), and over t' < t of
// min(g(t'), inf of f on (t',t]).
LinearSignal strict_until(const LinearSignal& f, const LinearSignal& g);
LinearSignal strict_since(const LinearSignal& f, const LinearSignal& g);

}  // namespace tachk::monitoring::linear
