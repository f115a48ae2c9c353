// Which action is taken of those that can be: edges by their weights, receivers with the same probability.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "simulation/present.hpp"

namespace tachk::simulation {

using Action = std::vector<std::uint32_t>;  // its edges, that of the sender first

// The place of one of these weights, drawn in proportion to them; none if their sum is not positive.
std::optional<std::size_t> draw_weighted(std::span<const double> weights, Random& random);

// Actions, each with its probability.
struct WeightedActions {
  std::vector<Action> actions;
  std::vector<double> probabilities;

  void add(const Action& action, double probability);
  void remove(std::size_t place);
};

class ActionChoice {
 public:
  // Draws an action that begins with one of the edges; false if no process receives.
  bool choose(Present& present, std::span<const std::uint32_t> offered, Action& action);
  // Adds the actions that begin with one of the edges, with the probabilities that `choose` gives them.
  void enumerate(Present& present, std::span<const std::uint32_t> offered, WeightedActions& found);

 private:
  void enumerate_from(Present& present, std::uint32_t first, double probability, WeightedActions& found);

  std::vector<std::uint32_t> receiving_;
  std::vector<std::uint32_t> partner_;
};

}  // namespace tachk::simulation
