#include "monitoring/offline/offline_monitor.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace tachk::monitoring::offline {

namespace {

bool is_leaf(const StreamNode& node) { return node.kind == StreamKind::pointwise || node.kind == StreamKind::change; }

}  // namespace

template <class Value>
OfflineMonitor<Value>::OfflineMonitor(MonitorProgram program, Requests requests, Leaves leaves)
    : program_((validate(program), std::move(program))),
      requests_(std::move(requests)),
      graph_(program_, leaves),
      pointwise_(program_),
      left_values_(AtomEvaluator::block) {
  if (requests_.verdict) verdict_ = plan(program_.nodes.size() - 1, false);
  for (const std::size_t node : requests_.signals) side_.logs.push_back({graph_.stream_of(node, false), 0, {}, {}});

  for (std::size_t number = 0; number < graph_.streams().size(); ++number)
    if (is_leaf(graph_.streams()[number])) leaves_.push_back(number);
  begin(side_);
}

// Streams without any piece, and operators that have seen none.
template <class Value>
void OfflineMonitor<Value>::begin(Side& side) const {
  side.streams.resize(graph_.streams().size());
  side.operators.clear();
  side.changes.clear();
  for (const StreamNode& node : graph_.streams()) {
    side.operators.push_back(is_leaf(node) ? nullptr : make_operator<Value>(node));
    side.changes.emplace_back(node.dual);
  }
}

template <class Value>
void OfflineMonitor<Value>::restart() {
  for (Stream<Value>& stream : side_.streams) stream.restart();
  begin(side_);
  for (Fold& fold : side_.folds)
    fold = {fold.node,  fold.stream, fold.dual,
            fold.first, fold.last,   fold.dual ? Bounds<Value>::greatest : Bounds<Value>::least};
  for (SignalLog& log : side_.logs) log = {log.stream, 0, {}, {}};
  side_.end = {};
  lasting_.reset();
  position_ = {};
}

// The verdict of G f and F f needs no stream of its own, only the minimum or maximum of f.
template <class Value>
auto OfflineMonitor<Value>::plan(std::size_t number, bool negated) -> Term {
  const MonitorNode& node = program_.nodes[number];
  if (!graph_.is_pointwise(number)) {
    if (node.kind == NodeKind::logical_not) return plan(node.operands[0], !negated);
    if (node.kind == NodeKind::logical_and || node.kind == NodeKind::logical_or) {
      Term term{false, (node.kind == NodeKind::logical_and) != negated, 0, {}};
      for (const std::size_t operand : node.operands) term.operands.push_back(plan(operand, negated));
      return term;
    }
    const bool always = node.kind == NodeKind::always;
    const CellWindow window = future_window(node);
    if ((always || node.kind == NodeKind::eventually) && !window.empty) {
      const std::size_t operand = graph_.stream_of(node.operands[0], negated);
      // Beyond the end of the trace only windows with an end see anything.
      return fold(node.operands[0], operand, always != negated, window.even.first, window.even.last);
    }
  }
  return fold(number, graph_.stream_of(number, negated), true, 0, 0);
}

template <class Value>
auto OfflineMonitor<Value>::fold(std::size_t node, std::size_t stream, bool dual, Cell first, Cell last) -> Term {
  const Value start = dual ? Bounds<Value>::greatest : Bounds<Value>::least;
  side_.folds.push_back({node, stream, dual, first, last, start});
  return {true, false, side_.folds.size() - 1, {}};
}

template <class Value>
void OfflineMonitor<Value>::push(const Samples& samples) {
  for (std::size_t first = 0; first < samples.count; first += AtomEvaluator::block)
    feed(samples, first, std::min(AtomEvaluator::block, samples.count - first));
}

