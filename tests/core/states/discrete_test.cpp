// Discrete states in chunks: each is found again, also when there are too many chunks for numbers of 16 bits.
#include "states/discrete.hpp"

#include <cstdint>
#include <cstdio>
#include <vector>

#include "check.hpp"

namespace {

using namespace tachk::program;
using namespace tachk::states;

constexpr std::size_t slots = 10;  // two in a word and in a chunk

std::vector<std::int32_t> state(std::uint32_t n) {
  std::vector<std::int32_t> values(slots, 7);
  values[0] = static_cast<std::int32_t>(n % 300);
  values[2] = static_cast<std::int32_t>(n / 3);
  values[5] = static_cast<std::int32_t>(n / 2);
  values[9] = static_cast<std::int32_t>(n);
  return values;
}

void check_all(DiscreteStates& states, std::uint32_t count) {
  std::vector<std::int32_t> values(slots);
  for (std::uint32_t n = 0; n < count; ++n) {
    states.unpack(n, values.data());
    CHECK(values == state(n));
    CHECK(states.note(n) == n % 5);
    if (n % 16 != 0) continue;
    CHECK(states.equals(n, state(n).data()));
    CHECK(!states.equals(n, state(n + 1).data()));
    states.announce(state(n).data(), SlotSet::all());
    CHECK(states.locate(99) == n);
  }
}

}  // namespace

int main() {
  Program program;
  program.state_slots = slots;
  program.slots.assign(slots, Slot{0, INT32_MAX, 0, false});
  DiscreteStates states(program, 1);
  constexpr std::uint32_t before = 30000;  // chunks: 300 + 10000 + 15000 + 30000
  constexpr std::uint32_t after = 60000;
  std::size_t bytes_each = 0;
  for (std::uint32_t n = 0; n < after; ++n) {
    states.announce(state(n).data(), SlotSet::all());
    CHECK(states.locate(n % 5) == n);
    if (n + 1 != before) continue;
    check_all(states, before);
    bytes_each = states.bytes() / before;
  }
  check_all(states, after);
  CHECK(bytes_each < states.bytes() / after);
  std::puts("discrete states in chunks are found again");
}
