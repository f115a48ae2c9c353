#include "flow/flow.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tachk::flow {

using machine::Machine;
using machine::ModelFault;
using machine::store_double;

namespace {

constexpr double longest_step = 0.1;  // units of time
constexpr double shortest_step = 1e-9;
constexpr double tolerance = 1e-9;  // of each step, absolute and relative

constexpr int stages = 7;
constexpr double weights[stages][6] = {
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
constexpr double errors[stages] = {
    71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40,
};
constexpr double between[stages] = {
    -12715105075.0 / 11282082432,  0,
    87487479700.0 / 32700410799,   -10690763975.0 / 1880347072,
    701980252875.0 / 199316789632, -1453857185.0 / 822651844,
    69997945.0 / 29380423,
};

}  // namespace

void Flow::write(const Numbers& values, std::int32_t* slots) const {
  for (std::size_t n = 0; n < values.size(); ++n) store_double(values[n], slots + chances_->hybrid[n]);
}

void Flow::rates(const Numbers& values, Numbers& result, Machine& machine, std::int32_t* slots) const {
  write(values, slots);
  result.resize(values.size());
  for (std::size_t n = 0; n < values.size(); ++n)
    result[n] = active_[n] == nullptr ? 1.0 : active_[n]->rate.value(machine, slots);
}

void Flow::start(Ticks now, Machine& machine, std::int32_t* slots) {
  begin_ = now;
  fault_.reset();
  steps_.clear();
  first_.clear();
  for (const std::uint32_t slot : chances_->hybrid) first_.push_back(machine::double_at(slots + slot));
  active_.assign(clocks(), nullptr);
  linear_ = true;
  for (std::size_t p = 0; p < chances_->flow_rates.size(); ++p)
    for (const FlowRate& rate : chances_->flow_rates[p][static_cast<std::size_t>(slots[p])]) {
      active_[rate.clock] = &rate;
      linear_ = linear_ && !rate.varies;
    }
  rates(first_, slopes_, machine, slots);
  last_ = first_;
  stages_[0] = slopes_;
  length_ = longest_step / 10;
}

Ticks Flow::known_up_to(Ticks wanted, Machine& machine, std::int32_t* slots) {
  if (linear_) return wanted;
  extend(since_start(wanted), machine, slots);
  if (!fault_ || known() >= since_start(wanted)) return wanted;
  return begin_ + static_cast<Ticks>(known() * static_cast<double>(ticks_per_unit_));
}

void Flow::show(Ticks moment, Machine& machine, std::int32_t* slots) {
  const double since = since_start(moment);
  if (linear_ || since <= 0) {
    for (std::size_t n = 0; n < first_.size(); ++n)
      store_double(since <= 0 ? first_[n] : first_[n] + slopes_[n] * since, slots + chances_->hybrid[n]);
    return;
  }
  extend(since, machine, slots);
  if (known() < since) throw ModelFault(*fault_);
  const auto behind = std::upper_bound(steps_.begin(), steps_.end(), since,
                                       [](double value, const Step& step) { return value < step.begin; });
  const Step& step = *(behind - 1);
  const double share = (since - step.begin) / step.length;
  const double rest = 1 - share;
  const std::size_t count = clocks();
  for (std::size_t n = 0; n < count; ++n) {
    const auto c = [&](std::size_t number) { return step.coefficients[number * count + n]; };
    const double value = c(0) + share * (c(1) + rest * (c(2) + share * (c(3) + rest * c(4))));
    store_double(value, slots + chances_->hybrid[n]);
  }
}

void Flow::extend(double wanted, Machine& machine, std::int32_t* slots) {
  while (!fault_ && known() < wanted) {
    try {
      advance(machine, slots);
    } catch (const ModelFault& fault) {
      fault_ = fault;
    }
  }
}

// Tries a step from the last values, and returns its error: at most 1 is small enough.
double Flow::try_step(double length, Machine& machine, std::int32_t* slots) {
  const std::size_t count = clocks();
  for (int stage = 1; stage < stages; ++stage) {
    tried_ = last_;
    for (int other = 0; other < stage; ++other)
      for (std::size_t n = 0; n < count; ++n) tried_[n] += length * weights[stage][other] * stages_[other][n];
    rates(tried_, stages_[stage], machine, slots);
  }
  double largest = 0;
  for (std::size_t n = 0; n < count; ++n) {
    double error = 0;
    for (int stage = 0; stage < stages; ++stage) error += length * errors[stage] * stages_[stage][n];
    const double scale = tolerance * (1 + std::max(std::fabs(last_[n]), std::fabs(tried_[n])));
    largest = std::max(largest, std::fabs(error) / scale);
  }
  return largest;
}

// As above; infinite where a rate has no value on the way.
double Flow::error_of(double length, Machine& machine, std::int32_t* slots) {
  try {
    const double error = try_step(length, machine, slots);
    return std::isnan(error) ? HUGE_VAL : error;
  } catch (const ModelFault&) {
    if (length <= shortest_step) throw;
    return HUGE_VAL;
  }
}

void Flow::advance(Machine& machine, std::int32_t* slots) {
  double length = length_;
  double error = error_of(length, machine, slots);
  while (error > 1 && length > shortest_step) {
    length = std::max(shortest_step, length * std::clamp(0.9 * std::pow(error, -0.2), 0.1, 0.5));
    error = error_of(length, machine, slots);
  }
  const std::size_t count = clocks();
  Step step{known(), length, Numbers(5 * count)};
  for (std::size_t n = 0; n < count; ++n) {
    if (!std::isfinite(tried_[n])) throw ModelFault(machine::FaultKind::not_finite, program::no_code);
    const double change = tried_[n] - last_[n];
    const double bent = length * stages_[0][n] - change;
    double last = 0;
    for (int stage = 0; stage < stages; ++stage) last += length * between[stage] * stages_[stage][n];
    const double coefficients[] = {last_[n], change, bent, change - length * stages_[6][n] - bent, last};
    for (std::size_t number = 0; number < 5; ++number) step.coefficients[number * count + n] = coefficients[number];
  }
  steps_.push_back(std::move(step));
  last_ = tried_;
  std::swap(stages_[0], stages_[6]);
  const double growth = error > 0 ? 0.9 * std::pow(error, -0.2) : 5.0;
  length_ = std::clamp(length * std::clamp(growth, 0.2, 5.0), shortest_step, longest_step);
}

}  // namespace tachk::flow
