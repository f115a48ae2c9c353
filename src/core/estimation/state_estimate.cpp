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
void unite(std::vector<Window>& windows, Window added) {
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

std::size_t StateEstimate::KeyHash::operator()(const Key& key) const {
  std::uint64_t hash = key.size();
  for (const std::int32_t number : key) hash = (hash ^ static_cast<std::uint32_t>(number)) * 0x9E3779B97F4A7C15u;
  return static_cast<std::size_t>(hash ^ hash >> 32);
}

StateEstimate::StateEstimate(program::Program program, const reachability::Options& options,
                             const reachability::Limits& limits, std::vector<VisibleChannel> channels,
                             std::size_t streams)
    : limits_(limits),
      graph_(plain(std::move(program)), whole(options)),
      channels_(std::move(channels)),
      visible_(graph_.program().channels.size(), invisible),
      queues_(streams),
      settled_(streams),
      wanted_(graph_.program().edges.size()),
      source_(graph_.blank()),
      positions_(streams),
      scratch_(graph_.operations()) {
  for (std::size_t place = 0; place < channels_.size(); ++place)
    visible_.at(static_cast<std::size_t>(channels_[place].channel)) = place;
}

void StateEstimate::observe(std::size_t stream, Observation observation) {
  queues_.at(stream).push_back(std::move(observation));
}

void StateEstimate::advance(Raw until) { begin(until, Aim::present); }

void StateEstimate::look_ahead(Raw until) { begin(until, Aim::outlook); }

void StateEstimate::conclude() {
  Raw last = 0;
  for (const std::deque<Observation>& queue : queues_)
    for (const Observation& observation : queue) last = std::max(last, observation.latest);
  begin(last, Aim::end);
}

void StateEstimate::seek(Raw until, const std::vector<std::uint32_t>& edges) {
  wanted_.assign(wanted_.size(), false);
  for (const std::uint32_t edge : edges) wanted_.at(edge) = true;
  begin(until, Aim::edge);
}

void StateEstimate::begin(Raw until, Aim aim) {
  aim_ = aim;
  until_ = until;
  reached_ = {};
  next_ = 0;
  leads_.clear();
  found_ = false;
  lead_.reset();
  outlook_ = {};
}

// ---- the exploration ------------------------------------------------------------------------------------------------

struct StateEstimate::Following {
  StateEstimate& estimate;

  static bool counts() { return false; }
  bool admits(const symbolic::Edges& edges) const {
    const bool input = estimate.aim_ == Aim::outlook && edges.size() > 1;
    estimate.sender_ = input ? edges.front() : none;
    return true;
  }
  void possible(ConstZoneRef guarded, const symbolic::Effect& effect) const {
    if (estimate.sender_ == none) return;
    symbolic::ZoneGraph& graph = estimate.graph_;
    zones::ZoneBuffer zone(graph.operations());
    zone.assign(guarded);
    std::vector<Atom> atoms;
    if (!graph.semantics().weakest_precondition(effect, atoms)) return;
    if (!graph.operations().intersect(zone.get(), graph.program().dimension(), atoms.data(), atoms.size())) return;
    estimate.accepted_.push_back({estimate.sender_, std::move(zone)});
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
  if (next_ == 0 && reached_.nodes.empty()) {
    number_ = none;
    lead_of_node_ = none;
    if (!started_) {
      std::fill(positions_.begin(), positions_.end(), 0);
      graph_.start(Following{*this});
    }
    for (Node& node : present_) {
      atoms_.clear();
      if (!graph_.semantics().invariant(node.slots.data(), atoms_)) continue;
      scratch_.assign(node.zone.get());
      positions_ = node.positions;
      const std::vector<Atom> invariant = atoms_;
      settle(node.slots.data(), invariant);
    }
  }
  while (next_ < reached_.nodes.size() && !found_) {
    if (expansions-- == 0) return Status::running;
    const std::uint32_t number = next_++;
    if (reached_.nodes[number].covered) continue;
    if (aim_ == Aim::end && is_through(reached_.nodes[number])) {
      found_ = true;
      break;
    }
    expand(number);
    if (reached_.nodes.size() > limits_.states) return Status::state_limit;
  }
  finish();
  return Status::finished;
}

void StateEstimate::expand(std::uint32_t number) {
  const Node& node = reached_.nodes[number];
  source_.slots = node.slots;
  source_.zone.assign(node.zone.get());
  number_ = number;
  ++explored_;
  accepted_.clear();
  graph_.expand(source_, Following{*this});
  if (aim_ == Aim::outlook) note_refusals(number);
}

// The place of the visible channel on which edges synchronise in the source.
std::size_t StateEstimate::visible(std::span<const std::uint32_t> edges) {
  if (edges.empty()) return invisible;
  const program::Edge& first = graph_.program().edges[edges.front()];
  if (first.internal()) return invisible;
  const std::int64_t channel = first.channel_code == program::no_code
                                   ? first.channel
                                   : graph_.semantics().value(first.channel_code, source_.slots.data());
  return visible_[static_cast<std::size_t>(channel)];
}

void StateEstimate::step(const symbolic::Successor& entry, const std::vector<Atom>& invariant) {
  scratch_.assign(entry.zone);
  if (number_ != none) {
    positions_ = reached_.nodes[number_].positions;
    lead_of_node_ = reached_.nodes[number_].lead;
  }
  const std::size_t place = visible(entry.edges);
  const bool wanted = aim_ == Aim::edge && std::any_of(entry.edges.begin(), entry.edges.end(),
                                                       [&](std::uint32_t edge) { return wanted_[edge]; });
  if (place != invisible) {
    const VisibleChannel& channel = channels_[place];
    const std::deque<Observation>& queue = queues_[channel.stream];
    std::uint32_t& position = positions_[channel.stream];
    if (position < queue.size()) {
      const Observation& observation = queue[position];
      if (!matches(channel, observation, entry.slots)) return;
      const Atom within[] = {at_least(observation.earliest), at_most(observation.latest)};
      if (!graph_.operations().intersect(scratch_.get(), graph_.program().dimension(), within, 2)) return;
      ++position;
    } else if (aim_ == Aim::present || (aim_ == Aim::end && channel.input)) {
      return;  // it would have been seen; inputs are those of the tester, who knows them all
    } else if (aim_ == Aim::outlook) {
      note(place, values(channel, entry.slots), window(entry.zone));
      return;
    } else if (aim_ == Aim::edge && lead_of_node_ == none) {
      lead_of_node_ = static_cast<std::uint32_t>(leads_.size());
      leads_.push_back({place, values(channel, entry.slots), window(entry.zone)});
    }
    forget(channel, entry.slots);
  }
  if (wanted) {
    found_ = true;
    lead_ = lead_of_node_ == none ? std::nullopt : std::optional(leads_[lead_of_node_]);
    return;
  }
  settle(entry.slots, invariant);
}

void StateEstimate::settle(std::int32_t* slots, const std::vector<Atom>& invariant) {
  const int dimension = graph_.program().dimension();
  const zones::ZoneOperations& operations = graph_.operations();
  const std::vector<std::uint32_t> before = positions_;
  // An event that may not have happened is passed over in any state; the search tries both.
  for (std::size_t stream = 0; stream < queues_.size(); ++stream) {
    if (positions_[stream] >= queues_[stream].size() || !queues_[stream][positions_[stream]].optional) continue;
    zones::ZoneBuffer kept(operations);
    kept.assign(scratch_.get());
    ++positions_[stream];
    settle(slots, invariant);
    positions_ = before;
    scratch_.assign(kept.get());
  }
  Raw limit = until_;
  for (std::size_t stream = 0; stream < queues_.size(); ++stream)
    if (positions_[stream] < queues_[stream].size())
      limit = std::min(limit, queues_[stream][positions_[stream]].latest);
  const Atom last = at_most(limit);
  if (!operations.intersect(scratch_.get(), dimension, &last, 1)) return;
  if (graph_.semantics().time_passes(slots)) {
    std::vector<Atom> within = invariant;
    within.push_back(last);
    operations.up_within(scratch_.get(), dimension, graph_.semantics().stopped_clocks(slots), within.data(),
                         within.size());
  }
  graph_.abstract(slots, scratch_, [&](ConstZoneRef zone) { add(reached_, slots, positions_, zone, lead_of_node_); });
}

bool StateEstimate::add(Nodes& nodes, const std::int32_t* slots, const std::vector<std::uint32_t>& positions,
                        ConstZoneRef zone, std::uint32_t lead) {
  const int dimension = graph_.program().dimension();
  Key key(slots, slots + graph_.program().state_slots);
  for (const std::uint32_t position : positions) key.push_back(static_cast<std::int32_t>(position));
  std::vector<std::uint32_t>& same = nodes.places[std::move(key)];
  for (const std::uint32_t other : same)
    if (graph_.operations().includes(nodes.nodes[other].zone.get(), zone, dimension)) return false;
  std::erase_if(same, [&](std::uint32_t other) {
    const bool covers = graph_.operations().includes(zone, nodes.nodes[other].zone.get(), dimension);
    if (covers) nodes.nodes[other].covered = true;
    return covers;
  });
  same.push_back(static_cast<std::uint32_t>(nodes.nodes.size()));
  nodes.nodes.push_back(
      {{slots, slots + graph_.program().slots.size()}, positions, zones::ZoneBuffer(graph_.operations()), lead, false});
  nodes.nodes.back().zone.assign(zone);
  return true;
}

// Optional events were passed over where that was possible.
bool StateEstimate::is_through(const Node& node) const {
  for (std::size_t stream = 0; stream < queues_.size(); ++stream)
    if (node.positions[stream] < queues_[stream].size()) return false;
  return true;
}

void StateEstimate::finish() {
  const int dimension = graph_.program().dimension();
  const zones::ZoneOperations& operations = graph_.operations();
  if (aim_ == Aim::outlook) {
    for (const Node& node : reached_.nodes)
      outlook_.silent_until = std::max(outlook_.silent_until, window(node.zone.get()).high);
    return;
  }
  if (aim_ != Aim::present) return;
  Nodes here;
  const Atom there = at_least(until_);
  const zones::ClockReset again{now, 0, 0};
  for (Node& node : reached_.nodes) {
    if (node.covered || !operations.intersect(node.zone.get(), dimension, &there, 1)) continue;
    operations.reset(node.zone.get(), dimension, &again, 1);
    add(here, node.slots.data(), node.positions, node.zone.get(), none);
  }
  present_.clear();
  for (Node& node : here.nodes)
    if (!node.covered) present_.push_back(std::move(node));
  started_ = true;
  reached_ = {};
  for (std::size_t stream = 0; stream < queues_.size(); ++stream) {
    std::size_t settled = queues_[stream].size();
    for (const Node& node : present_) settled = std::min<std::size_t>(settled, node.positions[stream]);
    queues_[stream].erase(queues_[stream].begin(),
                          queues_[stream].begin() + static_cast<std::ptrdiff_t>(settled));
    for (Node& node : present_) node.positions[stream] -= static_cast<std::uint32_t>(settled);
    settled_[stream] += settled;
    for (Observation& observation : queues_[stream]) {
      observation.earliest -= until_;
      observation.latest -= until_;
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
  return {-zones::raw_value(low), high == zones::unbounded_entry ? until_ : std::min(until_, zones::raw_value(high))};
}

void StateEstimate::note(std::size_t channel, std::vector<std::int32_t> said, Window when) {
  for (PossibleEvent& event : outlook_.events)
    if (event.channel == channel && event.values == said) return unite(event.windows, when);
  outlook_.events.push_back({channel, std::move(said), {when}});
}

// Where the environment can send over a channel that is no broadcast, and no receiver is ready. While no time can pass
// the system is about to go on.
void StateEstimate::note_refusals(std::uint32_t number) {
  const program::Program& program = graph_.program();
  const int dimension = program.dimension();
  symbolic::Semantics& semantics = graph_.semantics();
  std::int32_t* slots = source_.slots.data();
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
    scratch_.assign(reached_.nodes[number].zone.get());
    if (!graph_.operations().intersect(scratch_.get(), dimension, guard.data(), guard.size())) continue;
    zones::Federation refused(graph_.operations(), dimension);
    refused.add(scratch_.get());
    for (const Accepted& accepted : accepted_)
      if (accepted.edge == edge) refused.subtract(atoms_of(graph_.operations(), accepted.guarded.get(), dimension));
    for (std::size_t piece = 0; piece < refused.size(); ++piece)
      outlook_.refusals.push_back({place, window(refused[piece])});
  }
}

std::vector<std::vector<std::int32_t>> StateEstimate::locations() const {
  std::vector<std::vector<std::int32_t>> found;
  for (const Node& node : present_) {
    std::vector<std::int32_t> each(node.slots.begin(),
                                   node.slots.begin() + static_cast<std::ptrdiff_t>(graph_.program().processes.size()));
    if (std::find(found.begin(), found.end(), each) == found.end()) found.push_back(std::move(each));
  }
  return found;
}

}  // namespace tachk::estimation
