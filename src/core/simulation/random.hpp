// Random numbers of a run: they depend on the seed and the number of the run only, so that runs may be computed in any
// order and by any number of threads.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "machine/floating.hpp"

namespace tachk::simulation {

// xoshiro256++ (Blackman, Vigna, "Scrambled linear pseudorandom number generators", 2021), its state filled by
// splitmix64.
class Random final : public machine::Dice {
 public:
  Random(std::uint64_t seed, std::uint64_t run) {
    std::uint64_t key = mixed(seed + golden) ^ run;
    for (std::uint64_t& word : state_) word = mixed(key += golden);
  }

  std::uint64_t next() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

  // Each of 0 .. count - 1 with the same probability (Lemire, "Fast random integer generation in an interval", 2019).
  std::uint64_t below(std::uint64_t count) {
    auto product = static_cast<Wide>(next()) * count;
    if (static_cast<std::uint64_t>(product) < count) {
      const std::uint64_t least = -count % count;
      while (static_cast<std::uint64_t>(product) < least) product = static_cast<Wide>(next()) * count;
    }
    return static_cast<std::uint64_t>(product >> 64);
  }

  // In [0, 1).
  double fraction() override { return static_cast<double>(next() >> 11) * 0x1p-53; }

  // Exponentially distributed with mean 1.
  double exponential() { return -std::log(static_cast<double>((next() >> 11) + 1) * 0x1p-53); }

 private:
  __extension__ using Wide = unsigned __int128;
  static constexpr std::uint64_t golden = 0x9E3779B97F4A7C15u;

  static std::uint64_t mixed(std::uint64_t word) {
    word = (word ^ (word >> 30)) * 0xBF58476D1CE4E5B9u;
    word = (word ^ (word >> 27)) * 0x94D049BB133111EBu;
    return word ^ (word >> 31);
  }

  std::uint64_t state_[4];
};

}  // namespace tachk::simulation
