#include "monitoring/online/online_truth.hpp"

#include <algorithm>

namespace tachk::monitoring::online {
namespace {

// Appends the cells of `spans` that are in `set`.
void intersect(const std::vector<Span>& spans, const SpanSet& set, std::vector<Span>& out) {
  std::size_t n = 0;
  for (const Span& span : spans) {
    n = set.find(span.first, n);
    for (; n < set.size() && set[n].first < span.end; ++n) {
      out.push_back({std::max(span.first, set[n].first), std::min(span.end, set[n].end)});
      if (set[n].end > span.end) break;
    }
  }
}

// Of a strict until: a witness at an instant asks for the left side before it, one between instants also around it.
Cell last_needed(Cell witness) { return is_instant(witness) ? witness - 1 : witness; }
Cell first_needed(Cell witness) { return is_instant(witness) ? witness + 1 : witness; }

}  // namespace

TruthEngine::TruthEngine(const OnlineGraph& graph, bool all_violations)
    : graph_(&graph), states_(graph.nodes.size()), all_violations_(all_violations) {
  if (graph.is_everywhere_ahead(graph.root)) guarded_ = !graph.nodes[graph.root.node].left;
  for (std::size_t n = 0; n < states_.size(); ++n) {
    const OnlineNode& node = graph.nodes[n];
    const bool leaf = node.kind == OnlineKind::atom || node.kind == OnlineKind::change;
    states_[n].watched = {!leaf, !leaf};
    const bool of_time = node.kind == OnlineKind::strict_until || node.kind == OnlineKind::strict_since;
    for (const bool value : {false, true}) {
      if (node.kind == OnlineKind::window && (!value || node.to_the_end)) watch(node.left, value);
      if (of_time || (node.kind == OnlineKind::either && !value)) {
        watch(node.left, value);
        watch(node.right, value);
      }
    }
  }
  for (const bool value : {false, true}) {
    watch(graph.root, value);
    if (guarded_) watch(*guarded_, value);
  }
}

void TruthEngine::know(std::size_t leaf, Span span, bool value) { decide(states_[leaf], value, span.first, span.end); }

void TruthEngine::step(Cell limit, bool finished) {
  if (settled_) return;
  for (std::size_t n = 0; n < states_.size(); ++n) {
    const OnlineNode& node = graph_->nodes[n];
    State& state = states_[n];
    switch (node.kind) {
      case OnlineKind::constant_false:
        if (!begun_) decide(state, false, 0, endless);
        break;
      case OnlineKind::atom:
      case OnlineKind::change:
        break;
      case OnlineKind::either:
        step_either(node, state);
        break;
      case OnlineKind::window:
        step_window(node, state, limit, finished);
        break;
      case OnlineKind::strict_until:
        step_until(node, state, limit, finished);
        break;
      case OnlineKind::strict_since:
        step_since(node, state);
        break;
      case OnlineKind::just_before:
        step_just_before(node, state);
        break;
    }
  }
  begun_ = true;
  conclude(limit, finished);
  if (settled_ || finished) {
    for (State& state : states_) state = State{};
    settled_ = true;
  } else {
    if (forgets_now()) forget();
    for (State& state : states_)
      for (std::vector<Span>& list : state.news) list.clear();
  }
}

// Not after every small step: that would cost more than the step.
bool TruthEngine::forgets_now() {
  std::size_t count = 0;
  for (const State& state : states_) count += state.news[0].size() + state.news[1].size();
  if (++steps_ < 16 && count < 4 * states_.size()) return false;
  steps_ = 0;
  return true;
}

void TruthEngine::decide_merged(State& state, bool value, const std::vector<Span>& left,
                                const std::vector<Span>& right) {
  auto l = left.begin();
  auto r = right.begin();
  while (l != left.end() || r != right.end()) {
    const bool take_left = r == right.end() || (l != left.end() && l->first <= r->first);
    const Span& span = take_left ? *l++ : *r++;
    decide(state, value, span.first, span.end);
  }
}

void TruthEngine::step_either(const OnlineNode& node, State& state) {
  decide_merged(state, true, news(node.left, true), news(node.right, true));
  const std::vector<Span>& left = news(node.left, false);
  const std::vector<Span>& right = news(node.right, false);
  if (left.empty() && right.empty()) return;
  for (std::vector<Span>& list : scratch_) list.clear();
  intersect(left, cells(node.right, false), scratch_[0]);
  intersect(right, cells(node.left, false), scratch_[1]);
  decide_merged(state, false, scratch_[0], scratch_[1]);
}

void TruthEngine::step_window(const OnlineNode& node, State& state, Cell limit, bool finished) {
  const WindowShape shape(node.window);
  const SpanSet& holds = cells(node.left, true);
  const SpanSet& fails = cells(node.left, false);
  if (!begun_) decide(state, false, 0, shape.within_to(-1) + 1);  // windows that lie before the trace
  if (node.to_the_end) {
    // A window is cut at the end of the trace, which is nowhere before `limit`; for cells after it, at themselves.
    const std::size_t last = holds.find_back(limit);
    if (last < holds.size()) decide(state, true, 0, shape.meets_to(std::min(holds[last].end - 1, limit)) + 1);
    if (shape.first == 0 && !shape.first_open)
      for (const Span& span : news(node.left, true)) decide(state, true, span.first, span.end);
  } else {
    for (const Span& span : news(node.left, true))
      decide(state, true, shape.meets_from(span.first), shape.meets_to(span.end - 1) + 1);
  }
  std::size_t index = 0;
  for (const Span& span : news(node.left, false)) {
    index = fails.find(span.first, index);
    if (index == fails.size()) continue;  // nothing asks for it any more
    const Cell first = fails[index].first;
    decide(state, false, shape.within_from(first), shape.within_to(fails[index].end - 1) + 1);
  }
  if (node.to_the_end && finished) {
    index = fails.find(limit);
    if (index < fails.size() && fails[index].first <= limit)
      decide(state, false, shape.within_from(fails[index].first), limit + 1);
    decide(state, false, shape.meets_to(limit) + 1, limit + 1);
  }
}

// `run` is one of the left side; the latest witness that it reaches makes all before true.
void TruthEngine::until_holds(const OnlineNode& node, State& state, const Span& run, Cell latest_witness) {
  const SpanSet& witnesses = cells(node.right, true);
  Cell reach = run.end >= endless ? endless - 1 : is_instant(run.end) ? run.end : run.end - 1;
  reach = std::min(reach, latest_witness);
  const std::size_t index = witnesses.find_back(reach);
  if (index >= witnesses.size()) return;
  const Cell witness = std::min(witnesses[index].end - 1, reach);
  if (last_needed(witness) >= run.first) decide(state, true, run.first, last_needed(witness) + 1);
}

void TruthEngine::step_until(const OnlineNode& node, State& state, Cell limit, bool finished) {
  const SpanSet& left = cells(node.left, true);
  const SpanSet& right = cells(node.right, true);
  const SpanSet& left_fails = cells(node.left, false);
  const SpanSet& right_fails = cells(node.right, false);
  const Cell latest = node.to_the_end ? limit : endless - 1;

  const auto with_witnesses = [&](Span span) {
    span.end = std::min(span.end, latest == endless - 1 ? endless : latest + 1);
    if (span.first >= span.end) return;
    for (std::size_t n = left.find(span.first - 1); n < left.size() && left[n].first < span.end; ++n)
      until_holds(node, state, left[n], latest);
  };
  for (const Span& span : news(node.left, true)) {
    const std::size_t index = left.find(span.first);
    if (index < left.size()) until_holds(node, state, left[index], latest);
  }
  for (const Span& span : news(node.right, true)) with_witnesses(span);
  if (node.to_the_end && latest > state.matured) {
    for (std::size_t n = right.find(state.matured + 1); n < right.size() && right[n].first <= latest; ++n)
      with_witnesses({std::max(right[n].first, state.matured + 1), right[n].end});
    state.matured = latest;
  }

  // Where the left side fails, no later witness counts; before that, none may have been.
  const auto fails_before = [&](Cell failure) {
    const Cell until_here = is_instant(failure) ? failure : failure - 1;
    if (!is_instant(failure)) decide(state, false, failure - 1, failure);
    const std::size_t index = right_fails.find(until_here);
    if (until_here < 0 || index >= right_fails.size() || right_fails[index].first > until_here) return;
    const Cell first = right_fails[index].first;
    decide(state, false, is_instant(first) ? first : first - 1, failure);
  };
  for (const Span& span : news(node.left, false)) {
    decide(state, false, span.first, span.end);
    const std::size_t index = left_fails.find(span.first);
    if (index < left_fails.size()) fails_before(left_fails[index].first);
  }
  for (const Span& span : news(node.right, false)) {
    const std::size_t index = right_fails.find(span.first);
    if (index >= right_fails.size()) continue;
    const Span run = right_fails[index];
    if (run.end >= endless) decide(state, false, is_instant(run.first) ? run.first : run.first - 1, endless);
    std::size_t failure = left_fails.find_back(run.end);
    if (failure >= left_fails.size()) continue;
    if (left_fails[failure].first == run.end && is_instant(run.end)) {
      if (failure == 0) continue;
      --failure;
    }
    if (left_fails[failure].first >= run.first) fails_before(left_fails[failure].first);
  }
  if (node.to_the_end && finished) {
    const std::size_t index = right_fails.find(limit);
    if (index < right_fails.size() && right_fails[index].first <= limit) {
      const Cell first = right_fails[index].first;
      decide(state, false, is_instant(first) ? first : first - 1, limit + 1);
    }
    decide(state, false, limit, limit + 1);
  }
}

// `run` is one of the left side; the earliest witness that it reaches back to makes all after true.
void TruthEngine::since_holds(const OnlineNode& node, State& state, const Span& run) {
  const SpanSet& own = cells({static_cast<std::uint32_t>(&state - states_.data()), false}, true);
  const std::size_t known = own.find(run.first);
  if (known < own.size() && own[known].first < run.end)  // what held once goes on as long as the left side does
    decide(state, true, std::max(own[known].first, run.first), run.end);
  const SpanSet& witnesses = cells(node.right, true);
  const Cell reach = is_instant(run.first) ? run.first : run.first - 1;
  const std::size_t index = witnesses.find(reach);
  if (index >= witnesses.size()) return;
  const Cell witness = std::max(witnesses[index].first, reach);
  if (first_needed(witness) < run.end) decide(state, true, first_needed(witness), run.end);
}

void TruthEngine::step_since(const OnlineNode& node, State& state) {
  const SpanSet& left = cells(node.left, true);
  const SpanSet& left_fails = cells(node.left, false);
  const SpanSet& right_fails = cells(node.right, false);
  if (!begun_) decide(state, false, 0, 1);

  for (const Span& span : news(node.left, true)) {
    const std::size_t index = left.find(span.first);
    if (index < left.size()) since_holds(node, state, left[index]);
  }
  for (const Span& span : news(node.right, true)) {
    const Cell end = span.end >= endless ? endless : span.end + 1;
    for (std::size_t n = left.find(span.first); n < left.size() && left[n].first < end; ++n)
      since_holds(node, state, left[n]);
  }

  const auto after = [](const Span& run) {  // the end of the cells before which only the run's cells lie
    return run.end >= endless ? endless : is_instant(run.end) ? run.end + 1 : run.end;
  };
  const auto fails_after = [&](Cell failure) {
    if (failure >= endless - 1) return;
    if (!is_instant(failure)) decide(state, false, failure + 1, failure + 2);
    const Cell from_here = is_instant(failure) ? failure : failure + 1;
    const std::size_t index = right_fails.find(from_here);
    if (index < right_fails.size() && right_fails[index].first <= from_here)
      decide(state, false, failure + 1, after(right_fails[index]));
  };
  for (const Span& span : news(node.left, false)) {
    decide(state, false, span.first, span.end);
    const std::size_t index = left_fails.find(span.first);
    if (index < left_fails.size()) fails_after(left_fails[index].end - 1);
  }
  for (const Span& span : news(node.right, false)) {
    const std::size_t index = right_fails.find(span.first);
    if (index >= right_fails.size()) continue;
    const Span run = right_fails[index];
    for (std::size_t n = left_fails.find(std::max<Cell>(run.first - 2, 0));
         n < left_fails.size() && left_fails[n].first < run.end; ++n) {
      fails_after(left_fails[n].end - 1);
      if (left_fails[n].end > run.first) break;
    }
    // A failure goes on while there is no witness.
    const SpanSet& own = state.cells[0];
    const std::size_t known = own.find(run.first);
    if (known < own.size() && own[known].first < after(run))
      decide(state, false, std::max(own[known].first, run.first), after(run));
  }
  // A failure decided elsewhere may begin inside a run without witnesses that was known before.
  for (std::size_t n = 0; n < state.news[0].size(); ++n) {
    const Cell last = state.news[0][n].end - 1;
    const std::size_t index = right_fails.find(last);
    if (index < right_fails.size() && right_fails[index].first <= last)
      decide(state, false, last, after(right_fails[index]));
  }
}

void TruthEngine::step_just_before(const OnlineNode& node, State& state) {
  // At instants what was before, between them the same as the operand: a run may lose or gain an instant at its ends.
  if (!begun_) decide(state, false, 0, 1);
  for (const bool value : {false, true}) {
    for (const Span& span : news(node.left, value)) {
      const Cell first = is_instant(span.first) ? span.first + 1 : span.first;
      const Cell end = span.end >= endless ? endless : is_instant(span.end) ? span.end + 1 : span.end;
      decide(state, value, first, end);
    }
  }
}

void TruthEngine::conclude(Cell limit, bool finished) {
  if (cells(graph_->root, true).holds(0)) verdict_ = Decision::yes;
  if (cells(graph_->root, false).holds(0)) verdict_ = Decision::no;
  if (!guarded_) {
    settled_ = verdict_ != Decision::undetermined;
    return;
  }
  const SpanSet& holds = cells(*guarded_, true);
  const SpanSet& fails = cells(*guarded_, false);
  guarded_open_ = holds.end_of_run(guarded_open_);
  if (verdict_ == Decision::no && !(violation_ && violation_->settled) && !fails.empty() &&
      (!finished || fails[0].first <= limit)) {
    ViolatedSpan found{fails[0], finished};
    if (finished) found.cells.end = std::min(found.cells.end, limit + 1);
    if (found.cells.first == guarded_open_)
      found.settled = finished || found.cells.end >= endless || holds.holds(found.cells.end);
    violation_ = found;
  }
  if (all_violations_) {
    collect(limit, finished);
    settled_ = verdict_ == Decision::yes;
  } else {
    settled_ = verdict_ == Decision::yes || (violation_ && violation_->settled);
  }
}

void TruthEngine::collect(Cell limit, bool finished) {
  const SpanSet& holds = cells(*guarded_, true);
  const SpanSet& fails = cells(*guarded_, false);
  violated_since_.reset();
  if (finished) {  // what is open stays open, and hides nothing behind it
    for (std::size_t n = fails.find(guarded_open_); n < fails.size() && fails[n].first <= limit; ++n)
      ended_.push_back({std::max(fails[n].first, guarded_open_), std::min(fails[n].end, limit + 1)});
    return;
  }
  while (true) {
    guarded_open_ = holds.end_of_run(guarded_open_);
    const Cell end = fails.end_of_run(guarded_open_);
    if (end == guarded_open_ || guarded_open_ > limit) return;  // behind the limit there may be no trace
    if (end > limit + 1 || !holds.holds(end)) {
      violated_since_ = guarded_open_;
      return;
    }
    ended_.push_back({guarded_open_, end});
    guarded_open_ = end;
  }
}

std::vector<Span> TruthEngine::take_violations() {
  std::vector<Span> taken;
  taken.swap(ended_);
  return taken;
}

void TruthEngine::forget() {
  for (State& state : states_) state.wanted = endless;
  if (verdict_ == Decision::undetermined) want(graph_->root, 0);
  if (guarded_) want(*guarded_, guarded_open_);
  for (std::size_t n = states_.size(); n-- > 0;) {
    const OnlineNode& node = graph_->nodes[n];
    State& state = states_[n];
    const bool remembers =
        node.kind == OnlineKind::strict_since || (node.kind == OnlineKind::window && node.window.odd.first == -endless);
    if (!remembers) state.open = std::max(state.open, state.wanted);
    while (true) {
      const Cell next = state.cells[0].end_of_run(state.cells[1].end_of_run(state.open));
      if (next == state.open) break;
      state.open = next;
    }
    if (remembers) state.wanted = std::min(state.wanted, std::max<Cell>(state.open - 1, 0));
    for (SpanSet& set : state.cells) set.drop_before(state.wanted);
    const Cell open = state.open;
    if (open >= endless) continue;  // all is decided
    switch (node.kind) {
      case OnlineKind::either:
        want(node.left, open);
        want(node.right, open);
        break;
      case OnlineKind::window:
        want(node.left, remembers ? shifted(open, node.window.odd.last) - 2 : open + node.window.odd.first);
        break;
      case OnlineKind::just_before:
        want(node.left, open - 2);
        break;
      case OnlineKind::strict_until:
      case OnlineKind::strict_since:
        want(node.left, open - 2);
        want(node.right, open - 2);
        break;
      default:
        break;
    }
  }
}

std::size_t TruthEngine::pieces() const {
  std::size_t total = 0;
  for (const State& state : states_) total += state.cells[0].size() + state.cells[1].size();
  return total;
}

std::size_t TruthEngine::bytes() const {
  std::size_t total = sizeof(*this) + states_.capacity() * sizeof(State);
  for (const State& state : states_) {
    for (const SpanSet& set : state.cells) total += set.bytes();
    for (const std::vector<Span>& list : state.news) total += list.capacity() * sizeof(Span);
  }
  for (const std::vector<Span>& list : scratch_) total += list.capacity() * sizeof(Span);
  return total;
}

}  // namespace tachk::monitoring::online
