#include "json_lines/json_reader.hpp"

#include <cstdlib>
#include <cstring>
#include <limits>
#include <utility>

#include "csv/date_text.hpp"
#include "decimals/number_text.hpp"

namespace tachk::json_lines {

namespace {

using decimals::Decimal;
using decimals::is_digit;

constexpr int deepest = 64;
constexpr std::ptrdiff_t longest_number = 300;  // whole numbers of more digits may be larger than all of 64 bits
constexpr std::uint32_t most_decimals = 9;      // times with more may have been binary numbers

// Lines end with a line break, which is no part of any value: no length is needed.
const char* past_blanks(const char* p) {
  while (*p == ' ' || *p == '\t' || *p == '\r') ++p;
  return p;
}

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20; }

// Whether a number is written as JSON says, without zeros before its first digit.
bool is_well_formed(const char* p, const char* end) {
  if (*p == '-') ++p;
  if (!is_digit(*p) || (*p == '0' && is_digit(p[1]))) return false;
  while (is_digit(*p)) ++p;
  if (*p == '.' && !is_digit(*++p)) return false;
  while (is_digit(*p)) ++p;
  if (p == end) return true;
  if (*p != 'e' && *p != 'E') return false;
  ++p;
  if (*p == '+' || *p == '-') ++p;
  if (!is_digit(*p)) return false;
  while (is_digit(*p)) ++p;
  return p == end;
}

// The place behind four digits of a hexadecimal number, or nullptr.
const char* read_unit(const char* p, std::uint32_t& unit) {
  unit = 0;
  for (int n = 0; n < 4; ++n, ++p) {
    const char lower = static_cast<char>(*p | 0x20);
    if (is_digit(*p))
      unit = 16 * unit + static_cast<std::uint32_t>(*p - '0');
    else if (lower >= 'a' && lower <= 'f')
      unit = 16 * unit + static_cast<std::uint32_t>(lower - 'a' + 10);
    else
      return nullptr;
  }
  return p;
}

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&text](std::uint32_t octet) { text.push_back(static_cast<char>(octet)); };
  if (code < 0x80) {
    put(code);
    return;
  }
  if (code < 0x800) {
    put(0xC0 | code >> 6);
  } else {
    if (code < 0x10000) {
      put(0xE0 | code >> 12);
    } else {
      put(0xF0 | code >> 18);
      put(0x80 | (code >> 12 & 0x3F));
    }
    put(0x80 | (code >> 6 & 0x3F));
  }
  put(0x80 | (code & 0x3F));
}

}  // namespace

JsonReader::JsonReader(std::string time, bool dates)
    : time_(std::move(time)), dates_(dates), times_({.shortening = !dates}) {}

bool JsonReader::feed(std::string_view piece) {
  if (gave_up_) return false;
  if (!pending_.empty()) {
    const std::size_t end = piece.find('\n');
    pending_.append(piece.substr(0, end == std::string_view::npos ? piece.size() : end + 1));
    if (end == std::string_view::npos) return true;
    if (!read_lines(pending_.data(), pending_.data() + pending_.size())) return give_up();
    pending_.clear();
    piece.remove_prefix(end + 1);
  }
  const std::size_t last = piece.rfind('\n');
  if (last != std::string_view::npos) {
    if (!read_lines(piece.data(), piece.data() + last + 1)) return give_up();
    piece.remove_prefix(last + 1);
  }
  pending_.assign(piece);
  return true;
}

bool JsonReader::finish() {
  if (gave_up_) return false;
  if (!pending_.empty()) {
    pending_.push_back('\n');
    if (!read_lines(pending_.data(), pending_.data() + pending_.size())) return give_up();
    pending_.clear();
  }
  return true;
}

bool JsonReader::give_up() {
  gave_up_ = true;
  pending_ = {};
  times_.take();
  columns_ = {};
  numbers_ = {};
  return false;
}

std::vector<JsonColumn> JsonReader::take_columns() {
  numbers_.clear();
  return std::exchange(columns_, {});
}

