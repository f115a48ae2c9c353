#include "monitoring/offline/value_ranges.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

namespace tachk::monitoring::offline {
namespace {

struct Interval {
  double low;
  double high;
  bool is_point() const { return low == high; }
};

constexpr Interval any_value{Bounds<double>::least, Bounds<double>::greatest};

// Of values of which at least one may be undefined.
Interval around(std::initializer_list<double> corners) {
  for (const double corner : corners)
    if (std::isnan(corner)) return any_value;
  return {std::min(corners), std::max(corners)};
}

Interval combined(ValueOperator operation, const Interval& l, const Interval& r) {
  switch (operation) {
    case ValueOperator::add:
      return around({l.low + r.low, l.high + r.high});
    case ValueOperator::subtract:
      return around({l.low - r.high, l.high - r.low});
    case ValueOperator::multiply:
      return around({l.low * r.low, l.low * r.high, l.high * r.low, l.high * r.high});
    case ValueOperator::divide:
      if (r.low <= 0 && r.high >= 0) return any_value;
      return around({l.low / r.low, l.low / r.high, l.high / r.low, l.high / r.high});
    case ValueOperator::minimum:
      return {std::min(l.low, r.low), std::min(l.high, r.high)};
    case ValueOperator::maximum:
      return {std::max(l.low, r.low), std::max(l.high, r.high)};
    default:
      if (l.is_point() && r.is_point()) return around({std::fmod(l.low, r.low)});
      return any_value;
  }
}

// Intervals of the columns by their numbers.
Interval value_of(const std::vector<ValueInstruction>& code, const std::vector<Interval>& columns) {
  std::vector<Interval> stack;
  for (const ValueInstruction& instruction : code) {
    if (instruction.operation == ValueOperator::constant) {
      stack.push_back({instruction.number, instruction.number});
    } else if (instruction.operation == ValueOperator::column) {
      stack.push_back(columns[instruction.column]);
    } else if (instruction.operation == ValueOperator::negate) {
      stack.back() = {-stack.back().high, -stack.back().low};
    } else if (instruction.operation == ValueOperator::absolute) {
      const Interval value = stack.back();
      const double least = std::max({value.low, -value.high, 0.0});
      stack.back() = {least, std::max(-value.low, value.high)};
    } else {
      const Interval right = stack.back();
      stack.pop_back();
      stack.back() = combined(instruction.operation, stack.back(), right);
    }
  }
  return stack.back();
}

// The truth of the atom if it is the same for all values.
std::optional<bool> certainly(const MonitorAtom& atom, const std::vector<Interval>& columns) {
  const Interval l = value_of(atom.left, columns);
  const Interval r = atom.relation == Relation::truth ? Interval{0, 0} : value_of(atom.right, columns);
  const auto known = [](bool always, bool never) -> std::optional<bool> {
    return always ? std::optional(true) : never ? std::optional(false) : std::nullopt;
  };
  const bool same = l.is_point() && r.is_point() && l.low == r.low;
  const bool apart = l.high < r.low || r.high < l.low;
  switch (atom.relation) {
    case Relation::less:
      return known(l.high < r.low, l.low >= r.high);
    case Relation::less_equal:
      return known(l.high <= r.low, l.low > r.high);
    case Relation::greater:
      return known(l.low > r.high, l.high <= r.low);
    case Relation::greater_equal:
      return known(l.low >= r.high, l.high < r.low);
    case Relation::equal:
      return known(same, apart);
    default:  // other than 0, or not equal
      return known(apart, same);
  }
}

// The least and the greatest value of a column in a segment of samples of which both ends only move on.
class SlidingRange {
 public:
  explicit SlidingRange(const std::vector<double>& values) : values_(&values) {}

  Interval with(double value) const {
    if (least_.empty()) return {value, value};
    return {std::min((*values_)[least_.front()], value), std::max((*values_)[greatest_.front()], value)};
  }
  void add(std::size_t row) {
    const double value = (*values_)[row];
    while (!least_.empty() && (*values_)[least_.back()] >= value) least_.pop_back();
    while (!greatest_.empty() && (*values_)[greatest_.back()] <= value) greatest_.pop_back();
    least_.push_back(row);
    greatest_.push_back(row);
  }
  void forget_before(std::size_t row) {
    while (!least_.empty() && least_.front() < row) least_.pop_front();
    while (!greatest_.empty() && greatest_.front() < row) greatest_.pop_front();
  }

 private:
  const std::vector<double>* values_;
  std::deque<std::size_t> least_;
  std::deque<std::size_t> greatest_;
};

}  // namespace

std::vector<std::size_t> columns_of(const MonitorAtom& atom) {
  std::vector<std::size_t> columns;
  for (const auto* code : {&atom.left, &atom.right})
    for (const ValueInstruction& instruction : *code)
      if (instruction.operation == ValueOperator::column) columns.push_back(instruction.column);
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

std::vector<std::size_t> first_uncertain(const MonitorAtom& atom, const std::vector<std::vector<double>>& columns,
                                         const std::vector<Truth>& holding) {
  std::vector<SlidingRange> ranges(columns.begin(), columns.end());
  const std::vector<std::size_t> used = columns_of(atom);
  std::vector<Interval> box(columns.size());
  std::vector<std::size_t> result(holding.size());
  std::size_t end = 0;
  const auto take = [&] {
    for (const std::size_t column : used) ranges[column].add(end);
    ++end;
  };
  for (std::size_t row = 0; row < holding.size(); ++row) {
    for (const std::size_t column : used) ranges[column].forget_before(row);
    if (end == row) take();
    while (end < holding.size()) {
      for (const std::size_t column : used) box[column] = ranges[column].with(columns[column][end]);
      if (certainly(atom, box) != (holding[row] != 0)) break;
      take();
    }
    result[row] = end;
  }
  return result;
}

}  // namespace tachk::monitoring::offline
