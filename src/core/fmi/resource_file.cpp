#include "fmi/resource_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <stdexcept>

namespace tachk::fmi {

using flow::latest_end;
using flow::Ticks;

namespace {

constexpr std::int64_t magic = 0x0A31'2E6B'6863'6174;  // "tachk.1\n"
constexpr double largest_time = 0x1p52;
__extension__ using Wide = __int128;

constexpr int precision = std::numeric_limits<double>::digits;

// The double that is nearest to a fraction; of two that are, the even one. The denominator is positive.
double nearest_ratio(Wide numerator, std::int64_t denominator) {
  constexpr std::int64_t exact = std::int64_t{1} << precision;
  if (-exact <= numerator && numerator <= exact && denominator <= exact)  // then one division rounds once
    return static_cast<double>(static_cast<std::int64_t>(numerator)) / static_cast<double>(denominator);
  const bool negative = numerator < 0;
  __extension__ using Natural = unsigned __int128;
  Natural rest = negative ? -static_cast<Natural>(numerator) : static_cast<Natural>(numerator);
  const auto divisor = static_cast<Natural>(denominator);
  Natural quotient = rest / divisor;
  rest %= divisor;
  // One bit more than a double has, and a last one that says whether something is left.
  int exponent = 0;
  while (quotient >> (precision + 1) != 0) {
    rest |= quotient & 1;
    quotient >>= 1;
    ++exponent;
  }
  while (rest != 0 && exponent <= 0 && quotient >> precision == 0) {
    const int missing = precision + 1 - static_cast<int>(std::bit_width(static_cast<std::uint64_t>(quotient)));
    rest <<= missing;
    quotient = quotient << missing | rest / divisor;
    rest %= divisor;
    exponent -= missing;
  }
  const std::uint64_t digits = static_cast<std::uint64_t>(quotient) << 1 | (rest != 0 ? 1 : 0);
  const double result = std::ldexp(static_cast<double>(digits), exponent - 1);
  return negative ? -result : result;
}

std::uint64_t little_endian(std::span<const char, 8> bytes) {
  std::uint64_t word = 0;
  for (std::size_t n = 8; n-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[n]);
  return word;
}

}  // namespace

// The file: 64-bit numbers, the lowest byte first.
struct ResourceFile::Numbers {
  explicit Numbers(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (!file.is_open() || bytes.size() % 8 != 0) throw std::invalid_argument("cannot read " + path);
    for (std::size_t n = 0; n < bytes.size(); n += 8)
      words.push_back(static_cast<std::int64_t>(little_endian(std::span<const char, 8>(bytes.data() + n, 8))));
    if (next() != magic) throw std::invalid_argument(path + " is not the network of a unit, or of another version");
  }

  std::int64_t next() {
    if (position >= words.size()) throw std::invalid_argument("the file of the network is too short");
    return words[position++];
  }

  std::span<const std::int64_t> sequence() {
    const std::int64_t size = next();
    if (size < 0 || static_cast<std::size_t>(size) > words.size() - position)
      throw std::invalid_argument("the file of the network is too short");
    position += static_cast<std::size_t>(size);
    return {words.data() + position - size, static_cast<std::size_t>(size)};
  }

  TimeScale time_scale() {
    const std::int64_t numerator = next();
    const std::int64_t denominator = next();
    if (numerator < 1 || denominator < 1) throw std::invalid_argument("bad unit of time in the file of the network");
    return {numerator, denominator};
  }

  std::vector<Variable> variables() {
    std::vector<Variable> result;
    const std::span<const std::int64_t> fields = sequence();
    for (std::size_t n = 0; n + 3 < fields.size(); n += 4) {
      if (fields[n] < 0 || fields[n] > 8 || fields[n + 1] < 0 || fields[n + 1] > 5)
        throw std::invalid_argument("bad variable in the file of the network");
      result.push_back({static_cast<Role>(fields[n]), static_cast<Type>(fields[n + 1]), fields[n + 2], fields[n + 3]});
    }
    return result;
  }

  std::vector<std::int64_t> words;
  std::size_t position = 0;
};

ResourceFile::ResourceFile(const std::string& path) : ResourceFile(Numbers(path)) {}

ResourceFile::ResourceFile(Numbers numbers)
    : fingerprint{numbers.next(), numbers.next()},
      scale(numbers.time_scale()),
      nudge(numbers.next()),
      variables(numbers.variables()),
      program(program::decode_program(numbers.sequence())),
      chances(flow::decode_chances(numbers.sequence(), program)),
      tables(program, chances) {
  const auto within = [](std::int64_t number, std::size_t count) {
    return number >= 0 && static_cast<std::size_t>(number) < count;
  };
  for (const Variable& variable : variables) {
    const std::size_t count = variable.role == Role::observed ? chances.observed.size()
                              : variable.role == Role::input  ? program.slots.size()
                                                              : program.edges.size();
    const bool known = variable.target == -1 || within(variable.target, program.slots.size());
    if (variable.role >= Role::observed && !(within(variable.number, count) && known))
      throw std::invalid_argument("bad variable in the file of the network");
  }
  if (nudge != -1 && !within(nudge, program.edges.size())) throw std::invalid_argument("bad edge in the network");
}

std::string ResourceFile::token() const {
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(fingerprint[0]),
                static_cast<unsigned long long>(fingerprint[1]));
  return text;
}

double TimeScale::seconds(Ticks ticks) const { return nearest_ratio(Wide{ticks} * numerator_, denominator_); }

bool TimeScale::holds(double seconds) const {
  const double ticks = std::abs(seconds) * static_cast<double>(denominator_) / static_cast<double>(numerator_);
  return std::abs(seconds) < largest_time && ticks < static_cast<double>(latest_end);
}

Ticks TimeScale::ticks(double seconds) const {
  if (!(std::abs(seconds) < largest_time)) throw std::invalid_argument("a time is too large");
  const double whole = std::floor(seconds);
  const Wide product = Wide{static_cast<std::int64_t>(whole)} * denominator_;
  const double rest = static_cast<double>(product % numerator_) + (seconds - whole) * static_cast<double>(denominator_);
  const Wide result = product / numerator_ + static_cast<Wide>(std::llround(rest / static_cast<double>(numerator_)));
  if (result > latest_end || result < -latest_end) throw std::invalid_argument("a time is too large");
  return static_cast<Ticks>(result);
}

Ticks TimeScale::slack(double seconds) const {
  const double apart = 4 * (std::nextafter(std::abs(seconds), std::numeric_limits<double>::max()) - std::abs(seconds));
  return 1 + static_cast<Ticks>(std::min(apart * static_cast<double>(denominator_) / static_cast<double>(numerator_),
                                         static_cast<double>(latest_end)));
}

}  // namespace tachk::fmi
