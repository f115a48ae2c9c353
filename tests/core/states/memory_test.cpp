// The index from hashes to records, against a list.
#include "states/memory.hpp"

#include <cstdint>
#include <random>
#include <vector>

#include "check.hpp"
#include "states/parents.hpp"

namespace {

using namespace tachk::states;

// Few different hashes, close together at both ends of two segments, so that many records compete for the same places.
void test_erased_records_leave_no_gap() {
  std::mt19937 random(1);
  std::vector<std::uint64_t> hashes;
  for (std::uint32_t number = 0; number < 3000; ++number) {
    const std::uint64_t end = random() % 2 == 0 ? 0 : (std::uint64_t{1} << 58) - (std::uint64_t{40} << 48);
    const std::uint64_t segment = random() % 2 == 0 ? 0 : std::uint64_t{63} << 58;
    hashes.push_back(segment + end + (std::uint64_t{random() % 40} << 48) + random() % 1000);
  }
  HashIndex index;
  std::vector<bool> present(hashes.size(), false);
  const auto found = [&](std::uint32_t number) {
    return index.find(hashes[number], [&](std::uint32_t other) { return other == number; });
  };
  for (int round = 0; round < 20000; ++round) {
    const auto number = static_cast<std::uint32_t>(random() % hashes.size());
    if (present[number])
      index.erase(static_cast<std::uint32_t>(hashes[number] >> 32), number);
    else
      index.insert(hashes[number], number);
    present[number] = !present[number];
    if (round % 500 == 0)
      for (std::uint32_t each = 0; each < hashes.size(); ++each)
        CHECK(found(each) == (present[each] ? each : HashIndex::absent));
  }
  const std::size_t bytes = index.bytes();
  for (std::uint32_t number = 0; number < hashes.size(); ++number)
    if (present[number]) index.erase(static_cast<std::uint32_t>(hashes[number] >> 32), number);
  for (std::uint32_t number = 0; number < hashes.size(); ++number) {
    CHECK(found(number) == HashIndex::absent);
    index.insert(hashes[number], number);
  }
  CHECK(index.bytes() <= 2 * bytes);
}

// Of an index with many records at most a third is free, but for what a segment has just grown by.
void test_little_is_free() {
  std::mt19937_64 random(1);
  HashIndex index;
  for (std::uint32_t number = 0; number < 200000; ++number) {
    index.insert(random(), number);
    if (number > 20000) CHECK(index.bytes() <= number * 8 * 5 / 3);
  }
}

void test_parents_are_those_that_were_added() {
  std::mt19937 random(1);
  for (const std::uint32_t range : {1u, 2u, 3u, 70u, 5000u, 1u << 30, UINT32_MAX}) {
    Parents parents;
    std::vector<std::uint32_t> plain;
    std::uint32_t least = 0;
    for (int n = 0; n < 1000; ++n) {
      plain.push_back(n == 0 || n == 130 ? UINT32_MAX : least + static_cast<std::uint32_t>(random()) % range);
      if (range < 100) least += static_cast<std::uint32_t>(random() % 2);
      parents.append(plain.back());
      if (n % 37 == 0 || n > 990)
        for (std::uint32_t node = 0; node < plain.size(); ++node) CHECK(parents[node] == plain[node]);
    }
  }
}

void test_parents_in_order_take_a_byte() {
  Parents parents;
  for (std::uint32_t node = 0; node < 200000; ++node) parents.append(node / 2);
  CHECK(parents.bytes() < 200000);
}

}  // namespace

int main() {
  test_erased_records_leave_no_gap();
  test_little_is_free();
  test_parents_are_those_that_were_added();
  test_parents_in_order_take_a_byte();
  std::puts("the index finds what is there");
}
