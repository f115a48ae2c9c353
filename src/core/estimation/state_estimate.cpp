#include "estimation/state_estimate.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace tachk::estimation {

using reachability::Status;
using zones::Atom;
using zones::ConstZoneRef;

namespace {

constexpr std::uint16_t now = 1;  // the clock
constexpr std::size_t invisible = SIZE_MAX;

Atom at_most(Raw time) { return {now, 0, zones::raw_bound(time, false)}; }
Atom at_least(Raw time) { return {0, now, zones::raw_bound(-time, false)}; }

reachability::Options whole(reachability::Options options) {
  options.scale = false;  // moments are in units of the model
  options.pack_clocks = UINT32_MAX;
  return options;
}

program::Program plain(program::Program program) {
  program.interchangeable.clear();  // events say which process acts
  return program;
}

// The constraints that make a zone.
std::vector<Atom> atoms_of(const zones::ZoneOperations& operations, ConstZoneRef zone, int dimension) {
  std::vector<Atom> atoms;
  for (int i = 0; i < dimension; ++i)
    for (int j = 0; j < dimension; ++j) {
      if (i == j) continue;
      const Raw raw = operations.entry(zone, dimension, i, j);
      if (raw != zones::unbounded_entry)
        atoms.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), raw});
    }
  return atoms;
}

// Adds a window to some that are apart.
void add_window(std::vector<Window>& windows, Window added) {
  std::vector<Window> apart;
  for (const Window& each : windows) {
    if (each.high < added.low || added.high < each.low) {
      apart.push_back(each);
    } else {
      added = {std::min(each.low, added.low), std::max(each.high, added.high)};
    }
  }
  apart.push_back(added);
  std::sort(apart.begin(), apart.end(), [](const Window& a, const Window& b) { return a.low < b.low; });
  windows = std::move(apart);
}

}  // namespace

StateEstimate::StateEstimate(program::Program program, const reachability::Options& options,
                             const reachability::Limits& limits, std::vector<VisibleChannel> channels,
                             std::size_t streams, std::vector<std::optional<std::uint32_t>> marks)
    : limits_(limits),
      graph_(plain(std::move(program)), whole(options)),
      channels_(std::move(channels)),
      visible_(graph_.program().channels.size(), invisible),
      queues_(streams),
      wanted_(graph_.program().edges.size()),
      watched_(graph_.program().edges.size()),
      marks_(std::move(marks)),
      expansion_{graph_.blank(), none, std::vector<std::uint32_t>(streams),
                 none,           {},   zones::ZoneBuffer(graph_.operations()),
                 none,           {}} {
  marks_.resize(graph_.program().edges.size());
  for (const std::optional<std::uint32_t>& mark : marks_)
    if (mark && *mark >= covered_.size()) covered_.resize(*mark + std::size_t{1});
  expansion_.taken = covered_;
  for (std::size_t place = 0; place < channels_.size(); ++place)
    visible_.at(static_cast<std::size_t>(channels_[place].channel)) = place;
}

void StateEstimate::observe(std::size_t stream, Observation observation) {
  queues_.at(stream).push_back(std::move(observation));
}

void StateEstimate::advance(Raw until) { begin(until, Aim::present); }

void StateEstimate::predict(Raw until) { begin(until, Aim::prediction); }

void StateEstimate::conclude() {
  Raw last = 0;
  for (const std::deque<Observation>& queue : queues_)
    for (const Observation& observation : queue) last = std::max(last, observation.latest);
  begin(last, Aim::end);
}

void StateEstimate::seek(Raw until, const std::vector<std::uint32_t>& edges, std::size_t states) {
  wanted_.assign(wanted_.size(), false);
  for (const std::uint32_t edge : edges) wanted_.at(edge) = true;
  begin(until, Aim::edge);
  exploration_.most = states;
}

void StateEstimate::watch(const std::vector<std::uint32_t>& edges) {
  watched_.assign(watched_.size(), false);
  for (const std::uint32_t edge : edges) watched_.at(edge) = true;
  passed_ = false;
}

void StateEstimate::begin(Raw until, Aim aim) {
  exploration_ = {};
  exploration_.until = until;
  exploration_.aim = aim;
}

// ---- the exploration ------------------------------------------------------------------------------------------------

struct StateEstimate::Following {
  StateEstimate& estimate;

