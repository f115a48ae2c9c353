#include "monitoring/linear/linear_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "monitoring/offline/value_ranges.hpp"

namespace tachk::monitoring::linear {

using offline::Stream;
using offline::StreamNode;
using offline::Truth;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

bool is_constant(const LinearSignal& signal) {
  return signal.size() == 1 && signal[0].at == signal[0].after && signal[0].after == signal[0].before;
}

// The offsets of a bounded or unbounded window ahead.
LinearWindow window_of(const MonitorNode& node) {
  return {static_cast<double>(node.lower), node.upper == unbounded ? without_end : static_cast<double>(node.upper),
          node.lower_closed, node.upper_closed};
}

LinearWindow reflected(const LinearWindow& window) {
  return {-window.last, -window.first, window.last_closed, window.first_closed};
}

bool is_empty(const LinearWindow& window) {
  return window.first > window.last || (window.first == window.last && !(window.first_closed && window.last_closed));
}

LinearSignal infimum(const LinearSignal& signal, const LinearWindow& window) {
  return negated(supremum(negated(signal), window));
}

// Calls visit(start, end, at, inner) for every instant and the open interval after it on which a condition on the sign
// of the signal does not change; end is infinite for the last one.
template <class Visit>
void visit_signs(const LinearSignal& signal, Visit visit) {
  for (std::size_t n = 0; n < signal.size(); ++n) {
    const LinearPiece& piece = signal[n];
    const double end = n + 1 < signal.size() ? signal[n + 1].start : without_end;
    if ((piece.after < 0 && piece.before > 0) || (piece.after > 0 && piece.before < 0)) {
      const double share = piece.after / (piece.after - piece.before);
      const double zero = std::clamp(piece.start + (end - piece.start) * share,
                                     std::nextafter(piece.start, without_end), std::nextafter(end, 0.0));
      visit(piece.start, zero, piece.at, piece.after);
      visit(zero, end, 0.0, piece.before);
    } else {
      // The sign inside is that of an end which is not zero.
      visit(piece.start, end, piece.at, piece.after != 0 ? piece.after : piece.before);
    }
  }
}

bool holds(Relation relation, double left_minus_right) {
  switch (relation) {
    case Relation::less:
      return left_minus_right < 0;
    case Relation::less_equal:
      return left_minus_right <= 0;
    case Relation::greater:
      return left_minus_right > 0;
    case Relation::greater_equal:
      return left_minus_right >= 0;
    case Relation::equal:
      return left_minus_right == 0;
    default:
      return left_minus_right != 0;
  }
}

}  // namespace

LinearMonitor::LinearMonitor(MonitorProgram program, RobustnessKind measure)
    : program_((validate(program), std::move(program))),
      measure_(measure),
      columns_(program_.columns),
      is_flag_(program_.columns, false),
      known_(program_.nodes.size()) {
  if (measure_ == RobustnessKind::space) {
    // Tried on a trace of one sample, in which every column may move.
    ticks_ = {0, 1};
    for (std::vector<double>& column : columns_) column = {1, 2};
    for (const MonitorAtom& what : program_.atoms) static_cast<void>(margin(what));
    ticks_.clear();
    for (std::vector<double>& column : columns_) column.clear();
  }
}

void LinearMonitor::push(const Samples& samples) {
  for (std::size_t n = 0; n < samples.count; ++n) {
    if (!ticks_.empty() && samples.ticks[n] < ticks_.back())
      throw std::invalid_argument("the times of a trace must not decrease");
    const bool again = !ticks_.empty() && samples.ticks[n] == ticks_.back();
    if (!again) ticks_.push_back(samples.ticks[n]);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const Column& column = samples.columns[c];
      is_flag_[c] = column.flags != nullptr;
      const double value = column.flags != nullptr ? (column.flags[n] != 0 ? 1.0 : 0.0) : column.numbers[n];
      if (again) columns_[c].pop_back();
      columns_[c].push_back(value);
    }
  }
}

void LinearMonitor::finish(std::int64_t end, std::int64_t most_parts) {
  if (ticks_.empty()) throw std::invalid_argument("a trace has at least one sample");
  if (end < ticks_.back()) throw std::invalid_argument("the end of a trace is not before its last sample");
  if (end - ticks_.front() > largest_tick) throw std::invalid_argument("the trace is too long for its ticks");
  end_ = end;
  std::int64_t reach = length() + 1;
  for (const MonitorNode& node : program_.nodes) reach += std::max(node.lower, node.upper);
  while (refinement_ < most_parts && reach < largest_tick / (20 * refinement_)) refinement_ *= 10;
  if (refinement_ < 2 && measure_ == RobustnessKind::space)
    throw std::invalid_argument("the trace is too long for its ticks");
}

