#include "flow/chances.hpp"

#include <bit>
#include <cstddef>
#include <cstring>
#include <stdexcept>

namespace tachk::flow {

using program::Program;

namespace {

class ChancesDecoder {
 public:
  ChancesDecoder(std::span<const std::int64_t> image, const Program& program) : image_(image), program_(program) {}

  Chances decode() {
    Chances chances;
    for (const program::Process& process : program_.processes) {
      std::vector<Number>& rates = chances.rates.emplace_back();
      for (std::size_t n = 0; n < process.locations.size(); ++n) rates.push_back(number());
    }
    for (std::size_t n = 0; n < program_.edges.size(); ++n) {
      const std::int64_t choice = next();
      if (choice < 0 || static_cast<std::size_t>(choice) >= program_.edges.size())
        throw std::invalid_argument("bad choice in image");
      chances.choices.push_back(static_cast<std::uint32_t>(choice));
      chances.weights.push_back(number());
    }
    hybrid_clocks(chances);
    for (std::size_t left = below(program_.slots.size() + 1); left > 0; --left)
      chances.starts.push_back(static_cast<std::int32_t>(below(program_.code.size())));
    while (position_ < image_.size()) chances.observed.push_back(number());
    return chances;
  }

 private:
  void hybrid_clocks(Chances& chances) {
    for (std::size_t left = below(program_.slots.size() + 1); left > 0; --left)
      chances.hybrid.push_back(static_cast<std::uint32_t>(below(program_.state_slots - 1)));
    if (chances.hybrid.empty()) return;
    for (const program::Process& process : program_.processes) {
      std::vector<std::vector<FlowRate>>& rates = chances.flow_rates.emplace_back(process.locations.size());
      for (std::vector<FlowRate>& of_location : rates)
        for (std::size_t left = below(image_.size()); left > 0; --left) {
          const auto clock = static_cast<std::uint32_t>(below(chances.hybrid.size()));
          const bool varies = next() != 0;
          of_location.push_back({clock, varies, number()});
        }
    }
    for (std::size_t left = below(program_.slots.size() + 1); left > 0; --left)
      chances.flow_reads.add(below(program_.slots.size()));
  }

  std::size_t below(std::size_t limit) {
    const std::int64_t value = next();
    if (value < 0 || static_cast<std::size_t>(value) >= limit)
      throw std::invalid_argument("bad number in image of chances");
    return static_cast<std::size_t>(value);
  }
  std::int64_t next() {
    if (position_ >= image_.size()) throw std::invalid_argument("image of chances is too short");
    return image_[position_++];
  }
  Number number() {
    const std::int64_t kind = next();
    const std::int64_t given = next();
    if (kind < 0 || kind > 4) throw std::invalid_argument("bad kind of number in image");
    const Number constant{static_cast<Number::Kind>(kind), std::bit_cast<double>(given), program::no_code};
    if (constant.is_constant()) return constant;
    const std::size_t limit = kind == 3 ? program_.slots.size() : program_.code.size();
    if (given < 0 || static_cast<std::size_t>(given) >= limit)
      throw std::invalid_argument("bad code position or slot in image");
    return {static_cast<Number::Kind>(kind), 0.0, static_cast<std::int32_t>(given)};
  }

  std::span<const std::int64_t> image_;
  const Program& program_;
  std::size_t position_ = 0;
};

}  // namespace

double Number::value(machine::Machine& machine, std::int32_t* slots) const {
  if (is_constant()) return constant;
  if (kind == Kind::slot) return static_cast<double>(slots[code]);
  const std::int64_t result = machine.value(code, slots);
  return kind == Kind::integer_code ? static_cast<double>(result) : machine::double_at(slots + result);
}

Chances decode_chances(std::span<const std::int64_t> image, const Program& program) {
  return ChancesDecoder(image, program).decode();
}

}  // namespace tachk::flow