template <class Value>
void OfflineMonitor<Value>::feed(const Samples& samples, std::size_t first, std::size_t count) {
  const std::int64_t* ticks = samples.ticks + first;
  const bool rising = samples.rising || rises(ticks, count, position_);
  if (!position_.begun) position_ = {ticks[0], ticks[0], true};
  if (position_.origin < -largest_tick || position_.origin > largest_tick ||
      ticks[count - 1] > position_.origin + largest_tick)
    throw std::invalid_argument("the trace is too long for its ticks");
  position_.last = ticks[count - 1];
  side_.end.reached = cell_of_tick(position_.last - position_.origin);
  for (const std::size_t leaf : leaves_) {
    const StreamNode& node = graph_.streams()[leaf];
    Stream<Value>& out = side_.streams[leaf];
    if (node.kind == StreamKind::pointwise) {
      extend(out, pointwise_.evaluate(node, samples, first, count), ticks, count, position_.origin, rising);
    } else {
      pointwise_.atoms().left_value(node.source, samples, first, count, left_values_.data());
      side_.changes[leaf].extend(out, left_values_.data(), ticks, count, position_.origin);
    }
    out.frontier = side_.end.reached;
  }
  drain(side_);
}

// Lets every operator run once. Returns whether anything moved.
template <class Value>
bool OfflineMonitor<Value>::step(Side& side) {
  bool moved = false;
  std::array<const Stream<Value>*, 3> inputs{};
  for (std::size_t number = 0; number < side.operators.size(); ++number) {
    StreamOperator<Value>* const what = side.operators[number].get();
    if (what == nullptr) continue;
    const StreamNode& node = graph_.streams()[number];
    std::size_t before = 0;
    for (std::size_t n = 0; n < node.inputs.size(); ++n) {
      inputs[n] = &side.streams[node.inputs[n]];
      before += what->needed(n);
    }
    Stream<Value>& out = side.streams[number];
    const Cell frontier = out.frontier;
    what->advance({inputs.data(), node.inputs.size()}, side.end, out);
    for (std::size_t n = 0; n < node.inputs.size(); ++n) before -= what->needed(n);
    moved = moved || out.frontier != frontier || before != 0;
  }
  for (Fold& fold : side.folds) collect(fold, side);
  for (SignalLog& log : side.logs) record(log, side);
  return moved;
}

template <class Value>
void OfflineMonitor<Value>::drain(Side& side) {
  // Blocks are small enough for every operator to take in one step, unless it gives what it held back for long.
  bool more = true;
  while (more) {
    more = step(side);
    trim(side);
    if (more && !side.end.finished) {
      more = false;
      for (std::size_t number = 0; number < side.streams.size(); ++number)
        more = more || side.streams[number].end() - side.streams[number].begin() > 16 * AtomEvaluator::block;
    }
  }
}

template <class Value>
void OfflineMonitor<Value>::trim(Side& side) {
  std::vector<std::size_t>& needed = needed_;
  needed.assign(side.streams.size(), SIZE_MAX);
  for (std::size_t number = 0; number < side.operators.size(); ++number) {
    if (side.operators[number] == nullptr) continue;
    const StreamNode& node = graph_.streams()[number];
    for (std::size_t n = 0; n < node.inputs.size(); ++n)
      needed[node.inputs[n]] = std::min(needed[node.inputs[n]], side.operators[number]->needed(n));
  }
  for (const Fold& fold : side.folds)
    if (!fold.complete) needed[fold.stream] = std::min(needed[fold.stream], fold.at);
  for (const SignalLog& log : side.logs) needed[log.stream] = std::min(needed[log.stream], log.at);
  for (std::size_t number = 0; number < side.streams.size(); ++number) side.streams[number].trim(needed[number]);
}

