// The orders in which stored states are explored: one row of a table each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "program/program.hpp"
#include "states/store.hpp"

namespace tachk::order {

// `automatic`: breadth first, and by progress once that turns out to explore most states in vain.
enum class SearchOrder { automatic, breadth_first, depth_first, random_depth_first, progress, best_first };

// A new state, which follows from the one begun last, and the older ones that it covers.
struct NewState {
  std::uint32_t node;
  const std::int32_t* slots;
  const std::vector<std::uint32_t>& covered;
};

// The states that wait when an order takes over: those with numbers from `first` on, unless they are covered.
struct Beginning {
  const program::Program& program;
  states::PassedList& states;
  std::uint32_t first;
  std::uint32_t seed;
};

// The states that wait, in an order other than that of their numbers.
class Order {
 public:
  virtual ~Order() = default;
  // Takes over the states that wait, by adding each.
  virtual void start(const Beginning& at);
  virtual void add(const NewState& state) = 0;
  // The next in order; no_node if none is left.
  virtual std::uint32_t next() = 0;
  // The state taken last is going to be expanded; its slots.
  virtual void begin(const std::int32_t* slots) { static_cast<void>(slots); }
  // All successors of a state have been added.
  virtual void close() {}
  virtual std::size_t bytes() const = 0;
};

struct OrderRow {
  const char* name;                                     // in tachk.engine.options
  std::unique_ptr<Order> (*make)(const Beginning& at);  // that has started; null: breadth first, at least to begin with
};

// In the order of the enumeration.
std::span<const OrderRow> orders();
inline const OrderRow& row_of(SearchOrder order) { return orders()[static_cast<std::size_t>(order)]; }

}  // namespace tachk::order
