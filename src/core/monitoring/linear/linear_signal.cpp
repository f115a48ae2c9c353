#include "monitoring/linear/linear_signal.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <limits>

namespace tachk::monitoring::linear {
namespace {

double end_of(const LinearSignal& signal, std::size_t number) {
  return number + 1 < signal.size() ? signal[number + 1].start : without_end;
}

// The value of a piece inside of it.
double inside(const LinearPiece& piece, double end, double time) {
  if (piece.after == piece.before || end == without_end) return piece.after;
  return piece.after + (piece.before - piece.after) * ((time - piece.start) / (end - piece.start));
}

// Appends a piece, or lets the last one go on if the two lie on one line.
class Builder {
 public:
  void add(double start, double at, double after, double before) {
    if (!signal_.empty() && signal_.back().start == start) signal_.pop_back();
    if (!signal_.empty() && continues(start, at, after, before)) {
      signal_.back().before = before;
      end_ = without_end;
      return;
    }
    signal_.push_back({start, at, after, before});
  }
  // The end of the piece that comes next; needed to compare slopes.
  void until(double end) { end_ = end; }
  LinearSignal take() { return std::move(signal_); }

 private:
  bool continues(double start, double at, double after, double before) const {
    const LinearPiece& last = signal_.back();
    if (last.before != at || at != after) return false;
    if (last.after == last.before) return after == before;
    if (end_ == without_end || after == before || std::isinf(before)) return false;
    const double whole = (before - last.after) * ((start - last.start) / (end_ - last.start));
    return std::abs(last.after + whole - at) <= 1e-14 * (std::abs(last.after) + std::abs(before));
  }

  LinearSignal signal_;
  double end_ = without_end;
};

struct CommonSegment {
  double start;
  double end;
  double left_at, left_after, left_before;
  double right_at, right_after, right_before;
};

// The segments on which both signals are linear.
template <class Visit>
void walk(const LinearSignal& left, const LinearSignal& right, Visit visit) {
  std::size_t i = 0;
  std::size_t j = 0;
  double start = 0;
  const auto side = [&](const LinearSignal& signal, std::size_t n, double end, double& at, double& after,
                        double& before) {
    const LinearPiece& piece = signal[n];
    const double stop = end_of(signal, n);
    after = piece.start == start ? piece.after : inside(piece, stop, start);
    at = piece.start == start ? piece.at : after;
    before = stop == end ? piece.before : inside(piece, stop, end);
  };
  while (true) {
    CommonSegment segment{};
    segment.start = start;
    segment.end = std::min(end_of(left, i), end_of(right, j));
    side(left, i, segment.end, segment.left_at, segment.left_after, segment.left_before);
    side(right, j, segment.end, segment.right_at, segment.right_after, segment.right_before);
    visit(segment);
    if (segment.end == without_end) return;
    i += end_of(left, i) == segment.end;
    j += end_of(right, j) == segment.end;
    start = segment.end;
  }
}

double difference(double left, double right) { return left == right ? 0 : left - right; }

template <class Choose>
LinearSignal chosen(const LinearSignal& left, const LinearSignal& right, Choose choose) {
  Builder result;
  walk(left, right, [&](const CommonSegment& s) {
    const double at = choose(s.left_at, s.right_at);
    const double after = choose(s.left_after, s.right_after);
    const double before = choose(s.left_before, s.right_before);
    const double first = difference(s.left_after, s.right_after);
    const double last = difference(s.left_before, s.right_before);
    if ((first < 0 && last > 0) || (first > 0 && last < 0)) {
      const double share = first / (first - last);
      const double middle = s.start + (s.end - s.start) * share;
      if (middle > s.start && middle < s.end) {
        const double value = s.left_after + (s.left_before - s.left_after) * share;
        result.until(middle);
        result.add(s.start, at, after, value);
        result.until(s.end);
        result.add(middle, value, value, before);
        return;
      }
    }
    result.until(s.end);
    result.add(s.start, at, after, before);
  });
  return result.take();
}

// The largest value at each break and around it, while the break is strictly inside of the window.
LinearSignal inner_breaks(const LinearSignal& signal, const LinearWindow& window) {
  std::deque<std::size_t> candidates;
  const auto peak = [&](std::size_t n) {
    const double before = n == 0 ? -without_end : signal[n - 1].before;
    return std::max({signal[n].at, signal[n].after, before});
  };
  std::vector<double> peaks(signal.size());
  for (std::size_t n = 0; n < signal.size(); ++n) peaks[n] = peak(n);
  const auto enters = [&](std::size_t n) { return signal[n].start - window.last; };
  const auto leaves = [&](std::size_t n) { return signal[n].start - window.first; };
  std::size_t next = 0;
  const auto push = [&] {
    if (window.first == -without_end) {
      if (candidates.empty() || peaks[candidates.front()] < peaks[next]) candidates.assign(1, next);
    } else {
      while (!candidates.empty() && peaks[candidates.back()] <= peaks[next]) candidates.pop_back();
      candidates.push_back(next);
    }
    ++next;
  };
  const auto largest = [&] { return candidates.empty() ? -without_end : peaks[candidates.front()]; };
  while (next < signal.size() && enters(next) < 0) push();
  Builder result;
  double now = 0;
  while (true) {
    while (!candidates.empty() && leaves(candidates.front()) <= now) candidates.pop_front();
    const double at = largest();
    while (next < signal.size() && enters(next) <= now) push();
    while (!candidates.empty() && leaves(candidates.front()) <= now) candidates.pop_front();
    result.add(now, at, largest(), largest());
    double then = next < signal.size() ? enters(next) : without_end;
    if (!candidates.empty()) then = std::min(then, leaves(candidates.front()));
    if (then == without_end) return result.take();
    now = then;
  }
}

// The value of `strict_until` between two instants, seen in the direction of the witness: near and far end of f and g,
// and the value with which the far end is left. It is linear between some places from 0 (near) to 1 (far).
struct UntilSegment {
  double f_near, f_far, g_near, g_far, beyond;