  static bool counts() { return false; }
  bool admits(const symbolic::Edges& edges) const {
    const bool input = estimate.exploration_.aim == Aim::prediction && edges.size() > 1;
    estimate.expansion_.sender = input ? edges.front() : none;
    return true;
  }
  void possible(ConstZoneRef guarded, const symbolic::Effect& effect) const {
    Expansion& expansion = estimate.expansion_;
    if (expansion.sender == none) return;
    symbolic::ZoneGraph& graph = estimate.graph_;
    zones::ZoneBuffer zone(graph.operations());
    zone.assign(guarded);
    std::vector<Atom> atoms;
    if (!graph.semantics().weakest_precondition(effect, atoms)) return;
    if (!graph.operations().intersect(zone.get(), graph.program().dimension(), atoms.data(), atoms.size())) return;
    expansion.accepted.push_back({expansion.sender, std::move(zone)});
  }
  void expect(const symbolic::Effect&) const {}
  bool enters(const symbolic::Successor& entry, const std::vector<Atom>& invariant) const {
    estimate.step(entry, invariant);
    return false;
  }
  static bool wants(const symbolic::Successor&) { return false; }
  static void take(const symbolic::Successor&) {}
};

Status StateEstimate::run(std::uint64_t expansions) {
  try {
    return explore(expansions);
  } catch (const machine::ModelFault&) {
    return Status::fault;
  } catch (const symbolic::ConstantOverflow&) {
    return Status::constant_limit;
  }
}

Status StateEstimate::explore(std::uint64_t expansions) {
  Exploration& exploration = exploration_;
  if (exploration.next == 0 && exploration.reached.size() == 0) begin_with_present();
  while (exploration.next < exploration.reached.size() && !exploration.found &&
         exploration.reached.size() <= exploration.most) {
    if (expansions-- == 0) return Status::running;
    const std::uint32_t number = exploration.next++;
    const StateSet::Node& node = exploration.reached[number];
    if (node.covered) continue;
    if (exploration.aim == Aim::end && is_through(node.positions)) {
      exploration.found = true;
      break;
    }
    expand(number);
    if (exploration.reached.size() > limits_.states) return Status::state_limit;
  }
  finish();
  return Status::finished;
}

void StateEstimate::begin_with_present() {
  expansion_.number = none;
  expansion_.lead = none;
  if (!started_) {
    std::fill(expansion_.positions.begin(), expansion_.positions.end(), 0);
    graph_.start(Following{*this});
  }
  std::vector<Atom> invariant;
  for (StateSet::Node& node : present_) {
    invariant.clear();
    if (!graph_.semantics().invariant(node.slots.data(), invariant)) continue;
    expansion_.zone.assign(node.zone.get());
    expansion_.positions = node.positions;
    expansion_.taken = node.taken;
    settle(node.slots.data(), invariant);
  }
}

void StateEstimate::expand(std::uint32_t number) {
  const StateSet::Node& node = exploration_.reached[number];
  expansion_.source.slots = node.slots;
  expansion_.source.zone.assign(node.zone.get());
  expansion_.number = number;
  expansion_.accepted.clear();
  ++explored_;
  graph_.expand(expansion_.source, Following{*this});
  if (exploration_.aim == Aim::prediction) note_blocked(number);
}

// The place of the visible channel on which edges synchronise in the source.
std::size_t StateEstimate::visible(std::span<const std::uint32_t> edges) {
  if (edges.empty()) return invisible;
  const program::Edge& first = graph_.program().edges[edges.front()];
  if (first.internal()) return invisible;
  const std::int64_t channel = first.channel_code == program::no_code
                                   ? first.channel
                                   : graph_.semantics().value(first.channel_code, expansion_.source.slots.data());
  return visible_[static_cast<std::size_t>(channel)];
}

void StateEstimate::step(const symbolic::Successor& entry, const std::vector<Atom>& invariant) {
  expansion_.zone.assign(entry.zone);
  if (expansion_.number != none) {
    expansion_.positions = exploration_.reached[expansion_.number].positions;
    expansion_.lead = exploration_.reached[expansion_.number].lead;
    expansion_.taken = exploration_.reached[expansion_.number].taken;
  }
  for (const std::uint32_t edge : entry.edges)
    if (marks_[edge]) expansion_.taken[*marks_[edge]] = true;
  const std::size_t place = visible(entry.edges);
  if (place != invisible && !take(place, entry)) return;
  const auto any_of = [&](const std::vector<bool>& edges) {
    return std::any_of(entry.edges.begin(), entry.edges.end(), [&](std::uint32_t edge) { return edges[edge]; });
  };
  if (exploration_.aim == Aim::present) passed_ |= any_of(watched_);
  const bool wanted = exploration_.aim == Aim::edge && any_of(wanted_);
  if (!wanted) return settle(entry.slots, invariant);
  exploration_.found = true;
  if (expansion_.lead != none) exploration_.lead = exploration_.leads[expansion_.lead];
}