// In ticks since the first sample; it holds its last value for ever.
LinearSignal LinearMonitor::column(std::size_t number) const {
  const std::vector<double>& values = columns_[number];
  const bool moves = !is_flag_[number];
  LinearSignal result;
  result.reserve(values.size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double next = moves && n + 1 < values.size() ? values[n + 1] : values[n];
    result.push_back({static_cast<double>(ticks_[n] - ticks_[0]), values[n], values[n], next});
  }
  return result;
}

LinearSignal LinearMonitor::value(const std::vector<ValueInstruction>& code) const {
  std::vector<LinearSignal> stack;
  for (const ValueInstruction& instruction : code) {
    if (instruction.operation == ValueOperator::constant) {
      stack.push_back(constant_signal(instruction.number));
      continue;
    }
    if (instruction.operation == ValueOperator::column) {
      stack.push_back(column(instruction.column));
      continue;
    }
    LinearSignal right = std::move(stack.back());
    stack.pop_back();
    if (instruction.operation == ValueOperator::negate) {
      stack.push_back(negated(std::move(right)));
      continue;
    }
    if (instruction.operation == ValueOperator::absolute) {
      stack.push_back(maximum(right, negated(right)));
      continue;
    }
    LinearSignal left = std::move(stack.back());
    stack.pop_back();
    switch (instruction.operation) {
      case ValueOperator::add:
        stack.push_back(plus(left, right));
        break;
      case ValueOperator::subtract:
        stack.push_back(plus(left, negated(std::move(right))));
        break;
      case ValueOperator::minimum:
        stack.push_back(minimum(left, right));
        break;
      case ValueOperator::maximum:
        stack.push_back(maximum(left, right));
        break;
      case ValueOperator::multiply:
        if (is_constant(left)) std::swap(left, right);
        if (!is_constant(right)) throw std::invalid_argument("a product of columns is not linear");
        stack.push_back(times(std::move(left), right[0].at));
        break;
      case ValueOperator::divide:
        if (!is_constant(right)) throw std::invalid_argument("a quotient of columns is not linear");
        stack.push_back(times(std::move(left), 1 / right[0].at));
        break;
      default:
        throw std::invalid_argument("% is not linear");
    }
  }
  return std::move(stack.back());
}

// Left minus right side.
LinearSignal LinearMonitor::margin(const MonitorAtom& atom) const {
  if (atom.relation == Relation::truth) return value(atom.left);
  LinearSignal result = plus(value(atom.left), negated(value(atom.right)));
  // Between samples, where lines of abs, min and max have their ends, both sides are rounded: what is 0 but for that
  // is 0.
  for (std::size_t n = 1; n < result.size(); ++n) {
    const auto next = std::upper_bound(ticks_.begin(), ticks_.end(), result[n].start, [&](double t, std::int64_t tick) {
      return t < static_cast<double>(tick - ticks_[0]);
    });
    const auto row = static_cast<std::size_t>(next - ticks_.begin()) - 1;
    if (static_cast<double>(ticks_[row] - ticks_[0]) == result[n].start) continue;
    const double rounding = 8 * epsilon * (magnitude(atom.left, row) + magnitude(atom.right, row));
    for (double* number : {&result[n - 1].before, &result[n].at, &result[n].after})
      if (std::abs(*number) <= rounding) *number = 0;
  }
  return result;
}

// How large numbers are on the way to a value, from a sample to the next one.
double LinearMonitor::magnitude(const std::vector<ValueInstruction>& code, std::size_t row) const {
  std::vector<double> stack;
  for (const ValueInstruction& instruction : code) {
    switch (instruction.operation) {
      case ValueOperator::constant:
        stack.push_back(std::abs(instruction.number));
        continue;
      case ValueOperator::column: {
        const std::vector<double>& values = columns_[instruction.column];
        stack.push_back(std::max(std::abs(values[row]), std::abs(values[std::min(row + 1, values.size() - 1)])));
        continue;
      }
      case ValueOperator::negate:
      case ValueOperator::absolute:
        continue;
      default:
        break;
    }
    const double right = stack.back();
    stack.pop_back();
    double& left = stack.back();
    if (instruction.operation == ValueOperator::multiply)
      left *= right;
    else if (instruction.operation == ValueOperator::divide)
      left /= right;
    else
      left += right;
  }
  return stack.back();
}