  double f(double u) const { return f_near == f_far ? f_near : f_near + (f_far - f_near) * u; }
  double g(double u) const { return g_near == g_far ? g_near : g_near + (g_far - g_near) * u; }

  double value(double u) const {
    if (f_far >= f_near) return std::min(f(u), std::max({g(u), g_far, beyond}));
    return std::max(best_witness(u), std::min(f_far, beyond));
  }

  // f falls: the supremum of min(f, g) from u on.
  double best_witness(double u) const {
    if (g_far <= g_near || g(u) >= f(u)) return std::min(f(u), g(u));
    return g_far > f_far ? f(crossing(f_near, f_far, g_near, g_far)) : g_far;
  }

  // Where two lines cross, or 0.
  static double crossing(double left_near, double left_far, double right_near, double right_far) {
    const double near = difference(left_near, right_near);
    const double far = difference(left_far, right_far);
    return near * far < 0 && std::isfinite(near) && std::isfinite(far) ? near / (near - far) : 0;
  }

  // Only places that are strictly between the ends also in time.
  std::vector<double> places(double start, double end) const {
    const double level = f_far >= f_near ? std::max(g_far, beyond) : std::min(f_far, beyond);
    std::vector<double> result{0, 1, crossing(f_near, f_far, g_near, g_far), crossing(f_near, f_far, level, level),
                               crossing(g_near, g_far, level, level)};
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    std::erase_if(result, [&](double u) {
      const double time = start + (end - start) * u;
      return u > 0 && u < 1 && !(time > start && time < end);
    });
    return result;
  }
};

}  // namespace

LinearSignal constant_signal(double value) { return {{0, value, value, value}}; }

LinearSignal negated(LinearSignal signal) { return times(std::move(signal), -1); }

LinearSignal times(LinearSignal signal, double factor) {
  for (LinearPiece& piece : signal) {
    piece.at *= factor;
    piece.after *= factor;
    piece.before *= factor;
  }
  return signal;
}

LinearSignal plus(const LinearSignal& left, const LinearSignal& right) {
  Builder result;
  walk(left, right, [&](const CommonSegment& s) {
    result.until(s.end);
    result.add(s.start, s.left_at + s.right_at, s.left_after + s.right_after, s.left_before + s.right_before);
  });
  return result.take();
}

LinearSignal maximum(const LinearSignal& left, const LinearSignal& right) {
  return chosen(left, right, [](double l, double r) { return std::max(l, r); });
}

LinearSignal minimum(const LinearSignal& left, const LinearSignal& right) {
  return chosen(left, right, [](double l, double r) { return std::min(l, r); });
}

LinearSignal moved(const LinearSignal& signal, double offset) {
  LinearSignal result;
  if (offset < 0) result = constant_signal(-without_end);
  for (std::size_t n = 0; n < signal.size(); ++n) {
    LinearPiece piece = signal[n];
    const double end = end_of(signal, n);
    if (end <= offset) continue;
    if (piece.start < offset) piece.at = piece.after = inside(piece, end, offset);
    piece.start = std::max(piece.start - offset, 0.0);
    result.push_back(piece);
  }
  return result;
}

LinearSignal left_limits(LinearSignal signal) {
  double before = -without_end;
  for (LinearPiece& piece : signal) {
    piece.at = before;
    before = piece.before;
  }
  return signal;
}

LinearSignal spliced(const LinearSignal& left, const LinearSignal& right, double end) {
  LinearSignal result;
  for (std::size_t n = 0; n < left.size() && left[n].start <= end; ++n) {
    result.push_back(left[n]);
    if (end_of(left, n) > end) result.back().before = inside(left[n], end_of(left, n), end);
  }
  const double at = result.back().start == end ? result.back().at : result.back().before;
  if (result.back().start == end) result.pop_back();
  for (std::size_t n = 0; n < right.size(); ++n) {
    if (end_of(right, n) <= end) continue;
    LinearPiece piece = right[n];
    if (piece.start <= end) {
      if (piece.start < end) piece.after = inside(piece, end_of(right, n), end);
      piece.start = end;
      piece.at = at;
    }
    result.push_back(piece);
  }
  return result;
}

LinearSignal supremum(const LinearSignal& signal, const LinearWindow& window) {
  if (window.first == window.last) return moved(signal, window.first);
  // At its ends the window sees what is there, if they are closed, and the limits from its inside.
  LinearSignal result = inner_breaks(signal, window);
  if (window.first != -without_end) {
    LinearSignal first = signal;
    for (LinearPiece& piece : first) piece.at = window.first_closed ? std::max(piece.at, piece.after) : piece.after;
    result = maximum(result, moved(first, window.first));
  }
  if (window.last != without_end) {
    LinearSignal last = left_limits(signal);
    if (window.last_closed)
      for (std::size_t n = 0; n < last.size(); ++n) last[n].at = std::max(last[n].at, signal[n].at);
    result = maximum(result, moved(last, window.last));
  }
  return result;
}

LinearSignal strict_until(const LinearSignal& f, const LinearSignal& g) {
  std::vector<CommonSegment> segments;
  walk(f, g, [&](const CommonSegment& s) { segments.push_back(s); });
  LinearSignal reversed;
  double beyond = -without_end;
  for (std::size_t n = segments.size(); n-- > 0;) {
    const CommonSegment& s = segments[n];
    double first;  // the limit at the start of the segment
    if (s.end == without_end) {
      first = std::min(s.left_after, s.right_after);
      reversed.push_back({s.start, 0, first, first});
    } else {
      const UntilSegment piece{s.left_after, s.left_before, s.right_after, s.right_before, beyond};
      const std::vector<double> places = piece.places(s.start, s.end);
      double value = piece.value(1);
      for (std::size_t k = places.size() - 1; k-- > 0;) {
        const double here = piece.value(places[k]);
        reversed.push_back({s.start + (s.end - s.start) * places[k], here, here, value});
        value = here;
      }
      first = value;
    }
    reversed.back().at = std::min(s.left_at, first);
    beyond = std::max(s.right_at, reversed.back().at);
  }
  std::reverse(reversed.begin(), reversed.end());
  return reversed;
}

LinearSignal strict_since(const LinearSignal& f, const LinearSignal& g) {
  Builder result;
  double limit = -without_end;  // of the result from the left
  walk(f, g, [&](const CommonSegment& s) {
    const double at = std::min(s.left_at, limit);
    const double beyond = std::max(s.right_at, at);
    if (s.end == without_end) {
      const double value = std::min(s.left_after, std::max(s.right_after, beyond));
      result.add(s.start, at, value, value);
      return;
    }
    const UntilSegment piece{s.left_before, s.left_after, s.right_before, s.right_after, beyond};
    const std::vector<double> places = piece.places(s.start, s.end);
    double value = piece.value(1);
    for (std::size_t k = places.size() - 1; k-- > 0;) {
      const double here = piece.value(places[k]);
      const double start = s.start + (s.end - s.start) * (1 - places[k + 1]);
      result.until(s.start + (s.end - s.start) * (1 - places[k]));
      result.add(start, k + 2 == places.size() ? at : value, value, here);
      value = here;
    }
    limit = value;
  });
  return result.take();
}

}  // namespace tachk::monitoring::linear