template <class Value>
void OfflineMonitor<Value>::collect(Fold& fold, const Side& side) {
  if (fold.complete) return;
  const Stream<Value>& in = side.streams[fold.stream];
  // Without upper bound the fold ends with the trace.
  const Cell last = fold.last == endless && side.end.finished ? side.end.reached : fold.last;
  const Cell known = std::min(in.frontier, last == endless ? side.end.reached + 1 : last + 1);
  const Cell* starts = in.starts();
  const Value* values = in.values();
  const std::size_t stop = in.end();
  while (fold.at + 1 < stop && starts[fold.at + 1] <= fold.first && starts[fold.at + 1] < known) ++fold.at;
  if (known > fold.first && fold.at < stop) {
    const Value worst = fold.dual ? Bounds<Value>::least : Bounds<Value>::greatest;
    Value value = fold.value;
    std::size_t at = fold.at;
    // The current piece is looked at again in the next call: it may go on.
    const auto run = [&](auto join) {
      value = join(value, values[at]);
      while (at + 1 < stop && starts[at + 1] < known) value = join(value, values[++at]);
    };
    if (value != worst) {
      if (fold.dual) {
        run([](Value l, Value r) { return Lattice<Value, true>::join(l, r); });
      } else {
        run([](Value l, Value r) { return Lattice<Value, false>::join(l, r); });
      }
      if (value == worst) {
        for (at = fold.at; values[at] != worst;) ++at;
        fold.least_from = std::max(starts[at], fold.first);
      }
      fold.value = value;
    }
    fold.at = at;
    if (fold.least_from >= 0) {
      // Only the end of this piece is of interest still.
      if (fold.at + 1 < stop && starts[fold.at + 1] < known) {
        fold.least_to = starts[fold.at + 1];
        fold.complete = true;
      } else {
        fold.least_to = known;
      }
    }
  }
  if (last != endless && known > last) fold.complete = true;
}

template <class Value>
void OfflineMonitor<Value>::record(SignalLog& log, const Side& side) {
  const Stream<Value>& in = side.streams[log.stream];
  const Cell known = side.end.finished ? std::min(in.frontier, side.end.reached + 1) : in.frontier;
  for (; log.at < in.end() && in.starts()[log.at] < known; ++log.at) {
    log.starts.push_back(in.starts()[log.at]);
    log.values.push_back(in.values()[log.at]);
  }
}

template <class Value>
bool OfflineMonitor<Value>::settled() const {
  if (!side_.logs.empty()) return false;
  return std::all_of(side_.folds.begin(), side_.folds.end(), [](const Fold& fold) { return fold.complete; });
}

template <class Value>
std::size_t OfflineMonitor<Value>::bytes() const {
  std::size_t sum = 0;
  for (const Stream<Value>& stream : side_.streams) sum += stream.bytes();
  for (const auto& what : side_.operators) sum += what == nullptr ? 0 : what->bytes();
  for (const SignalLog& log : side_.logs) sum += log.starts.capacity() * (sizeof(Cell) + sizeof(Value));
  return sum;
}

template <class Value>
void OfflineMonitor<Value>::copy(const Side& side, Side& result) const {
  result.streams = side.streams;
  result.operators.clear();
  for (const auto& what : side.operators) result.operators.push_back(what == nullptr ? nullptr : what->clone());
  result.changes = side.changes;
  result.folds = side.folds;
  result.logs = side.logs;
  result.end = side.end;
}

template <class Value>
void OfflineMonitor<Value>::finish(std::int64_t end) {
  if (!position_.begun) throw std::invalid_argument("a trace has at least one sample");
  if (end < position_.last || end > position_.origin + largest_tick)
    throw std::invalid_argument("the end of a trace is not before its last sample");
  side_.end.reached = cell_of_tick(end - position_.origin);
  for (const std::size_t leaf : leaves_) {
    if (graph_.streams()[leaf].kind == StreamKind::change) side_.changes[leaf].settle(side_.streams[leaf]);
    side_.streams[leaf].frontier = side_.end.reached + 1;
  }
  close();
}

template <class Value>
void OfflineMonitor<Value>::evaluate(Cell last, const std::function<void(const StreamNode&, Stream<Value>&)>& fill) {
  side_.end.reached = last;
  for (const std::size_t leaf : leaves_) {
    fill(graph_.streams()[leaf], side_.streams[leaf]);
    side_.streams[leaf].frontier = last + 1;
  }
  close();
}

template <class Value>
void OfflineMonitor<Value>::close() {
  side_.end.finished = true;
  drain(side_);
  if (settled()) {  // nothing beyond the end counts
    low_.folds = side_.folds;
    return;
  }
  copy(side_, low_);
  const bool speaks_of_rest = requests_.verdict && requests_.lasting && side_.logs.empty();
  if (speaks_of_rest) copy(side_, held_);
  conclude(low_, TraceEnd::Beyond::least);
  conclude(side_, TraceEnd::Beyond::greatest);
  if (!speaks_of_rest) return;
  conclude(held_, TraceEnd::Beyond::held);
  lasting_ = value_of(verdict_, held_.folds);
}

