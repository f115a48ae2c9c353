#include "monitoring/online/online_monitor.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "monitoring/online/online_rewriting.hpp"

namespace tachk {
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

OnlineMonitor::OnlineMonitor(MonitorProgram program, bool quantitative)
    : program_(validated(std::move(program))),
      graph_(make_online_graph(program_)),
      evaluator_(program_),
      truth_(graph_),
      earlier_truth_(graph_),
      last_values_(program_.columns) {
  for (std::size_t n = 0; n < graph_.nodes.size(); ++n) {
    const OnlineNode& node = graph_.nodes[n];
    if (node.kind != OnlineKind::atom && node.kind != OnlineKind::change) continue;
    Leaf leaf;
    leaf.node = n;
    leaf.atom = node.atom;
    leaf.change = node.kind == OnlineKind::change;
    leaves_.push_back(leaf);
    truths_.emplace_back(leaf.change ? 0 : AtomEvaluator::block + 2 * margin);
    values_.emplace_back(leaf.change ? AtomEvaluator::block : 0);
  }
  for (const Leaf& leaf : leaves_)
    if (leaf.change) truth_.know(leaf.node, {0, 1}, false);
  truth_.step(-1, false);  // what holds without any sample
  if (quantitative) {
    margins_ = std::make_unique<OfflineMonitor<Robustness>>(program_, Requests{});
    if (std::optional<MonitorProgram> other = falling_sooner(program_))
      sooner_ = std::make_unique<OfflineMonitor<Robustness>>(std::move(*other), Requests{});
    waiting_.columns.resize(program_.columns);
  }
}

void OnlineMonitor::check_time(std::int64_t tick) const {
  if (finished_) throw std::invalid_argument("the trace is over");
  if (begun_ && tick < now_) throw std::invalid_argument("time goes back");
  if (begun_ && tick - origin_ >= largest_tick / 2) throw std::invalid_argument("the trace is too long");
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
  if (!begun_) {
    if (least < -largest_tick || least > largest_tick) throw std::invalid_argument("the first time is too large");
    if (last - least >= largest_tick / 2) throw std::invalid_argument("the trace is too long");
    origin_ = now_ = least;
    begun_ = true;
  }
  check_time(last);
  follow_all(samples);
  now_ = last;
  known_ = cell_of(last);
  for (std::size_t n = 0; n < last_values_.size(); ++n) {
    const Column& column = samples.columns[n];
    const std::size_t row = samples.count - 1;
    last_values_[n] = column.numbers != nullptr ? column.numbers[row] : column.flags[row] != 0 ? 1.0 : 0.0;
  }
  if (margins_) take_margins(samples);
}

// Samples come more often than bounds are asked for, and margins are much faster in blocks. So samples wait until a
// block of them is there or somebody asks; what is found is the same.
void OnlineMonitor::take_margins(const Samples& samples) {
  constexpr std::size_t block = AtomEvaluator::block;
  if (waiting_.ticks.size() + samples.count > block) catch_up();
  if (samples.count > block) {
    margins_->push(samples);
    if (sooner_) sooner_->push(samples);
    return;
  }
  waiting_.ticks.insert(waiting_.ticks.end(), samples.ticks, samples.ticks + samples.count);
  for (std::size_t n = 0; n < waiting_.columns.size(); ++n) {
    const Column& column = samples.columns[n];
    std::vector<double>& waiting = waiting_.columns[n];
    if (column.numbers != nullptr) {
      waiting.insert(waiting.end(), column.numbers, column.numbers + samples.count);
    } else {
      for (std::size_t row = 0; row < samples.count; ++row) waiting.push_back(column.flags[row] != 0 ? 1.0 : 0.0);
    }
  }
}

void OnlineMonitor::catch_up() {
  if (waiting_.ticks.empty()) return;
  std::vector<Column> columns(waiting_.columns.size());
  for (std::size_t n = 0; n < columns.size(); ++n) columns[n].numbers = waiting_.columns[n].data();
  const Samples samples{waiting_.ticks.data(), columns.data(), waiting_.ticks.size()};
  margins_->push(samples);
  if (sooner_) sooner_->push(samples);
  waiting_.ticks.clear();
  for (std::vector<double>& column : waiting_.columns) column.clear();
}

Range<Robustness> OnlineMonitor::robustness() {
  if (margins_ && !finished_) {
    catch_up();
    narrow(margins_->so_far());
    if (sooner_) narrow({Bounds<Robustness>::least, sooner_->so_far().high});
  }
  narrow(robustness_);
  return robustness_;
}

// What the range and the verdict say is true, so are the bounds found before.
void OnlineMonitor::narrow(const Range<Robustness>& range) {
  robustness_.low = std::max(robustness_.low, range.low);
  robustness_.high = std::min(robustness_.high, range.high);
  if (verdict() == Decision::yes) robustness_.low = std::max(robustness_.low, 0.0);
  if (verdict() == Decision::no) robustness_.high = std::min(robustness_.high, 0.0);
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
      earlier_truth_ = truth_;
      earlier_leaves_ = leaves_;
      earlier_known_ = known_;
    }
    follow(samples, first, 0, count);
    if (truth_.verdict() == Decision::undetermined) continue;
    std::swap(truth_, earlier_truth_);
    std::swap(leaves_, earlier_leaves_);
    known_ = earlier_known_;
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

// What the leaves are at the samples of a block.
void OnlineMonitor::evaluate(const Samples& samples, std::size_t first, std::size_t count) {
  for (std::size_t n = 0; n < leaves_.size(); ++n) {
    const Leaf& leaf = leaves_[n];
    if (leaf.change) {
      evaluator_.left_value(leaf.atom, samples, first, count, values_[n].data());
    } else {
      truths_[n][margin - 1] = leaf.holds;
      evaluator_.truth(leaf.atom, samples, first, count, truths_[n].data() + margin);
    }
  }
}

// Hands the samples begin to before end of the evaluated block that begins at `first` to the engine.
void OnlineMonitor::follow(const Samples& samples, std::size_t first, std::size_t begin, std::size_t end) {
  const std::int64_t* ticks = samples.ticks + first;
  for (std::size_t n = 0; n < leaves_.size(); ++n) {
    if (leaves_[n].change) {
      follow_changes(leaves_[n], values_[n].data(), ticks, begin, end);
    } else {
      follow_atom(leaves_[n], truths_[n].data() + margin, ticks, begin, end);
    }
  }
  known_ = cell_of(ticks[end - 1]);
  truth_.step(known_, false);
}

void OnlineMonitor::follow_atom(Leaf& leaf, const std::uint8_t* holds, const std::int64_t* ticks, std::size_t begin,
                                std::size_t end) {
  Cell start = known_;
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
  Cell start = known_;
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
      truth_.know(leaf.node, {known_, known_ + 1}, known_ > 0 && leaf.before != leaf.value);
      truth_.know(leaf.node, {known_ + 1, end}, false);
      leaf.before = leaf.value;
    } else {
      truth_.know(leaf.node, {known_, end}, leaf.holds != 0);
    }
  }
  known_ = end;
}