bool JsonReader::read_lines(const char* begin, const char* end) {
  while (begin != end) {
    if (!read_line(begin)) return false;
    begin = static_cast<const char*>(std::memchr(begin, '\n', static_cast<std::size_t>(end - begin))) + 1;
  }
  return true;
}

bool JsonReader::read_line(const char* p) {
  p = past_blanks(p);
  if (*p == '\n') return true;
  if (*p != '{') return false;
  path_.clear();
  timed_ = false;
  p = read_object(p + 1, 0);
  if (p == nullptr || !timed_) return false;
  ++row_;
  return *past_blanks(p) == '\n';
}

// The place behind the object, or nullptr, as all functions that read.
const char* JsonReader::read_object(const char* p, int depth) {
  p = past_blanks(p);
  if (*p == '}') return p + 1;
  const std::size_t size = path_.size();
  for (;;) {
    if (*p != '"') return nullptr;
    if (size > 0) path_.push_back('.');
    const std::size_t before = path_.size();
    p = read_text(p + 1, path_);
    if (p == nullptr || path_.size() == before) return nullptr;
    p = past_blanks(p);
    if (*p != ':') return nullptr;
    p = read_value(past_blanks(p + 1), depth);
    if (p == nullptr) return nullptr;
    path_.resize(size);
    p = past_blanks(p);
    if (*p == '}') return p + 1;
    if (*p != ',') return nullptr;
    p = past_blanks(p + 1);
  }
}

const char* JsonReader::read_array(const char* p, int depth) {
  p = past_blanks(p);
  if (*p == ']') return p + 1;
  const std::size_t size = path_.size();
  for (std::size_t number = 0;; ++number) {
    path_.push_back('[');
    path_ += std::to_string(number);
    path_.push_back(']');
    p = read_value(p, depth);
    if (p == nullptr) return nullptr;
    path_.resize(size);
    p = past_blanks(p);
    if (*p == ']') return p + 1;
    if (*p != ',') return nullptr;
    p = past_blanks(p + 1);
  }
}

const char* JsonReader::read_value(const char* p, int depth) {
  if (*p == '{' || *p == '[') {
    if (depth == deepest) return nullptr;
    return *p == '{' ? read_object(p + 1, depth + 1) : read_array(p + 1, depth + 1);
  }
  if (path_ == time_) {
    if (timed_) return nullptr;
    timed_ = true;
    return dates_ ? read_date(p) : read_time(p);
  }
  return read_plain(p);
}

// Appends a text, of which `p` stands behind the first quotation mark.
const char* JsonReader::read_text(const char* p, std::string& text) {
  for (;;) {
    const char* const begin = p;
    while (*p != '"' && *p != '\\' && !is_control(*p)) ++p;
    text.append(begin, p);
    if (*p == '"') return p + 1;
    if (*p != '\\') return nullptr;
    p = read_escape(p + 1, text);
    if (p == nullptr) return nullptr;
  }
}

const char* JsonReader::read_escape(const char* p, std::string& text) {
  constexpr std::string_view names = "\"\\/bfnrt";
  constexpr std::string_view meant = "\"\\/\b\f\n\r\t";
  if (*p != 'u') {
    const std::size_t place = names.find(*p);
    if (place == std::string_view::npos) return nullptr;
    text.push_back(meant[place]);
    return p + 1;
  }
  std::uint32_t code = 0;
  p = read_unit(p + 1, code);
  if (p == nullptr) return nullptr;
  if (code >= 0xD800 && code < 0xE000) {  // half of a character of UTF-16; the other half alone is none of UTF-8
    std::uint32_t low = 0;
    if (code >= 0xDC00 || p[0] != '\\' || p[1] != 'u') return nullptr;
    p = read_unit(p + 2, low);
    if (p == nullptr || low < 0xDC00 || low >= 0xE000) return nullptr;
    code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
  }
  append_utf8(text, code);
  return p;
}

