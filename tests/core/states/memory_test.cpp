// The index from hashes to records, against a list.
#include "states/memory.hpp"

#include <cstdint>
#include <random>
#include <vector>

#include "check.hpp"

namespace {

using namespace tachk;

// Few different hashes, close together at both ends of the table, so that many records compete for the same places.
void test_erased_records_leave_no_gap() {
  std::mt19937 random(1);
  std::vector<std::uint64_t> hashes;
  for (std::uint32_t number = 0; number < 3000; ++number) {
    const std::uint64_t end = random() % 2 == 0 ? 0 : UINT64_MAX - (std::uint64_t{40} << 54);
    hashes.push_back(end + (std::uint64_t{random() % 40} << 54) + random() % 1000);
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

}  // namespace

int main() {
  test_erased_records_leave_no_gap();
  std::puts("the index finds what is there");
}