void OnlineMonitor::advance(std::int64_t tick) {
  if (!begun_) throw std::invalid_argument("the trace has not begun");
  const std::vector<double> values = last_values_;
  std::vector<Column> columns(values.size());
  for (std::size_t n = 0; n < columns.size(); ++n) columns[n].numbers = &values[n];
  push({&tick, columns.data(), 1});
}

void OnlineMonitor::finish(std::int64_t tick) {
  if (!begun_) throw std::invalid_argument("the trace has not begun");
  check_time(tick);
  const bool undetermined = truth_.verdict() == Decision::undetermined;
  if (!truth_.settled()) {
    hold_until(cell_of(tick) + 1);
    truth_.step(cell_of(tick), true);
  }
  now_ = tick;
  if (undetermined && truth_.verdict() != Decision::undetermined) decided_at_ = tick;
  if (margins_) {
    static_cast<void>(robustness());
    margins_->finish(tick);
    narrow(margins_->verdict());
  }
  sooner_.reset();
  finished_ = true;
}

std::size_t OnlineMonitor::bytes() const {
  std::size_t total = sizeof(*this) + truth_.bytes() + earlier_truth_.bytes();
  for (const auto* margins : {margins_.get(), sooner_.get()})
    if (margins != nullptr) total += margins->bytes();
  total += waiting_.ticks.capacity() * sizeof(std::int64_t);
  for (const auto& column : waiting_.columns) total += column.capacity() * sizeof(double);
  for (const auto& block : truths_) total += block.capacity();
  for (const auto& block : values_) total += block.capacity() * sizeof(double);
  return total;
}

}  // namespace tachk