const char* JsonReader::read_plain(const char* p) {
  const auto is_word = [p](std::string_view word) { return std::strncmp(p, word.data(), word.size()) == 0; };
  switch (*p) {
    case '"': {
      text_.clear();
      p = read_text(p + 1, text_);
      return p != nullptr && put(JsonKind::text, 0) ? p : nullptr;
    }
    case 't':
      return is_word("true") && put(JsonKind::truth, 1) ? p + 4 : nullptr;
    case 'f':
      return is_word("false") && put(JsonKind::truth, 0) ? p + 5 : nullptr;
    case 'n':
      return is_word("null") && put(JsonKind::none, 0) ? p + 4 : nullptr;
    case 'N':
      return is_word("NaN") && put(JsonKind::none, 0) ? p + 3 : nullptr;
    case 'I':
      return is_word("Infinity") && put(JsonKind::number, std::numeric_limits<double>::infinity()) ? p + 8 : nullptr;
    case '-':
      if (is_word("-Infinity"))
        return put(JsonKind::number, -std::numeric_limits<double>::infinity()) ? p + 9 : nullptr;
      return read_number_value(p);
    default:
      return read_number_value(p);
  }
}

const char* JsonReader::read_number_value(const char* p) {
  Decimal number;
  const char* const end = decimals::scan_decimal(p, '.', number);
  if (end == p || !is_well_formed(p, end)) return nullptr;
  if (end - p > longest_number) return nullptr;
  double value = 0;
  if (!decimals::is_divided(number, value)) {
    const auto [stopped, error] = decimals::read_number(p, end, value);
    if (error != std::errc{} || stopped != end) return nullptr;
  }
  const bool is_whole = std::string_view(p, end).find_first_of(".eE") == std::string_view::npos;
  if (is_whole && value == 0) value = 0;  // a whole number has no negative zero
  return put(JsonKind::number, value) ? end : nullptr;
}

const char* JsonReader::read_time(const char* p) {
  Decimal number;
  const char* const end = decimals::scan_decimal(p, '.', number);
  if (end == p || !is_well_formed(p, end)) return nullptr;
  if (std::string_view(p, end).find_first_of("eE") != std::string_view::npos) return nullptr;
  if (times_.put(number) != csv::CsvTimeFault::none) return nullptr;
  return times_.rounded() || times_.shortened() || times_.decimals() > most_decimals ? nullptr : end;
}

const char* JsonReader::read_date(const char* p) {
  if (*p != '"') return nullptr;
  csv::DateText date{p + 1};
  date.scan(',');
  date.sign('"');
  if (!date.right || date.decimals > static_cast<std::int64_t>(most_decimals)) return nullptr;
  std::int64_t total = date.seconds;
  for (std::int64_t n = 0; n < date.decimals; ++n)
    if (__builtin_mul_overflow(total, std::int64_t{10}, &total)) return nullptr;
  if (__builtin_add_overflow(total, date.fraction, &total)) return nullptr;
  const Decimal time{static_cast<std::uint64_t>(std::abs(total)), -date.decimals, total < 0};
  return times_.put(time) == csv::CsvTimeFault::none ? date.p : nullptr;
}

// The column of the value that is read; nullptr where the line names it twice.
JsonColumn* JsonReader::named() {
  const auto [place, is_new] = numbers_.try_emplace(path_, columns_.size());
  if (is_new) columns_.push_back({.name = path_, .kind = JsonKind::none, .rows = {}, .values = {}, .labels = {}});
  JsonColumn& column = columns_[place->second];
  if (column.last == row_) return nullptr;
  column.last = row_;
  return &column;
}

// Gives the column a value, of texts `text_`. False where it has values of another kind.
bool JsonReader::put(JsonKind kind, double value) {
  JsonColumn* const column = named();
  if (column == nullptr) return false;
  if (kind == JsonKind::none) return true;
  if (column->kind == JsonKind::none) column->kind = kind;
  if (column->kind != kind) return false;
  if (kind == JsonKind::text) {
    const auto [place, is_new] = column->places.try_emplace(text_, static_cast<double>(column->labels.size()));
    if (is_new) column->labels.push_back(text_);
    value = place->second;
  }
  column->rows.push_back(row_);
  column->values.push_back(value);
  return true;
}

}  // namespace tachk::json_lines
