#include "monitoring/online/online_monitor.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "monitoring/online/online_rewriting.hpp"

namespace tachk::monitoring::online {

using offline::Robustness;

namespace {

constexpr std::size_t margin = 8;  // bytes before a block of truth values; the last one belongs to the sample before

std::uint64_t eight_at(const std::uint8_t* bytes) {
  std::uint64_t word;
  std::memcpy(&word, bytes, sizeof(word));
  return word;
}

MonitorProgram validated(MonitorProgram program) {
  validate(program);
  return program;
}

}  // namespace

OnlineMonitor::OnlineMonitor(MonitorProgram program, bool quantitative, bool all_violations)
    : program_(validated(std::move(program))),
      graph_(make_online_graph(program_)),
      evaluator_(program_),
      truth_(graph_, all_violations),
      earlier_{TruthEngine(graph_, all_violations), {}, 0},
      last_values_(program_.columns) {
  for (std::size_t n = 0; n < graph_.nodes.size(); ++n) {
    const OnlineNode& node = graph_.nodes[n];
    if (node.kind != OnlineKind::atom && node.kind != OnlineKind::change) continue;
    Leaf leaf;
    leaf.node = n;
    leaf.atom = node.atom;
    leaf.change = node.kind == OnlineKind::change;
    leaves_.push_back(leaf);
    block_.truths.emplace_back(leaf.change ? 0 : AtomEvaluator::block + 2 * margin);
    block_.values.emplace_back(leaf.change ? AtomEvaluator::block : 0);
  }
  for (const Leaf& leaf : leaves_)
    if (leaf.change) truth_.know(leaf.node, {0, 1}, false);
  truth_.step(-1, false);  // what holds without any sample
  if (quantitative) {
    margins_.whole = std::make_unique<offline::OfflineMonitor<Robustness>>(program_, offline::Requests{});
    if (std::optional<MonitorProgram> other = falling_sooner(program_))
      margins_.sooner = std::make_unique<offline::OfflineMonitor<Robustness>>(std::move(*other), offline::Requests{});
    margins_.waiting.columns.resize(program_.columns);
  }
}

void OnlineMonitor::check_time(std::int64_t tick) const {
  if (progress_.finished) throw std::invalid_argument("the trace is over");
  if (progress_.begun && tick < progress_.now) throw std::invalid_argument("time goes back");
  if (progress_.begun && tick - progress_.origin >= largest_tick / 2)
    throw std::invalid_argument("the trace is too long");
}

void OnlineMonitor::push(const Samples& samples) {
  bool ordered = true;
  for (std::size_t n = 1; n < samples.count; ++n) ordered &= samples.ticks[n - 1] <= samples.ticks[n];
  if (samples.count > 0) check_time(samples.ticks[0]);
  if (!ordered) throw std::invalid_argument("time goes back");
  push_ordered(samples);
}

void OnlineMonitor::push_ordered(const Samples& samples) {
  if (samples.count == 0) return;
  const std::int64_t least = samples.ticks[0];
  check_time(least);
  const std::int64_t last = samples.ticks[samples.count - 1];
  if (!progress_.begun) {
    if (least < -largest_tick || least > largest_tick) throw std::invalid_argument("the first time is too large");
    if (last - least >= largest_tick / 2) throw std::invalid_argument("the trace is too long");
    progress_.origin = progress_.now = least;
    progress_.begun = true;
  }
  check_time(last);
  follow_all(samples);
  progress_.now = last;
  progress_.known = cell_of(last);
  for (std::size_t n = 0; n < last_values_.size(); ++n) {
    const Column& column = samples.columns[n];
    const std::size_t row = samples.count - 1;
    last_values_[n] = column.numbers != nullptr ? column.numbers[row] : column.flags[row] != 0 ? 1.0 : 0.0;
  }
  if (margins_.whole) take_margins(samples);
}

// Samples come more often than bounds are requested, and margins are much faster in blocks. So samples wait until a
// block of them is there or a caller needs the result, which is the same.
void OnlineMonitor::take_margins(const Samples& samples) {
  constexpr std::size_t block = AtomEvaluator::block;
  if (margins_.waiting.ticks.size() + samples.count > block) catch_up();
  if (samples.count > block) {
    margins_.whole->push(samples);
    if (margins_.sooner) margins_.sooner->push(samples);
    return;
  }
  margins_.waiting.ticks.insert(margins_.waiting.ticks.end(), samples.ticks, samples.ticks + samples.count);
  for (std::size_t n = 0; n < margins_.waiting.columns.size(); ++n) {
    const Column& column = samples.columns[n];
    std::vector<double>& waiting = margins_.waiting.columns[n];
    if (column.numbers != nullptr) {
      waiting.insert(waiting.end(), column.numbers, column.numbers + samples.count);
    } else {
      for (std::size_t row = 0; row < samples.count; ++row) waiting.push_back(column.flags[row] != 0 ? 1.0 : 0.0);
    }
  }
}

void OnlineMonitor::catch_up() {
  if (margins_.waiting.ticks.empty()) return;
  std::vector<Column> columns(margins_.waiting.columns.size());
  for (std::size_t n = 0; n < columns.size(); ++n) columns[n].numbers = margins_.waiting.columns[n].data();
  const Samples samples{margins_.waiting.ticks.data(), columns.data(), margins_.waiting.ticks.size()};
  margins_.whole->push(samples);
  if (margins_.sooner) margins_.sooner->push(samples);
  margins_.waiting.ticks.clear();
  for (std::vector<double>& column : margins_.waiting.columns) column.clear();
}

offline::Range<Robustness> OnlineMonitor::robustness() {
  if (margins_.whole && !progress_.finished) {
    catch_up();
    narrow(margins_.whole->so_far());
    if (margins_.sooner) narrow({offline::Bounds<Robustness>::least, margins_.sooner->so_far().high});
  }
  narrow(margins_.robustness);
  return margins_.robustness;
}

// The range and the verdict are true, so are the bounds found before.
void OnlineMonitor::narrow(const offline::Range<Robustness>& range) {
  margins_.robustness.low = std::max(margins_.robustness.low, range.low);
  margins_.robustness.high = std::min(margins_.robustness.high, range.high);
  if (verdict() == Decision::yes) margins_.robustness.low = std::max(margins_.robustness.low, 0.0);
  if (verdict() == Decision::no) margins_.robustness.high = std::min(margins_.robustness.high, 0.0);
}

// Blocks are followed at once. When one has decided the verdict, its samples are followed again one by one, to find the
// decisive one, from a copy of the engine; copies are made so rarely that they cost less than the samples between them.
void OnlineMonitor::follow_all(const Samples& samples) {
  constexpr std::size_t block = AtomEvaluator::block;
  constexpr std::size_t worth_a_copy = 4;  // samples
  std::optional<std::size_t> copied;       // the block before which the copy was made
  for (std::size_t first = 0; first < samples.count && !truth_.settled(); first += block) {
    const std::size_t count = std::min(block, samples.count - first);
    evaluate(samples, first, count);
    if (truth_.verdict() != Decision::undetermined) {
      follow(samples, first, 0, count);
      continue;
    }
    const std::size_t pieces = samples.count < worth_a_copy ? SIZE_MAX : truth_.pieces();
    if (pieces / 64 > samples.count) {
      follow_singly(samples, first, count);
      continue;
    }
    if (!copied || 2 * (first - *copied) > pieces) {
      copied = first;
      earlier_.truth = truth_;
      earlier_.leaves = leaves_;
      earlier_.known = progress_.known;
    }
    follow(samples, first, 0, count);
    if (truth_.verdict() == Decision::undetermined) continue;
    std::swap(truth_, earlier_.truth);
    std::swap(leaves_, earlier_.leaves);
    progress_.known = earlier_.known;
    for (std::size_t again = *copied; again < first; again += block) {
      evaluate(samples, again, block);
      follow(samples, again, 0, block);
    }
    evaluate(samples, first, count);
    follow_singly(samples, first, count);
  }
}

void OnlineMonitor::follow_singly(const Samples& samples, std::size_t first, std::size_t count) {
  std::size_t n = 0;
  while (n < count && truth_.verdict() == Decision::undetermined) {
    follow(samples, first, n, n + 1);
    ++n;
  }
  if (truth_.verdict() == Decision::undetermined) return;
  decided_at_ = samples.ticks[first + n - 1];
  if (n < count) follow(samples, first, n, count);
}

// The values of the leaves at the samples of a block.
void OnlineMonitor::evaluate(const Samples& samples, std::size_t first, std::size_t count) {
  for (std::size_t n = 0; n < leaves_.size(); ++n) {
    const Leaf& leaf = leaves_[n];
    if (leaf.change) {
      evaluator_.left_value(leaf.atom, samples, first, count, block_.values[n].data());
    } else {
      block_.truths[n][margin - 1] = leaf.holds;
      evaluator_.truth(leaf.atom, samples, first, count, block_.truths[n].data() + margin);
    }
  }
}

// Hands the samples begin to before end of the evaluated block that begins at `first` to the engine.
void OnlineMonitor::follow(const Samples& samples, std::size_t first, std::size_t begin, std::size_t end) {
  const std::int64_t* ticks = samples.ticks + first;
  for (std::size_t n = 0; n < leaves_.size(); ++n) {
    if (leaves_[n].change) {
      follow_changes(leaves_[n], block_.values[n].data(), ticks, begin, end);
    } else {
      follow_atom(leaves_[n], block_.truths[n].data() + margin, ticks, begin, end);
    }
  }
  progress_.known = cell_of(ticks[end - 1]);
  truth_.step(progress_.known, false);
}

void OnlineMonitor::follow_atom(Leaf& leaf, const std::uint8_t* holds, const std::int64_t* ticks, std::size_t begin,
                                std::size_t end) {
  Cell start = progress_.known;
  bool value = leaf.holds != 0;
  const auto change_at = [&](std::size_t n) {
    const Cell cell = cell_of(ticks[n]);
    if (cell > start) truth_.know(leaf.node, {start, cell}, value);
    start = cell;
    value = !value;
  };
  std::size_t n = begin;
  if constexpr (std::endian::native == std::endian::little) {
    for (; n + 8 <= end; n += 8) {
      std::uint64_t differs = eight_at(holds + n) ^ eight_at(holds + n - 1);
      for (; differs != 0; differs &= differs - 1)
        change_at(n + static_cast<std::size_t>(std::countr_zero(differs)) / 8);
    }
  }
  for (; n < end; ++n)
    if (holds[n] != (value ? 1 : 0)) change_at(n);
  const Cell known = cell_of(ticks[end - 1]);
  if (known > start) truth_.know(leaf.node, {start, known}, value);
  leaf.holds = value ? 1 : 0;
}

void OnlineMonitor::follow_changes(Leaf& leaf, const double* values, const std::int64_t* ticks, std::size_t begin,
                                   std::size_t end) {
  Cell start = progress_.known;
  for (std::size_t n = begin; n < end; ++n) {
    const Cell cell = cell_of(ticks[n]);
    if (cell > start) {
      const bool changed = start > 0 && leaf.before != leaf.value;
      truth_.know(leaf.node, {start, start + 1}, changed);
      truth_.know(leaf.node, {start + 1, cell}, false);
      leaf.before = leaf.value;
      start = cell;
    }
    leaf.value = values[n];
  }
}

// Without a new sample: the last one goes on.
void OnlineMonitor::hold_until(Cell end) {
  for (Leaf& leaf : leaves_) {
    if (leaf.change) {
      truth_.know(leaf.node, {progress_.known, progress_.known + 1}, progress_.known > 0 && leaf.before != leaf.value);
      truth_.know(leaf.node, {progress_.known + 1, end}, false);
      leaf.before = leaf.value;
    } else {
      truth_.know(leaf.node, {progress_.known, end}, leaf.holds != 0);
    }
  }
  progress_.known = end;
}

void OnlineMonitor::advance(std::int64_t tick) {
  if (!progress_.begun) throw std::invalid_argument("the trace has not begun");
  const std::vector<double> values = last_values_;
  std::vector<Column> columns(values.size());
  for (std::size_t n = 0; n < columns.size(); ++n) columns[n].numbers = &values[n];
  push({&tick, columns.data(), 1});
}

void OnlineMonitor::finish(std::int64_t tick) {
  if (!progress_.begun) throw std::invalid_argument("the trace has not begun");
  check_time(tick);
  const bool undetermined = truth_.verdict() == Decision::undetermined;
  if (!truth_.settled()) {
    hold_until(cell_of(tick) + 1);
    truth_.step(cell_of(tick), true);
  }
  progress_.now = tick;
  if (undetermined && truth_.verdict() != Decision::undetermined) decided_at_ = tick;
  if (margins_.whole) {
    static_cast<void>(robustness());
    margins_.whole->finish(tick);
    narrow(margins_.whole->verdict());
  }
  margins_.sooner.reset();
  progress_.finished = true;
}

std::size_t OnlineMonitor::bytes() const {
  std::size_t total = sizeof(*this) + truth_.bytes() + earlier_.truth.bytes();
  for (const auto* margins : {margins_.whole.get(), margins_.sooner.get()})
    if (margins != nullptr) total += margins->bytes();
  total += margins_.waiting.ticks.capacity() * sizeof(std::int64_t);
  for (const auto& column : margins_.waiting.columns) total += column.capacity() * sizeof(double);
  for (const auto& block : block_.truths) total += block.capacity();
  for (const auto& block : block_.values) total += block.capacity() * sizeof(double);
  return total;
}

}  // namespace tachk::monitoring::online
