#include "simulation/action_choice.hpp"

#include <algorithm>
#include <utility>

namespace tachk::simulation {

using program::Edge;

namespace {

struct Share {
  std::uint32_t edge;
  double probability;
};

double weight(Present& present, std::uint32_t edge) {
  if (present.policy == Policy::uniform || present.policy == Policy::boundary) return 1.0;
  const flow::Number& number = present.chances.weights[edge];
  const double value = number.value(present.machine, present.values.slots.data());
  if (!(value >= 0)) throw machine::ModelFault(machine::FaultKind::range, number.code);
  return value;
}

// Each way with the same probability, and of a way into a branchpoint each branch by its weight.
std::vector<Share> shares(Present& present, std::span<const std::uint32_t> edges) {
  std::vector<Share> result;
  std::vector<std::pair<std::uint32_t, double>> totals;  // of each way
  const auto total_of = [&](std::uint32_t edge) {
    const std::uint32_t way = present.chances.choices[edge];
    return std::find_if(totals.begin(), totals.end(), [&](const auto& each) { return each.first == way; });
  };
  for (const std::uint32_t edge : edges) {
    const double share = weight(present, edge);
    result.push_back({edge, share});
    if (const auto same = total_of(edge); same == totals.end())
      totals.emplace_back(present.chances.choices[edge], share);
    else
      same->second += share;
  }
  for (auto& [edge, share] : result) {
    const double total = total_of(edge)->second;
    share = total > 0 ? share / (total * static_cast<double>(totals.size())) : 0.0;
  }
  return result;
}

std::uint32_t pick(Present& present, std::span<const std::uint32_t> edges) {
  if (edges.size() == 1) return edges.front();
  if (!present.tables.has_branches) return edges[present.random.below(edges.size())];
  const std::vector<Share> known = shares(present, edges);
  double total = 0;
  for (const auto& [edge, share] : known) total += share;
  double left = present.random.fraction() * total;
  std::uint32_t last = edges.front();
  for (const auto& [edge, share] : known) {
    if (share <= 0) continue;
    last = edge;
    if (left < share) break;
    left -= share;
  }
  return last;
}

}  // namespace

std::optional<std::size_t> draw_weighted(std::span<const double> weights, Random& random) {
  double total = 0;
  for (const double weight : weights) total += weight;
  if (total <= 0) return std::nullopt;
  double left = random.fraction() * total;
  std::size_t place = 0;
  while (place + 1 < weights.size() && left >= weights[place]) left -= weights[place++];
  return place;
}

void WeightedActions::add(const Action& action, double probability) {
  actions.push_back(action);
  probabilities.push_back(probability);
}

void WeightedActions::remove(std::size_t place) {
  actions.erase(actions.begin() + static_cast<std::ptrdiff_t>(place));
  probabilities.erase(probabilities.begin() + static_cast<std::ptrdiff_t>(place));
}

bool ActionChoice::choose(Present& present, std::span<const std::uint32_t> offered, Action& action) {
  const std::uint32_t first = pick(present, offered);
  const Edge& edge = present.program.edges[first];
  action.assign(1, first);
  if (edge.internal()) return true;
  const std::int32_t channel = present.channel_of(edge);
  const bool broadcast = present.channel(channel).broadcast;
  const bool committed_only = !broadcast && !present.admits(edge.process);
  std::uint64_t partners = 0;
  for (const std::uint32_t q : present.receivers_of(channel)) {
    if (q == edge.process || (committed_only && !present.place(q).location->committed)) continue;
    present.open_receives(q, channel, receiving_);
    if (receiving_.empty()) continue;
    if (broadcast) {
      action.push_back(pick(present, receiving_));
      continue;
    }
    ++partners;
    if (partners == 1 || present.random.below(partners) == 0) std::swap(receiving_, partner_);
  }
  if (broadcast) return true;
  if (partners > 0) action.push_back(pick(present, partner_));
  return partners > 0;
}

void ActionChoice::enumerate(Present& present, std::span<const std::uint32_t> offered, WeightedActions& found) {
  for (const auto& [edge, share] : shares(present, offered)) enumerate_from(present, edge, share, found);
}

void ActionChoice::enumerate_from(Present& present, std::uint32_t first, double probability, WeightedActions& found) {
  const Edge& edge = present.program.edges[first];
  if (edge.internal()) return found.add({first}, probability);
  const std::int32_t channel = present.channel_of(edge);
  const bool broadcast = present.channel(channel).broadcast;
  std::vector<std::vector<std::uint32_t>> partners;
  for (const std::uint32_t q : present.receivers_of(channel)) {
    if (q == edge.process || (!broadcast && !present.admits(edge.process) && !present.place(q).location->committed))
      continue;
    present.open_receives(q, channel, receiving_);
    if (!receiving_.empty()) partners.push_back(receiving_);
  }
  if (!broadcast) {
    for (const std::vector<std::uint32_t>& receiving : partners)
      for (const auto& [other, share] : shares(present, receiving))
        found.add({first, other}, probability * share / static_cast<double>(partners.size()));
    return;
  }
  WeightedActions all{{{first}}, {probability}};
  for (const std::vector<std::uint32_t>& receiving : partners) {
    const WeightedActions shorter = std::exchange(all, {});
    for (std::size_t n = 0; n < shorter.actions.size(); ++n)
      for (const auto& [other, share] : shares(present, receiving)) {
        all.add(shorter.actions[n], shorter.probabilities[n] * share);
        all.actions.back().push_back(other);
      }
  }
  for (std::size_t n = 0; n < all.actions.size(); ++n) found.add(all.actions[n], all.probabilities[n]);
}

}  // namespace tachk::simulation
