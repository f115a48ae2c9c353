#include "flow/crossings.hpp"

#include <algorithm>
#include <cmath>

namespace tachk::flow {

using program::FlowTest;

namespace {

using Kind = FlowTest::Kind;

constexpr double closeness = 1e-6;

bool strict(Kind kind) { return kind == Kind::less || kind == Kind::greater || kind == Kind::not_equal; }

Ticks ticks(double number) {
  return std::fabs(number) < static_cast<double>(latest_end) ? static_cast<Ticks>(number)
                                                             : (number > 0 ? never : -never);
}

}  // namespace

Crossings::Sides Crossings::sides(const FlowTest& test) {
  double left = machine::double_at(slots_ + machine_.value(test.left, slots_));
  double right = machine::double_at(slots_ + machine_.value(test.right, slots_));
  if (test.kind == Kind::greater || test.kind == Kind::greater_equal) std::swap(left, right);
  return {left - right, std::max({1.0, std::fabs(left), std::fabs(right)})};
}

Crossings::ConditionValue Crossings::value(const FlowTest& test) {
  if (test.kind == Kind::truth) {
    const bool holds = machine_.value(test.left, slots_) != 0;
    return {holds, holds, holds};
  }
  const auto [difference, scale] = sides(test);
  const bool positive = difference > 0;
  switch (test.kind) {
    case Kind::less:
    case Kind::greater:
      return {difference < 0, difference < 0, positive};
    case Kind::not_equal:
      return {difference != 0, difference != 0, positive};
    case Kind::equal:
      return {difference == 0, std::fabs(difference) <= closeness * scale, positive};
    default:
      return {difference <= 0, difference <= closeness * scale, positive};
  }
}

bool Crossings::hold(std::span<const FlowTest> tests) {
  return std::all_of(tests.begin(), tests.end(), [&](const FlowTest& test) { return value(test).close; });
}

// ---- lines ----------------------------------------------------------------------------------------------------------

bool Crossings::solvable(std::span<const FlowTest> tests) const {
  return flow_.linear() && std::all_of(tests.begin(), tests.end(), [](const FlowTest& test) { return test.affine; });
}

// The first interval in which an affine condition holds. At the moment after a crossing both what ends and what begins
// with it hold.
Window Crossings::solved(const FlowTest& test, Ticks from) {
  flow_.show(from, machine_, slots_);
  const auto [now, scale] = sides(test);
  const ConditionValue holds = value(test);
  flow_.show(from + flow_.ticks_per_unit(), machine_, slots_);
  const double slope = (sides(test).difference - now) / static_cast<double>(flow_.ticks_per_unit());
  const Window always{from, never};
  const Window nowhere{never, -never};
  if (slope == 0) return holds.close ? always : nowhere;
  const double root = -now / slope;
  const Ticks behind = root < 0 ? -never : std::min(never, from + ticks(std::ceil(root)));
  switch (test.kind) {
    case Kind::equal:
      if (holds.close) return {from, from};
      return behind > from ? Window{behind, behind} : nowhere;
    case Kind::not_equal:
      return holds.exact ? always : Window{from + 1, never};
    case Kind::less:
    case Kind::greater:
      if (slope > 0) return holds.exact ? Window{from, std::max(from, behind - 1)} : nowhere;
      return holds.exact ? always : Window{from + ticks(std::floor(root)) + 1, never};
    default:
      if (slope < 0) return holds.close ? always : Window{behind, never};
      if (holds.exact) return {from, std::max(from, behind)};
      return holds.close ? Window{from, from} : nowhere;
  }
}

Window Crossings::solved(std::span<const FlowTest> tests, Ticks from) {
  Window all{from, never};
  for (const FlowTest& test : tests) {
    const Window one = solved(test, from);
    all.first = std::max(all.first, one.first);
    all.last = std::min(all.last, one.last);
  }
  return all;
}

// ---- looking --------------------------------------------------------------------------------------------------------

// The first moment of (before, after] at which the condition differs from what it is at `before`, where it does so at
// `after`.
template <class Differs>
Ticks Crossings::first_different(const FlowTest& test, Ticks before, Ticks after, Differs differs) {
  while (after - before > 1) {
    const Ticks middle = before + (after - before) / 2;
    (differs(value_at(test, middle)) ? after : before) = middle;
  }
  return after;
}

// Finds the moments at which some condition changes, and the last ones before.
void Crossings::crossings(std::span<const FlowTest> tests, Ticks before, Ticks after) {
  candidates_.clear();
  for (std::size_t n = 0; n < tests.size(); ++n) {
    const ConditionValue was = values_[n];
    const ConditionValue is = value_at(tests[n], after);
    const bool by_sign = tests[n].kind == Kind::equal;
    if (by_sign ? was.positive != is.positive : was.exact != is.exact) {
      const Ticks changed = first_different(tests[n], before, after, [&](const ConditionValue& then) {
        return by_sign ? then.positive != was.positive : then.exact != was.exact;
      });
      if (changed - 1 > before) candidates_.push_back(changed - 1);
      candidates_.push_back(changed);
    }
    values_[n] = is;
  }
  std::sort(candidates_.begin(), candidates_.end());
}

Crossings::Found Crossings::opening(std::span<const FlowTest> tests, Ticks from, Ticks last, Ticks lookahead) {
  if (solvable(tests)) {
    const Window window = solved(tests, from);
    return {window.empty() || window.first > last ? never : window.first, never};
  }
  const Ticks end = flow_.known_up_to(std::min(last, lookahead), machine_, slots_);
  const Ticks seen = end >= last ? never : std::max(end, from);
  flow_.show(from, machine_, slots_);
  if (hold(tests)) return {from, never};
  values_.clear();
  for (const FlowTest& test : tests) values_.push_back(value(test));
  for (Ticks before = from; before < end;) {
    const Ticks after = std::min(before + sample(), end);
    crossings(tests, before, after);
    if (before + sample() >= end || after == end) candidates_.push_back(after);
    for (const Ticks moment : candidates_) {
      flow_.show(moment, machine_, slots_);
      if (hold(tests)) return {moment, never};
    }
    before = after;
  }
  return {never, seen};
}

Crossings::Found Crossings::ending(std::span<const FlowTest> tests, Ticks from, Ticks lookahead) {
  if (solvable(tests)) return {solved(tests, from).last, never};
  flow_.show(from, machine_, slots_);
  values_.clear();
  for (const FlowTest& test : tests) values_.push_back(value(test));
  Ticks before = from;
  while (before < lookahead) {
    const Ticks after = flow_.known_up_to(std::min(before + sample(), lookahead), machine_, slots_);
    if (after <= before) break;
    Ticks least = never;
    for (std::size_t n = 0; n < tests.size(); ++n) {
      const bool exactly = values_[n].exact;
      const ConditionValue is = value_at(tests[n], after);
      if (exactly ? !is.exact : !is.close) {
        const Ticks broken = first_different(
            tests[n], before, after, [&](const ConditionValue& then) { return exactly ? !then.exact : !then.close; });
        const bool crossed = exactly && tests[n].kind != Kind::truth && !strict(tests[n].kind);
        least = std::min(least, crossed ? broken : broken - 1);
      }
      values_[n] = is;
    }
    if (least < never) return {least, never};
    before = after;
  }
  return {never, std::max(before, from)};
}

}  // namespace tachk::flow