LinearSignal LinearMonitor::atom(const MonitorAtom& what) const {
  LinearSignal difference = margin(what);
  switch (what.relation) {
    case Relation::less:
    case Relation::less_equal:
      return negated(difference);
    case Relation::greater:
    case Relation::greater_equal:
      return difference;
    case Relation::equal:
      return minimum(difference, negated(difference));
    case Relation::not_equal:
      return maximum(difference, negated(difference));
    default: {
      LinearSignal result;
      const auto worth = [](double v) { return v != 0 ? without_end : -without_end; };
      visit_signs(difference, [&](double start, double, double at, double inner) {
        result.push_back({start, worth(at), worth(inner), worth(inner)});
      });
      return result;
    }
  }
}

// Continuous signals do not change; only flags and combinations of them jump.
LinearSignal LinearMonitor::changes(std::size_t number, double yes, double no) const {
  const MonitorAtom& what = program_.atoms[number];
  LinearSignal result{{0, no, no, no}};
  const auto change = [&](double start) { result.push_back({start, yes, no, no}); };
  if (measure_ == RobustnessKind::space) {
    const LinearSignal left = value(what.left);
    for (std::size_t n = 1; n < left.size(); ++n)
      if (left[n].at != left[n - 1].before) change(left[n].start);
  } else {
    const auto left =
        sampled<double>([&](AtomEvaluator& atoms, const Samples& samples, std::size_t first, std::size_t count,
                            double* out) { atoms.left_value(number, samples, first, count, out); });
    // Where columns may be shifted apart, a change of any of them may be one of the value.
    const std::vector<std::size_t> columns = offline::columns_of(what);
    const auto moves = [&](std::size_t n) {
      if (columns.size() < 2) return left[n] != left[n - 1];
      return std::any_of(columns.begin(), columns.end(),
                         [&](std::size_t column) { return columns_[column][n] != columns_[column][n - 1]; });
    };
    for (std::size_t n = 1; n < left.size(); ++n)
      if (moves(n)) change(static_cast<double>(ticks_[n] - ticks_[0]));
  }
  return result;
}

// The values that an evaluator of blocks computes from all samples.
template <class Value, class Evaluate>
std::vector<Value> LinearMonitor::sampled(Evaluate evaluate) const {
  std::vector<Column> view;
  view.reserve(columns_.size());
  for (const std::vector<double>& column : columns_) view.push_back({column.data(), nullptr});
  const Samples samples{ticks_.data(), view.data(), ticks_.size()};
  AtomEvaluator atoms(program_);
  std::vector<Value> result(ticks_.size());
  for (std::size_t first = 0; first < result.size(); first += AtomEvaluator::block)
    evaluate(atoms, samples, first, std::min(AtomEvaluator::block, result.size() - first), result.data() + first);
  return result;
}

// The segments in which one formula gives how long the truth of an atom lasts, or has lasted.
auto LinearMonitor::runs(std::size_t number) const -> std::vector<Run> {
  const auto holding =
      sampled<Truth>([&](AtomEvaluator& atoms, const Samples& samples, std::size_t first, std::size_t count,
                         Truth* out) { atoms.truth(number, samples, first, count, out); });
  const auto start_of = [&](std::size_t row) { return static_cast<double>(ticks_[row] - ticks_[0]); };
  std::vector<Run> result;
  if (offline::columns_of(program_.atoms[number]).size() < 2) {
    for (std::size_t row = 0; row < holding.size(); ++row) {
      if (row > 0 && holding[row] == holding[row - 1]) continue;
      if (row > 0) result.back().until = start_of(row);
      result.push_back({start_of(row), holding[row] != 0, start_of(row), std::nullopt});
    }
    return result;
  }
  // Columns may be shifted apart: then it lasts as long as it is certain for all values that each column has meanwhile.
  const std::size_t count = holding.size();
  const bool behind = measure_ == RobustnessKind::behind;
  std::vector<std::vector<double>> columns = columns_;
  std::vector<Truth> truths = holding;
  if (behind) {
    for (std::vector<double>& column : columns) std::reverse(column.begin(), column.end());
    std::reverse(truths.begin(), truths.end());
  }
  const std::vector<std::size_t> uncertain = offline::first_uncertain(program_.atoms[number], columns, truths);
  for (std::size_t row = 0; row < count; ++row) {
    Run run{start_of(row), holding[row] != 0, 0, std::nullopt};
    const std::size_t other = uncertain[behind ? count - 1 - row : row];
    if (behind) {
      run.since = other == count ? 0 : start_of(count - other);
    } else if (other < count) {
      run.until = start_of(other);
    }
    const bool goes_on = !result.empty() && result.back().truth == run.truth && result.back().since == run.since &&
                         result.back().until == run.until;
    if (!goes_on) result.push_back(run);
  }
  return result;
}