bool StateEstimate::take(std::size_t place, const symbolic::Successor& entry) {
  const VisibleChannel& channel = channels_[place];
  const std::deque<Observation>& queue = queues_[channel.stream];
  std::uint32_t& position = expansion_.positions[channel.stream];
  if (position < queue.size()) {
    const Observation& observation = queue[position];
    if (!matches(channel, observation, entry.slots)) return false;
    const Atom within[] = {at_least(observation.earliest), at_most(observation.latest)};
    if (!graph_.operations().intersect(expansion_.zone.get(), graph_.program().dimension(), within, 2)) return false;
    ++position;
  } else {
    // The environment is the tester, which has seen all of that when it sends the next input.
    const bool chosen =
        exploration_.aim == Aim::prediction || (exploration_.aim == Aim::edge && expansion_.lead == none);
    if (chosen && channel.input && !is_through(expansion_.positions)) return false;
    switch (exploration_.aim) {
      case Aim::present:
        return false;  // it would have been seen
      case Aim::end:
        if (channel.input) return false;  // the tester knows all inputs
        break;
      case Aim::prediction:
        note(place, values(channel, entry.slots), window(entry.zone));
        return false;
      case Aim::edge:
        if (expansion_.lead != none) break;
        expansion_.lead = static_cast<std::uint32_t>(exploration_.leads.size());
        exploration_.leads.push_back({place, values(channel, entry.slots), window(entry.zone)});
        break;
    }
  }
  forget(channel, entry.slots);
  return true;
}

// Up to when time may pass where so many events have happened.
Raw StateEstimate::latest() const {
  Raw limit = exploration_.until;
  for (std::size_t stream = 0; stream < queues_.size(); ++stream)
    if (expansion_.positions[stream] < queues_[stream].size())
      limit = std::min(limit, queues_[stream][expansion_.positions[stream]].latest);
  return limit;
}

void StateEstimate::settle(std::int32_t* slots, const std::vector<Atom>& invariant) {
  const int dimension = graph_.program().dimension();
  const zones::ZoneOperations& operations = graph_.operations();
  // An event that may not have happened is passed over in any state; the search tries both.
  for (std::size_t stream = 0; stream < queues_.size(); ++stream) {
    const std::uint32_t position = expansion_.positions[stream];
    if (position >= queues_[stream].size() || !queues_[stream][position].optional) continue;
    const std::vector<std::uint32_t> before = expansion_.positions;
    zones::ZoneBuffer zone = expansion_.zone;
    ++expansion_.positions[stream];
    settle(slots, invariant);
    expansion_.positions = before;
    expansion_.zone = std::move(zone);
  }
  const Atom last = at_most(latest());
  if (!operations.intersect(expansion_.zone.get(), dimension, &last, 1)) return;
  if (graph_.semantics().time_passes(slots)) {
    std::vector<Atom> within = invariant;
    within.push_back(last);
    operations.up_within(expansion_.zone.get(), dimension, graph_.semantics().stopped_clocks(slots), within.data(),
                         within.size());
  }
  graph_.abstract(slots, expansion_.zone, [&](ConstZoneRef zone) {
    exploration_.reached.add(graph_, slots, expansion_.positions, zone, expansion_.lead, expansion_.taken);
  });
}

// Optional events were passed over where that was possible.
bool StateEstimate::is_through(const std::vector<std::uint32_t>& positions) const {
  for (std::size_t stream = 0; stream < queues_.size(); ++stream)
    if (positions[stream] < queues_[stream].size()) return false;
  return true;
}

void StateEstimate::finish() {
  if (exploration_.aim == Aim::present) return move_on();
  if (exploration_.aim != Aim::prediction) return;
  Raw& silent_until = exploration_.prediction.silent_until;
  for (const StateSet::Node& node : exploration_.reached.nodes())
    silent_until = std::max(silent_until, window(node.zone.get()).high);
}

// The moment up to which was explored becomes the present one.
void StateEstimate::move_on() {
  const int dimension = graph_.program().dimension();
  const zones::ZoneOperations& operations = graph_.operations();
  const Atom there = at_least(exploration_.until);
  const zones::ClockReset again{now, 0, 0};
  StateSet here;
  for (StateSet::Node& node : exploration_.reached.nodes()) {
    if (node.covered || !operations.intersect(node.zone.get(), dimension, &there, 1)) continue;
    operations.reset(node.zone.get(), dimension, &again, 1);
    here.add(graph_, node.slots.data(), node.positions, node.zone.get(), none, node.taken);
  }
  started_ = true;
  present_.clear();
  for (StateSet::Node& node : here.nodes())
    if (!node.covered) present_.push_back(std::move(node));
  exploration_.reached = {};
  for (std::size_t mark = 0; mark < covered_.size() && !present_.empty(); ++mark)
    covered_[mark] = covered_[mark] || std::all_of(present_.begin(), present_.end(),
                                                   [&](const StateSet::Node& node) { return node.taken[mark]; });
  for (std::size_t stream = 0; stream < queues_.size(); ++stream) {
    std::deque<Observation>& queue = queues_[stream];
    std::size_t settled = queue.size();
    for (const StateSet::Node& node : present_) settled = std::min<std::size_t>(settled, node.positions[stream]);
    queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(settled));
    for (StateSet::Node& node : present_) node.positions[stream] -= static_cast<std::uint32_t>(settled);
    for (Observation& observation : queue) {
      observation.earliest -= exploration_.until;
      observation.latest -= exploration_.until;
    }
  }
}

