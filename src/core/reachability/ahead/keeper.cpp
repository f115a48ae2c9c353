#include "reachability/ahead/keeper.hpp"

#include <algorithm>
#include <utility>

namespace tachk {

Keeper::Keeper(PassedList& passed, std::uint32_t share, const ZoneGraph& graph)
    : passed_(passed),
      share_(passed.parts(share)),
      number_(share),
      whole_(graph.program().diagonals.empty()),
      arrivals_(share_),
      union_(graph.operations()),
      source_(graph.operations()) {}

void Keeper::keep(std::span<const std::unique_ptr<Finder>> finders, std::uint32_t count, const Terms& terms,
                  ZoneGraph& graph) {
  constexpr std::ptrdiff_t soon = 3;
  terms_ = terms;
  simulated_ = {};
  united_ = {};
  unions_.clear();
  numbers_.clear();
  share_.covered().clear();
  share_.wait_from(terms.first_waiting);
  struct Source {
    Harvest* harvest;
    const std::uint32_t* next;
    const std::uint32_t* last;

    const Found& found() const { return harvest->found[*next]; }
  };
  std::vector<Source> sources;
  for (const std::unique_ptr<Finder>& finder : finders) {
    const std::vector<std::uint32_t>& found = finder->harvest().shares[number_];
    if (!found.empty()) sources.push_back({&finder->harvest(), found.data(), found.data() + found.size()});
  }
  while (!sources.empty()) {
    const auto source = std::min_element(sources.begin(), sources.end(), [](const Source& one, const Source& other) {
      return one.found().order >> 32 < other.found().order >> 32;
    });
    // All that was found of one state.
    const std::uint64_t place = source->found().order >> 32;
    if (place >= count) return;
    while (source->next != source->last && source->found().order >> 32 == place) {
      if (source->last - source->next > soon) {
        source->harvest->prefetch(source->next[soon], graph.operations().bytes);
        __builtin_prefetch(
            &source->harvest->found[source->next[2 * soon < source->last - source->next ? 2 * soon : soon]]);
      }
      take(source->found(), *source->harvest, graph);
      ++source->next;
    }
    if (source->next == source->last) sources.erase(source);
  }
}

// What is known of a successor holds unless the state that covers it has been removed for one that simulates that.
bool Keeper::wants(const Found& found, std::uint32_t discrete, ZoneView zone, const std::int32_t* slots,
                   ZoneGraph& graph) {
  if (!terms_.subsumption) return true;
  if (found.coverer != no_node && !passed_.covered(found.coverer)) return false;
  if (arrivals_.covers(discrete, zone)) return false;
  if (found.coverer != no_node && share_.coverer(discrete, zone, nullptr) != no_node) return false;
  return !is_simulated(discrete, zone, slots, graph);
}

bool Keeper::is_simulated(std::uint32_t discrete, ZoneView zone, const std::int32_t* slots, ZoneGraph& graph) {
  if (!terms_.simulation) {
    simulated_.decline();
    return false;
  }
  const std::size_t others = arrivals_.count(discrete);
  if (others == 0) return false;
  const ClockBounds bounds = graph.bounds(slots);
  const bool simulated =
      share_.coverer(discrete, zone, &bounds) != no_node || arrivals_.covers(discrete, zone, &bounds);
  simulated_.tell(simulated, others);
  return simulated;
}

void Keeper::take(const Found& found, Harvest& harvest, ZoneGraph& graph) {
  const std::int32_t* slots = harvest.slots(found.slots);
  const std::uint32_t discrete =
      found.discrete != HashIndex::absent ? found.discrete : passed_.locate(harvest.key(found.key), found.hash);
  if (!wants(found, discrete, graph.packed(slots, found.zone), slots, graph)) return;
  const auto store = [&](ConstZoneRef zone) {
    const ClockBounds bounds = terms_.simulation ? graph.bounds(slots) : ClockBounds{};
    this->store(found.order, discrete, graph.packed(slots, zone), terms_.simulation ? &bounds : nullptr);
  };
  if (graph.representatives().active()) return store(found.zone);  // it has been abstracted
  source_.assign(found.zone);
  graph.abstract(slots, source_, store);
}

void Keeper::store(std::uint64_t order, std::uint32_t discrete, ZoneView zone, const ClockBounds* bounds) {
  Union made;
  if (terms_.merging && terms_.unites) {
    const std::size_t looked =
        arrivals_.unite(discrete, zone, terms_.first_waiting, union_.get(), made.parts, made.own);
    united_.tell(!made.parts.empty() || !made.own.empty(), looked);
  } else if (terms_.merging) {
    united_.decline();
  }
  const bool larger = !made.parts.empty() || !made.own.empty();
  if (larger) zone.data = union_.get();
  // Where zones are whole, and nothing is simulated, it is not covered: that was asked for what it has been made of.
  const bool asks = terms_.subsumption && (bounds != nullptr || !whole_);
  if (asks && (share_.coverer(discrete, zone, bounds) != no_node || arrivals_.covers(discrete, zone, bounds))) return;
  const std::size_t before = arrivals_.all().size();
  arrivals_.add(order, discrete, zone, terms_.subsumption, bounds);
  if (!larger || arrivals_.all().size() == before) return;
  made.arrival = static_cast<std::uint32_t>(before);
  unions_.push_back(std::move(made));
}

}  // namespace tachk