// How long the truth of an atom lasts. Behind the end of the trace it may last or not.
LinearSignal LinearMonitor::lasting(std::size_t number, bool high) const {
  const auto length = static_cast<double>(this->length());
  const std::vector<Run> runs = this->runs(number);
  LinearSignal result;
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const Run& run = runs[n];
    const double end = n + 1 == runs.size() ? length : runs[n + 1].start;
    const double sign = run.truth ? 1 : -1;
    if (measure_ == RobustnessKind::behind) {
      const double at = sign * (run.start - run.since);
      result.push_back({run.start, at, at, sign * (end - run.since)});
    } else if (!run.until && high == run.truth) {
      result.push_back({run.start, sign * without_end, sign * without_end, sign * without_end});
    } else {
      const double until = run.until.value_or(length);
      const double at = sign * (until - run.start);
      result.push_back({run.start, at, at, sign * (until - end)});
    }
  }
  if (result.back().before != result.back().after) {
    const double value = result.back().before;
    result.push_back({length, value, value, value});
  }
  return result;
}

// A change is worth 0, for it may come at another time; where there is none, minus the time to the next or since the
// last one. Behind the end of the trace there may be one or not.
LinearSignal LinearMonitor::far_from_changes(std::size_t number, bool high) const {
  const auto length = static_cast<double>(this->length());
  const LinearSignal found = changes(number, 1, 0);
  LinearSignal result;
  for (std::size_t n = 0; n < found.size(); ++n) {
    const bool last = n + 1 == found.size();
    const double start = found[n].start;
    const double gap = (last ? length : found[n + 1].start) - start;
    if (measure_ == RobustnessKind::behind) {
      result.push_back({start, 0, 0, -gap});
    } else {
      const double after = last && !high ? -without_end : -gap;
      result.push_back({start, n == 0 ? after : 0, after, last && !high ? -without_end : 0});
    }
  }
  if (result.back().before != result.back().after) {
    const double value = result.back().before;
    result.push_back({length, value, value, value});
  }
  return result;
}

LinearSignal LinearMonitor::robustness(std::size_t node, bool high) { return evaluate(node, high); }

LinearSignal LinearMonitor::evaluate(std::size_t number, bool high) {
  std::optional<LinearSignal>& known = known_[number][high ? 1 : 0];
  if (!known) known = computed(program_.nodes[number], high);
  return *known;
}

LinearSignal LinearMonitor::computed(const MonitorNode& node, bool high) {
  const auto operand = [&](std::size_t n) { return evaluate(node.operands[n], high); };
  const auto opposite = [&](std::size_t n) { return negated(evaluate(node.operands[n], !high)); };
  const auto until_the_end = [&](const LinearSignal& signal) {
    return spliced(signal, constant_signal(high ? without_end : -without_end), static_cast<double>(length()));
  };
  switch (node.kind) {
    case NodeKind::always_false:
    case NodeKind::always_true:
      return constant_signal(node.kind == NodeKind::always_true ? without_end : -without_end);
    case NodeKind::atom: {
      const bool space = measure_ == RobustnessKind::space;
      return until_the_end(space ? atom(program_.atoms[node.atom]) : lasting(node.atom, high));
    }
    case NodeKind::change:
      return until_the_end(measure_ == RobustnessKind::space ? changes(node.atom, without_end, -without_end)
                                                             : far_from_changes(node.atom, high));
    case NodeKind::logical_not:
      return opposite(0);
    case NodeKind::logical_and:
    case NodeKind::logical_or: {
      LinearSignal result = operand(0);
      for (std::size_t n = 1; n < node.operands.size(); ++n)
        result = node.kind == NodeKind::logical_and ? minimum(result, operand(n)) : maximum(result, operand(n));
      return result;
    }
    case NodeKind::rise:
      return minimum(operand(0), negated(left_limits(evaluate(node.operands[0], !high))));
    case NodeKind::fall:
      return minimum(opposite(0), left_limits(operand(0)));
    case NodeKind::eventually:
      return ahead(node, high, nullptr, operand(0));
    case NodeKind::always:
      return negated(ahead(node, !high, nullptr, negated(operand(0))));
    case NodeKind::once:
      return behind(node, nullptr, operand(0));
    case NodeKind::historically:
      return negated(behind(node, nullptr, negated(operand(0))));
    case NodeKind::until: {
      const LinearSignal f = operand(0);
      return ahead(node, high, &f, operand(1));
    }
    default: {
      const LinearSignal f = operand(0);
      return behind(node, &f, operand(1));
    }
  }
}