// ---- events ---------------------------------------------------------------------------------------------------------

bool StateEstimate::matches(const VisibleChannel& channel, const Observation& observation,
                            const std::int32_t* slots) const {
  for (std::size_t n = 0; n < channel.columns.size(); ++n) {
    const EventColumn& column = channel.columns[n];
    const std::optional<std::int32_t>& seen = observation.values.at(n);
    if (seen && *seen != (column.slot ? slots[*column.slot] : column.value)) return false;
  }
  return true;
}

std::vector<std::int32_t> StateEstimate::values(const VisibleChannel& channel, const std::int32_t* slots) const {
  std::vector<std::int32_t> found;
  for (const EventColumn& column : channel.columns) found.push_back(column.slot ? slots[*column.slot] : column.value);
  return found;
}

void StateEstimate::forget(const VisibleChannel& channel, std::int32_t* slots) const {
  for (const EventColumn& column : channel.columns)
    if (column.slot) slots[*column.slot] = graph_.program().slots[*column.slot].initial;
}

Window StateEstimate::window(ConstZoneRef zone) const {
  const int dimension = graph_.program().dimension();
  const Raw low = graph_.operations().entry(zone, dimension, 0, now);
  const Raw high = graph_.operations().entry(zone, dimension, now, 0);
  return {-zones::raw_value(low),
          high == zones::unbounded_entry ? exploration_.until : std::min(exploration_.until, zones::raw_value(high))};
}

void StateEstimate::note(std::size_t channel, std::vector<std::int32_t> said, Window when) {
  std::vector<PossibleEvent>& events = exploration_.prediction.events;
  auto event = std::find_if(events.begin(), events.end(),
                            [&](const PossibleEvent& each) { return each.channel == channel && each.values == said; });
  if (event == events.end()) event = events.insert(event, {channel, std::move(said), {}, {}});
  add_window(event->windows, when);
  for (const Raw border : {when.low, when.high})
    if (std::find(event->boundaries.begin(), event->boundaries.end(), border) == event->boundaries.end())
      event->boundaries.push_back(border);
}

// Where the environment can send over a channel that is no broadcast, and no receiver is ready. While no time can pass
// the system is about to go on.
void StateEstimate::note_blocked(std::uint32_t number) {
  const program::Program& program = graph_.program();
  const int dimension = program.dimension();
  symbolic::Semantics& semantics = graph_.semantics();
  std::int32_t* slots = expansion_.source.slots.data();
  if (!semantics.time_passes(slots)) return;
  for (std::uint32_t edge = 0; edge < program.edges.size(); ++edge) {
    const program::Edge& sender = program.edges[edge];
    if (!sender.sends || sender.internal() || slots[sender.process] != sender.source) continue;
    const std::size_t place = visible(std::span(&edge, 1));
    if (place == invisible || !channels_[place].input) continue;
    if (program.channels[static_cast<std::size_t>(channels_[place].channel)].broadcast) continue;
    std::vector<Atom> guard;
    if (!semantics.holds(sender.guard, slots)) continue;
    semantics.resolve(sender.guard, slots, guard);
    expansion_.zone.assign(exploration_.reached[number].zone.get());
    if (!graph_.operations().intersect(expansion_.zone.get(), dimension, guard.data(), guard.size())) continue;
    zones::Federation blocked(graph_.operations(), dimension);
    blocked.add(expansion_.zone.get());
    for (const Accepted& accepted : expansion_.accepted)
      if (accepted.edge == edge) blocked.subtract(atoms_of(graph_.operations(), accepted.guarded.get(), dimension));
    for (std::size_t piece = 0; piece < blocked.size(); ++piece)
      exploration_.prediction.blocked.push_back({place, window(blocked[piece])});
  }
}

std::vector<std::uint32_t> StateEstimate::covered() const {
  std::vector<std::uint32_t> marks;
  for (std::uint32_t mark = 0; mark < covered_.size(); ++mark)
    if (covered_[mark]) marks.push_back(mark);
  return marks;
}

}  // namespace tachk::estimation
