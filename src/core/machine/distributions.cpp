#include "machine/distributions.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace tachk::machine {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double pi = 3.14159265358979323846;
constexpr double most = 1e9;  // the largest mean of a Poisson distribution

// In (0, 1].
double positive(Dice& dice) { return 1 - dice.fraction(); }

// Box, Muller, "A note on the generation of random normal deviates", 1958.
double normal(Dice& dice) {
  const double radius = std::sqrt(-2 * std::log(positive(dice)));
  return radius * std::cos(2 * pi * dice.fraction());
}

// Marsaglia, Tsang, "A simple method for generating gamma variables", 2000.
double gamma(double shape, Dice& dice) {
  if (!(shape > 0)) return nothing;
  if (shape < 1) {
    const double larger = gamma(shape + 1, dice);
    return larger * std::pow(positive(dice), 1 / shape);
  }
  const double d = shape - 1.0 / 3;
  const double c = 1 / std::sqrt(9 * d);
  while (true) {
    const double x = normal(dice);
    const double root = 1 + c * x;
    if (root <= 0) continue;
    const double v = root * root * root;
    if (std::log(positive(dice)) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v;
  }
}

double beta(double alpha, double other, Dice& dice) {
  const double first = gamma(alpha, dice);
  return first / (first + gamma(other, dice));
}

double logarithm_of_factorial(double k) {
  if (k < 10) {
    double product = 1;
    for (int n = 2; n <= k; ++n) product *= n;
    return std::log(product);
  }
  const double inverse = 1 / k;  // Stirling's series
  return (k + 0.5) * std::log(k) - k + 0.5 * std::log(2 * pi) +
         inverse * (1.0 / 12 - inverse * inverse * (1.0 / 360 - inverse * inverse / 1260));
}

// Inversion for small means; else transformed rejection (Hoermann, "The transformed rejection method for generating
// Poisson random variables", 1993, PTRS).
double poisson(double mean, Dice& dice) {
  if (!(mean >= 0 && mean <= most)) return nothing;
  if (mean < 10) {
    double left = dice.fraction();
    double probability = std::exp(-mean);
    double count = 0;
    while (left >= probability && probability > 0) {
      left -= probability;
      probability *= mean / ++count;
    }
    return count;
  }
  const double b = 0.931 + 2.53 * std::sqrt(mean);
  const double a = -0.059 + 0.02483 * b;
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
  const double limit = 0.9277 - 3.6224 / (b - 2);
  while (true) {
    const double u = dice.fraction() - 0.5;
    const double v = positive(dice);
    const double distance = 0.5 - std::fabs(u);
    const double k = std::floor((2 * a / distance + b) * u + mean + 0.43);
    if (distance >= 0.07 && v <= limit) return k;
    if (k < 0 || (distance < 0.013 && v > distance)) continue;
    const double height = std::log(v) + std::log(inverse_alpha) - std::log(a / (distance * distance) + b);
    if (height <= -mean + k * std::log(mean) - logarithm_of_factorial(k)) return k;
  }
}

// On 0 to 1.
double triangular(double mode, Dice& dice) {
  if (!(mode >= 0 && mode <= 1)) return nothing;
  const double share = dice.fraction();
  return share < mode ? std::sqrt(share * mode) : 1 - std::sqrt((1 - share) * (1 - mode));
}

double weibull(double shape, double scale, Dice& dice) {
  return shape > 0 && scale > 0 ? scale * std::pow(-std::log(positive(dice)), 1 / shape) : nothing;
}

double arcsine(double from, double till, Dice& dice) {
  const double sine = std::sin(0.5 * pi * dice.fraction());
  return from + (till - from) * sine * sine;
}

}  // namespace

double drawn(FloatingOperation operation, double left, double right, Dice& dice) {
  switch (operation) {
    case FloatingOperation::random:
      return dice.fraction() * left;
    case FloatingOperation::random_normal:
      return left + right * normal(dice);
    case FloatingOperation::random_poisson:
      return poisson(left, dice);
    case FloatingOperation::random_arcsine:
      return arcsine(left, right, dice);
    case FloatingOperation::random_gamma:
      return right > 0 ? right * gamma(left, dice) : nothing;
    case FloatingOperation::random_beta:
      return beta(left, right, dice);
    case FloatingOperation::random_weibull:
      return weibull(left, right, dice);
    case FloatingOperation::random_triangular:
      return triangular(left, dice);
    default:
      throw std::logic_error("unknown distribution");
  }
}

}  // namespace tachk::machine
