// The states in which a system may be after what was seen of it: a set of symbolic states that goes along with events
// as they are recorded, silence included (K. G. Larsen, M. Mikucionis, B. Nielsen, "Online testing of real-time systems
// using Uppaal", 2004, section 4: "symbolic reachable state set"; delays of observations as in "Monitoring of timed
// automata with delays", 2024).
//
// The first clock of the program is the time since the present moment, which each `advance` moves on; nothing resets
// it. Events of a stream happen in their recorded order, those of different streams as their windows allow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "estimation/state_set.hpp"
#include "program/program.hpp"
#include "reachability/explorer.hpp"
#include "symbolic/zone_graph.hpp"
#include "zones/federation.hpp"
#include "zones/zone_buffer.hpp"

namespace tachk::estimation {

using zones::Raw;

// The value of a column of an event: a constant, or a slot at the end of the step. The slot holds its initial value
// before the step and is given it back.
struct EventColumn {
  std::optional<std::uint32_t> slot;
  std::int32_t value;
};

// A channel of which each synchronisation is an event.
struct VisibleChannel {
  std::int32_t channel;
  std::uint32_t stream;
  bool input;  // the environment sends
  std::vector<EventColumn> columns;
};

// An event that was seen. It happened in [earliest, latest], counted from the present moment.
struct Observation {
  std::vector<std::optional<std::int32_t>> values;  // by column; none where it was not seen
  Raw earliest;
  Raw latest;
  bool optional = false;  // it may also not have happened
};

// A time interval [low, high] of whole units that holds the exact one.
struct Window {
  Raw low;
  Raw high;
};

struct PossibleEvent {
  std::size_t channel;  // its place among the visible channels
  std::vector<std::int32_t> values;
  std::vector<Window> windows;  // apart, in their order
  std::vector<Raw> boundaries;  // where a window of a single step begins or ends
};

// When the system may not receive an input.
struct Blocking {
  std::size_t channel;
  Window window;
};

// What may happen first if nothing is seen.
struct Prediction {
  std::vector<PossibleEvent> events;
  std::vector<Blocking> blocked;
  Raw silent_until = 0;  // silence may last so long, at least up to where was looked if it is that
};

// The first event of a run to an edge.
struct Lead {
  std::size_t channel;
  std::vector<std::int32_t> values;
  Window window;
};

class StateEstimate final {
 public:
  StateEstimate(program::Program program, const reachability::Options& options, const reachability::Limits& limits,
                std::vector<VisibleChannel> channels, std::size_t streams,
                std::vector<std::optional<std::uint32_t>> marks);
  StateEstimate(const StateEstimate&) = delete;
  StateEstimate& operator=(const StateEstimate&) = delete;

  // Adds an event behind those of its stream.
  void observe(std::size_t stream, Observation observation);

  // Begin an exploration, which `run` carries out: up to a moment, which becomes the present one; of what may happen
  // first if nothing else is seen up to a moment; of whether all observations can happen, however the system goes on
  // unseen; of runs that take one of these edges within a time, among so many states.
  void advance(Raw until);
  void predict(Raw until);
  void conclude();
  void seek(Raw until, const std::vector<std::uint32_t>& edges, std::size_t states);

  // From now on `passed` is about these edges.
  void watch(const std::vector<std::uint32_t>& edges);

  // Explores at most so many states; `running` asks for another call.
  reachability::Status run(std::uint64_t expansions);

  // How many symbolic states are possible at the present moment; none: the system is not as the model says.
  std::size_t size() const { return present_.size(); }
  std::uint64_t explored() const { return explored_; }
  // The marks of the edges that were taken in all possible states, on the way to each that is known.
  std::vector<std::uint32_t> covered() const;
  // Whether one of the watched edges was possible since the call of `watch`, on the way to the present moment.
  bool passed() const { return passed_; }
  const Prediction& prediction() const { return exploration_.prediction; }
  // Whether all observations can happen, or an edge was found, and the first event of that run; none if no event comes
  // before the edge.
  bool found() const { return exploration_.found; }
  const std::optional<Lead>& lead() const { return exploration_.lead; }

 private:
  enum class Aim : std::uint8_t { present, prediction, end, edge };
  static constexpr std::uint32_t none = UINT32_MAX;

  // What is explored, and what was found.
  struct Exploration {
    Aim aim = Aim::present;
    Raw until = 0;
    StateSet reached;
    std::uint32_t next = 0;       // to be expanded
    std::size_t most = SIZE_MAX;  // states that are reached
    std::vector<Lead> leads;
    bool found = false;
    std::optional<Lead> lead;
    Prediction prediction;
  };

  // Where the receiver of what an edge sends is ready.
  struct Accepted {
    std::uint32_t edge;
    zones::ZoneBuffer guarded;
  };

  // The state that is expanded, and the one that a step leads to.
  struct Expansion {
    symbolic::SymbolicState source;
    std::uint32_t number = none;
    std::vector<std::uint32_t> positions;
    std::uint32_t lead = none;
    std::vector<bool> taken;
    zones::ZoneBuffer zone;
    std::uint32_t sender = none;
    std::vector<Accepted> accepted;
  };
  struct Following;

  void begin(Raw until, Aim aim);
  reachability::Status explore(std::uint64_t expansions);
  void begin_with_present();
  void expand(std::uint32_t number);
  void step(const symbolic::Successor& entry, const std::vector<zones::Atom>& invariant);
  // Takes the next observation for a step, or goes on without one. False if the step is not followed.
  bool take(std::size_t place, const symbolic::Successor& entry);
  // Lets time pass in the zone of the expansion, and stores it.
  void settle(std::int32_t* slots, const std::vector<zones::Atom>& invariant);
  Raw latest() const;
  bool matches(const VisibleChannel& channel, const Observation& observation, const std::int32_t* slots) const;
  std::size_t visible(std::span<const std::uint32_t> edges);
  std::vector<std::int32_t> values(const VisibleChannel& channel, const std::int32_t* slots) const;
  void forget(const VisibleChannel& channel, std::int32_t* slots) const;
  Window window(zones::ConstZoneRef zone) const;
  void note(std::size_t channel, std::vector<std::int32_t> values, Window window);
  void note_blocked(std::uint32_t number);
  bool is_through(const std::vector<std::uint32_t>& positions) const;
  void finish();
  void move_on();

  reachability::Limits limits_;
  symbolic::ZoneGraph graph_;
  std::vector<VisibleChannel> channels_;
  std::vector<std::size_t> visible_;  // by number of a channel, its place among the visible ones
  std::vector<std::deque<Observation>> queues_;
  std::vector<bool> wanted_, watched_;  // edges
  bool passed_ = false;
  std::vector<std::optional<std::uint32_t>> marks_;  // of edges; several may have the same
  std::vector<bool> covered_;
  std::vector<StateSet::Node> present_;
  bool started_ = false;
  Exploration exploration_;
  Expansion expansion_;
  std::uint64_t explored_ = 0;
};

}  // namespace tachk::estimation