template <class Value>
void OfflineMonitor<Value>::conclude(Side& side, TraceEnd::Beyond beyond) {
  side.end.beyond = beyond;
  const Value unknown = beyond == TraceEnd::Beyond::greatest ? Bounds<Value>::greatest : Bounds<Value>::least;
  for (const std::size_t leaf : leaves_) {
    if (beyond != TraceEnd::Beyond::held) {
      const StreamNode& node = graph_.streams()[leaf];
      const Value value = node.kind == StreamKind::pointwise ? pointwise_.with_all(node, unknown) : unknown;
      side.streams[leaf].append(side.end.reached + 1, value);
    }
    side.streams[leaf].frontier = endless;
  }
  drain(side);
  for (Stream<Value>& stream : side.streams) stream.restart();
  side.operators.clear();
}

template <class Value>
Value OfflineMonitor<Value>::value_of(const Term& term, const std::vector<Fold>& folds) const {
  if (term.leaf) return folds[term.fold].value;
  Value value = value_of(term.operands[0], folds);
  for (std::size_t n = 1; n < term.operands.size(); ++n) {
    const Value other = value_of(term.operands[n], folds);
    value = term.conjunction ? Lattice<Value, true>::join(value, other) : Lattice<Value, false>::join(value, other);
  }
  return value;
}

template <class Value>
Range<Value> OfflineMonitor<Value>::bounds_of(const Term& term) const {
  if (term.leaf) {
    const Fold& fold = side_.folds[term.fold];
    if (fold.complete) return {fold.value, fold.value};
    return fold.dual ? Range<Value>{Bounds<Value>::least, fold.value}
                     : Range<Value>{fold.value, Bounds<Value>::greatest};
  }
  Range<Value> range = bounds_of(term.operands[0]);
  for (std::size_t n = 1; n < term.operands.size(); ++n) {
    const Range<Value> other = bounds_of(term.operands[n]);
    if (term.conjunction) {
      range = {std::min(range.low, other.low), std::min(range.high, other.high)};
    } else {
      range = {std::max(range.low, other.low), std::max(range.high, other.high)};
    }
  }
  return range;
}

template <class Value>
Range<Value> OfflineMonitor<Value>::verdict() const {
  return {value_of(verdict_, low_.folds), value_of(verdict_, side_.folds)};
}

template <class Value>
void OfflineMonitor<Value>::find_violation(const Term& term, const std::vector<Fold>& folds,
                                           std::optional<FirstViolation>& earliest) const {
  if (term.leaf) {
    const Fold& fold = folds[term.fold];
    if (!fold.dual || fold.least_from < 0) return;
    if (!earliest || fold.least_from < earliest->first) earliest = {fold.node, fold.least_from, fold.least_to - 1};
  } else if (term.conjunction) {
    for (const Term& operand : term.operands) find_violation(operand, folds, earliest);
  }
}

template <class Value>
std::optional<FirstViolation> OfflineMonitor<Value>::violation() const {
  std::optional<FirstViolation> earliest;
  find_violation(verdict_, side_.folds, earliest);
  if (!earliest && verdict().high == Bounds<Value>::least) earliest = {program_.nodes.size() - 1, 0, 0};
  return earliest;
}

template <class Value>
Signal<Value> OfflineMonitor<Value>::signal(std::size_t number) const {
  const SignalLog& low = low_.logs[number];
  const SignalLog& high = side_.logs[number];
  Signal<Value> result;
  std::size_t i = 0;
  std::size_t j = 0;
  Cell cell = 0;
  while (true) {
    result.starts.push_back(cell);
    result.low.push_back(low.values[i]);
    result.high.push_back(high.values[j]);
    const Cell next_low = i + 1 < low.starts.size() ? low.starts[i + 1] : endless;
    const Cell next_high = j + 1 < high.starts.size() ? high.starts[j + 1] : endless;
    cell = std::min(next_low, next_high);
    if (cell == endless) return result;
    i += next_low == cell;
    j += next_high == cell;
  }
}

template class OfflineMonitor<Truth>;
template class OfflineMonitor<Robustness>;

}  // namespace tachk::monitoring::offline