// The same decomposition as in `StreamGraph`; without f the operator is F.
LinearSignal LinearMonitor::ahead(const MonitorNode& node, bool high, const LinearSignal* f,
                                  const LinearSignal& g) const {
  const LinearWindow window = window_of(node);
  if (is_empty(window)) return constant_signal(-without_end);
  const auto lower = static_cast<double>(node.lower);
  const auto whole = [&](const LinearSignal& witness) {
    if (f == nullptr) return supremum(witness, window);
    LinearSignal core = strict_until(*f, witness);
    if (node.lower_closed) core = maximum(core, witness);
    if (node.lower > 0) core = minimum(moved(core, lower), infimum(*f, {0, lower, true, !node.lower_closed}));
    return node.upper == unbounded ? core : minimum(core, supremum(witness, window));
  };
  if (node.upper != unbounded) return whole(g);
  const auto length = static_cast<double>(this->length());
  const LinearSignal cut = whole(spliced(g, constant_signal(-without_end), length));
  const bool now = node.lower == 0 && node.lower_closed;
  return spliced(cut, high ? whole(g) : now ? g : constant_signal(-without_end), length);
}

LinearSignal LinearMonitor::behind(const MonitorNode& node, const LinearSignal* f, const LinearSignal& g) const {
  const LinearWindow window = reflected(window_of(node));
  if (is_empty(window)) return constant_signal(-without_end);
  if (f == nullptr) return supremum(g, window);
  LinearSignal core = strict_since(*f, g);
  if (node.lower_closed) core = maximum(core, g);
  if (node.lower > 0) {
    const auto lower = static_cast<double>(node.lower);
    core = minimum(moved(core, -lower), infimum(*f, reflected({0, lower, true, !node.lower_closed})));
  }
  return node.upper == unbounded ? core : minimum(core, supremum(g, window));
}

MonitorProgram LinearMonitor::refined() const {
  MonitorProgram result = program_;
  for (MonitorNode& node : result.nodes) {
    node.lower *= refinement_;
    if (node.upper != unbounded) node.upper *= refinement_;
  }
  return result;
}

// The truth of an atom, in cells of refined ticks.
void LinearMonitor::fill(const StreamNode& leaf, Stream<Truth>& out) const {
  const auto scale = static_cast<double>(refinement_);
  Cell previous = -2;
  // The start of a piece is a tick or a crossing strictly between two ticks.
  const auto cell_of = [&](double time) {
    Cell cell = cell_of_tick(static_cast<std::int64_t>(time) * refinement_);
    const double part = time - std::floor(time);
    if (part > 0) {
      const double parts = std::clamp(std::round(part * scale), 1.0, scale - 1);
      cell += cell_of_tick(static_cast<std::int64_t>(parts));
    }
    cell = std::max(cell, previous + 2);
    previous = cell;
    return cell;
  };
  const auto put = [&](double start, bool at, bool inner) {
    const Cell cell = cell_of(start);
    out.append(cell, at != leaf.dual);
    out.append(cell + 1, inner != leaf.dual);
  };
  if (leaf.kind == offline::StreamKind::change) {
    for (const LinearPiece& piece : changes(leaf.source, 1, 0)) put(piece.start, piece.at != 0, false);
    return;
  }
  const MonitorNode& node = program_.nodes[leaf.source];
  if (node.kind != NodeKind::atom) {
    out.append(0, (node.kind == NodeKind::always_true) != leaf.dual);
    return;
  }
  const MonitorAtom& what = program_.atoms[node.atom];
  const Relation relation = what.relation == Relation::truth ? Relation::not_equal : what.relation;
  visit_signs(margin(what), [&](double start, double, double at, double inner) {
    put(start, holds(relation, at), holds(relation, inner));
  });
}

LinearMonitor::Judgement LinearMonitor::truth() const {
  offline::OfflineMonitor<Truth> monitor(refined(), {true, {}}, offline::Leaves::single);
  monitor.evaluate(cell_of_tick(length() * refinement_),
                   [&](const StreamNode& leaf, Stream<Truth>& out) { fill(leaf, out); });
  return {monitor.verdict(), monitor.lasting(), monitor.violation()};
}

offline::Signal<Truth> LinearMonitor::truth_signal(std::size_t node) const {
  offline::OfflineMonitor<Truth> monitor(refined(), {false, {node}}, offline::Leaves::single);
  monitor.evaluate(cell_of_tick(length() * refinement_),
                   [&](const StreamNode& leaf, Stream<Truth>& out) { fill(leaf, out); });
  return monitor.signal(0);
}

}  // namespace tachk::monitoring::linear
