// The samples of a trace as the caller holds them, and what atoms say about a block of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "monitoring/monitor_program.hpp"

namespace tachk::monitoring {

// One column; exactly one of the pointers is set.
struct Column {
  const double* numbers = nullptr;
  const std::uint8_t* flags = nullptr;  // zero or not
};

// Rows of a trace. The value given at a tick holds until the next; of rows with the same tick the last one counts.
struct Samples {
  const std::int64_t* ticks = nullptr;  // never decreasing
  const Column* columns = nullptr;      // as many as the program has
  std::size_t count = 0;
  bool rising = false;  // it is known that each tick is later than the one before, also than the last one before these
};

// Evaluates the atoms of one program on up to `block` consecutive samples at a time. Comparisons with NaN are false,
// except != which is true. The program must outlive the evaluator.
class AtomEvaluator {
 public:
  static constexpr std::size_t block = 1024;

  explicit AtomEvaluator(const MonitorProgram& program);

  // out[n] = 1 if the atom holds at sample first + n, else 0.
  void truth(std::size_t atom, const Samples& samples, std::size_t first, std::size_t count, std::uint8_t* out);
  // out[n] = how far the atom is from changing its truth: r - l for l < r and l <= r, l - r for > and >=, -|l - r| for
  // ==, |l - r| for !=; plus or minus infinity for `truth` and where the difference is NaN.
  void robustness(std::size_t atom, const Samples& samples, std::size_t first, std::size_t count, double* out);
  // The left value of the atom.
  void left_value(std::size_t atom, const Samples& samples, std::size_t first, std::size_t count, double* out);

 private:
  using Block = std::vector<double>;
  // The value of `code`: where the column or the computed block lies, always `count` doubles.
  const double* value(const std::vector<ValueInstruction>& code, std::size_t base, const Samples& samples,
                      std::size_t first, std::size_t count);

  const MonitorProgram* program_;
  std::vector<Block> stack_;
};

}  // namespace tachk::monitoring
