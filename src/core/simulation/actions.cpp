// What processes do at a moment: who acts, and which action it is.
#include <algorithm>
#include <utility>

#include "simulation/simulator.hpp"

namespace tachk::simulation {

using program::Edge;

namespace {

constexpr int attempts = 16;  // of drawing an action that target invariants admit

}  // namespace

// Whether time cannot pass; finds those who stop it, and those who would act at this moment anyway.
bool Simulator::frozen() {
  scratch_.candidates.clear();
  if (state_.committed == 0)
    for (const std::uint32_t p : tables_.urgent_senders)
      if (sends_urgently(p)) scratch_.candidates.push_back(p);
  const std::size_t senders = scratch_.candidates.size();
  if (state_.committed == 0 && state_.urgent == 0 && senders == 0) return false;
  const auto end = [&] { return scratch_.candidates.begin() + static_cast<std::ptrdiff_t>(senders); };
  for (std::size_t p = 0; p < processes(); ++p) {
    const Outlook& here = outlooks_[p];
    const bool due = race_.due[p] == now_ && race_.waits[p] != Wait::to_look;
    const bool first = state_.committed > 0 ? here.committed : here.urgent || due;
    if (first && std::find(scratch_.candidates.begin(), end(), p) == end()) scratch_.candidates.push_back(p);
  }
  return true;
}

// Whether an urgent synchronisation of the process stops time.
bool Simulator::sends_urgently(std::size_t process) {
  for (const std::uint32_t number : place(process).urgent) {
    if (!open(number)) continue;
    const std::int32_t channel = channel_of(program_.edges[number]);
    const program::Channel& kind = program_.channels[static_cast<std::size_t>(channel)];
    if (kind.urgent && (kind.broadcast || has_receiver(process, channel, false))) return true;
  }
  return false;
}

// Time cannot pass. Those who stop it, whom `frozen` has found, go first.
bool Simulator::act_now() {
  if (act_first(scratch_.candidates)) return true;
  const std::vector<std::size_t> tried = scratch_.candidates;
  scratch_.candidates.clear();
  for (std::size_t p = 0; p < processes(); ++p)
    if (std::find(tried.begin(), tried.end(), p) == tried.end()) scratch_.candidates.push_back(p);
  return act_first(scratch_.candidates);
}

// One of those that can act does, each with the same probability.
bool Simulator::act_first(std::vector<std::size_t>& candidates) {
  for (std::size_t left = candidates.size(); left > 0; --left) {
    const std::size_t n = left == 1 ? 0 : random_.below(left);
    if (act(candidates[n])) return true;
    std::swap(candidates[n], candidates[left - 1]);
  }
  return false;
}

// The process takes one of its edges, alone or with others; false if it cannot.
bool Simulator::act(std::size_t process) {
  if (program_.has_priorities) return act_by_priority(process);
  scratch_.offered.clear();
  for (const auto& [number, gate] : place(process).outputs)
    if (may_hold(gate) && open(number)) scratch_.offered.push_back(number);
  // Of a single edge it is asked below whether somebody receives.
  if (scratch_.offered.size() > 1)
    std::erase_if(scratch_.offered, [&](std::uint32_t number) { return !offers(process, number); });
  if (scratch_.offered.empty() || (scratch_.offered.size() == 1 && !offers_alone(process, scratch_.offered.front())))
    return false;
  return carry_out();
}

bool Simulator::take(std::uint32_t edge, flow::Ticks moment) {
  machine_.draw_from(&random_);  // this may be a copy of another simulator
  move_to(moment);
  scratch_.offered.assign(1, edge);
  return carry_out();
}

// Draws an action that begins with one of `scratch_.offered`, and takes it.
bool Simulator::carry_out() {
  for (int attempt = 0; attempt < attempts; ++attempt) {
    if (!choose(scratch_.offered)) return false;
    if (apply()) return true;
  }
  return act_exhaustively(scratch_.offered);
}

// Whether a single edge may be tried without asking who receives.
bool Simulator::offers_alone(std::size_t process, std::uint32_t number) {
  const Edge& edge = program_.edges[number];
  if (edge.internal()) return admits(process);
  const std::int32_t channel = channel_of(edge);
  return !program_.channels[static_cast<std::size_t>(channel)].broadcast || offers(process, number);
}

// Whether an edge whose guard holds can be taken, but for target invariants.
bool Simulator::offers(std::size_t process, std::uint32_t number) {
  const Edge& edge = program_.edges[number];
  if (edge.internal()) return admits(process);
  const std::int32_t channel = channel_of(edge);
  const bool broadcast = program_.channels[static_cast<std::size_t>(channel)].broadcast;
  if (broadcast && admits(process)) return true;
  return has_receiver(process, channel, !admits(process));
}

bool Simulator::has_receiver(std::size_t sender, std::int32_t channel, bool committed_only) {
  for (const std::uint32_t q : tables_.listening[static_cast<std::size_t>(channel)]) {
    if (q == sender) continue;
    const Station& there = place(q);
    if (committed_only && !there.location->committed) continue;
    for (const Reception& other : there.receives)
      if (hears(other, channel)) return true;
  }
  return false;
}

void Simulator::open_receives(std::size_t process, std::int32_t channel, std::vector<std::uint32_t>& found) {
  found.clear();
  for (const Reception& other : place(process).receives)
    if (hears(other, channel)) found.push_back(other.edge);
}

double Simulator::weight(std::uint32_t edge) {
  if (policy_ == Policy::uniform) return 1.0;
  const flow::Number& number = chances_.weights[edge];
  const double value = number.value(machine_, state_.slots.data());
  if (!(value >= 0)) throw machine::ModelFault(machine::FaultKind::range, number.code);
  return value;
}

// Each way with the same probability, and of a way into a branchpoint each branch by its weight.
std::vector<std::pair<std::uint32_t, double>> Simulator::shares(std::span<const std::uint32_t> edges) {
  std::vector<std::pair<std::uint32_t, double>> result;
  std::vector<std::pair<std::uint32_t, double>> totals;  // of each way
  for (const std::uint32_t edge : edges) {
    const std::uint32_t way = chances_.choices[edge];
    const auto same = std::find_if(totals.begin(), totals.end(), [&](const auto& each) { return each.first == way; });
    const double share = weight(edge);
    result.emplace_back(edge, share);
    if (same == totals.end())
      totals.emplace_back(way, share);
    else
      same->second += share;
  }
  for (auto& [edge, share] : result) {
    const std::uint32_t way = chances_.choices[edge];
    const auto total = std::find_if(totals.begin(), totals.end(), [&](const auto& each) { return each.first == way; });
    share = total->second > 0 ? share / (total->second * static_cast<double>(totals.size())) : 0.0;
  }
  return result;
}

std::uint32_t Simulator::pick(std::span<const std::uint32_t> edges) {
  if (edges.size() == 1) return edges.front();
  if (!tables_.has_branches) return edges[random_.below(edges.size())];
  const auto known = shares(edges);
  double total = 0;
  for (const auto& [edge, share] : known) total += share;
  double left = random_.fraction() * total;
  std::uint32_t last = edges.front();
  for (const auto& [edge, share] : known) {
    if (share <= 0) continue;
    last = edge;
    if (left < share) break;
    left -= share;
  }
  return last;
}

// Draws an action that begins with one of the edges; false if nobody receives.
bool Simulator::choose(std::span<const std::uint32_t> offered) {
  const std::uint32_t first = pick(offered);
  const Edge& edge = program_.edges[first];
  action_.assign(1, first);
  if (edge.internal()) return true;
  const std::int32_t channel = channel_of(edge);
  const std::vector<std::uint32_t>& listening = tables_.listening[static_cast<std::size_t>(channel)];
  const bool broadcast = program_.channels[static_cast<std::size_t>(channel)].broadcast;
  const bool committed_only = !broadcast && !admits(edge.process);
  std::uint64_t partners = 0;
  for (const std::uint32_t q : listening) {
    if (q == edge.process || (committed_only && !place(q).location->committed)) continue;
    open_receives(q, channel, scratch_.heard);
    if (scratch_.heard.empty()) continue;
    if (broadcast) {
      action_.push_back(pick(scratch_.heard));
      continue;
    }
    ++partners;
    if (partners == 1 || random_.below(partners) == 0) std::swap(scratch_.heard, scratch_.partner);
  }
  if (broadcast) return true;
  if (partners > 0) action_.push_back(pick(scratch_.partner));
  return partners > 0;
}

// Draws among all actions that target invariants admit, by the probabilities that `choose` gives them.
bool Simulator::act_exhaustively(std::span<const std::uint32_t> offered) {
  std::vector<std::vector<std::uint32_t>> actions;
  std::vector<double> probabilities;
  for (const auto& [edge, share] : shares(offered)) enumerate(edge, actions, probabilities, share);
  while (!actions.empty()) {
    double total = 0;
    for (const double probability : probabilities) total += probability;
    if (total <= 0) return false;
    double left = random_.fraction() * total;
    std::size_t n = 0;
    while (n + 1 < actions.size() && left >= probabilities[n]) left -= probabilities[n++];
    action_ = actions[n];
    if (apply()) return true;
    actions.erase(actions.begin() + static_cast<std::ptrdiff_t>(n));
    probabilities.erase(probabilities.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return false;
}

// Appends the actions that begin with an edge, each with its probability.
void Simulator::enumerate(std::uint32_t first, std::vector<std::vector<std::uint32_t>>& actions,
                          std::vector<double>& probabilities, double probability) {
  const Edge& edge = program_.edges[first];
  std::vector<std::vector<std::uint32_t>> found{{first}};
  std::vector<double> chances{probability};
  if (!edge.internal()) {
    const std::int32_t channel = channel_of(edge);
    const bool broadcast = program_.channels[static_cast<std::size_t>(channel)].broadcast;
    std::vector<std::vector<std::uint32_t>> partners;
    for (const std::uint32_t q : tables_.listening[static_cast<std::size_t>(channel)]) {
      if (q == edge.process || (!broadcast && !admits(edge.process) && !place(q).location->committed)) continue;
      open_receives(q, channel, scratch_.heard);
      if (!scratch_.heard.empty()) partners.push_back(scratch_.heard);
    }
    const std::size_t count = partners.size();
    if (!broadcast && count > 0) {
      found.clear();
      chances.clear();
    }
    for (const std::vector<std::uint32_t>& heard : partners) {
      std::vector<std::vector<std::uint32_t>> longer = broadcast ? std::exchange(found, {}) : decltype(found){{first}};
      std::vector<double> of_longer = broadcast ? std::exchange(chances, {}) : std::vector<double>{probability};
      for (std::size_t n = 0; n < longer.size(); ++n)
        for (const auto& [other, share] : shares(heard)) {
          found.push_back(longer[n]);
          found.back().push_back(other);
          chances.push_back(of_longer[n] * share / (broadcast ? 1.0 : static_cast<double>(count)));
        }
    }
  }
  actions.insert(actions.end(), found.begin(), found.end());
  probabilities.insert(probabilities.end(), chances.begin(), chances.end());
}

// ---- priorities -----------------------------------------------------------------------------------------------------

// The process takes one of its actions, if none of higher priority is possible.
bool Simulator::act_by_priority(std::size_t process) {
  std::vector<std::vector<std::uint32_t>> actions;
  std::vector<double> probabilities;
  std::size_t own = 0;  // actions of the process, which stand first
  for (std::size_t n = 0; n < processes(); ++n) {
    const std::size_t p = n == 0 ? process : n <= process ? n - 1 : n;
    std::vector<std::uint32_t> offered;
    for (const auto& [number, gate] : place(p).outputs)
      if (may_hold(gate) && open(number) && offers(p, number)) offered.push_back(number);
    for (const auto& [edge, share] : shares(offered)) enumerate(edge, actions, probabilities, share);
    if (n == 0) own = actions.size();
  }
  std::optional<Priority> highest;
  for (const std::vector<std::uint32_t>& action : actions) {
    const Priority own_priority = priority(action);
    if ((!highest || *highest < own_priority) && admitted(action)) highest = own_priority;
  }
  std::vector<std::size_t> left;
  for (std::size_t n = 0; n < own; ++n)
    if (highest && priority(actions[n]) == *highest && admitted(actions[n])) left.push_back(n);
  double total = 0;
  for (const std::size_t n : left) total += probabilities[n];
  if (total <= 0) return false;
  double drawn = random_.fraction() * total;
  std::size_t chosen = 0;
  while (chosen + 1 < left.size() && drawn >= probabilities[left[chosen]]) drawn -= probabilities[left[chosen++]];
  action_ = actions[left[chosen]];
  return apply();
}

// Of the channel, then the highest of the processes that take part.
Simulator::Priority Simulator::priority(std::span<const std::uint32_t> action) {
  const Edge& first = program_.edges[action.front()];
  Priority result{first.internal() ? program_.default_priority
                                   : program_.channels[static_cast<std::size_t>(channel_of(first))].priority,
                  program_.processes[first.process].priority};
  for (const std::uint32_t number : action)
    result.second = std::max(result.second, program_.processes[program_.edges[number].process].priority);
  return result;
}

// Whether invariants admit the state after an action.
bool Simulator::admitted(std::span<const std::uint32_t> action) {
  const Random before = random_;
  action_.assign(action.begin(), action.end());
  const bool result = enter();
  undo();
  random_ = before;
  return result;
}

}  // namespace tachk::simulation
