#include "csv/csv_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "csv/date_text.hpp"
#include "decimals/number_text.hpp"

namespace tachk::csv {

namespace {

using decimals::is_digit;
using decimals::is_divided;
using decimals::read_number;
using decimals::scan_decimal;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

const char* past_blanks(const char* p, char separator) {
  while (is_blank(*p) && *p != separator) ++p;
  return p;
}

bool same_word(std::string_view text, std::string_view lower) {
  if (text.size() != lower.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i)
    if ((text[i] | 0x20) != lower[i]) return false;
  return true;
}

// How other programs write that there is no value.
bool is_missing(std::string_view text) {
  return same_word(text, "nan") || same_word(text, "-nan") || same_word(text, "na") || same_word(text, "null");
}

}  // namespace

CsvReader::CsvReader(CsvOptions options)
    : plan_(options.cells, skip),
      separator_(options.separator),
      point_(options.point),
      dates_(options.dates),
      line_(options.first_line - 1),
      complete_(options.columns.size() == options.unread.size()),
      times_(options.times),
      columns_(options.columns.size()) {
  if (options.time >= options.cells) throw std::invalid_argument("CsvReader: options out of range");
  plan_[options.time] = is_time;
  for (std::size_t i = 0; i < options.columns.size(); ++i) {
    const std::uint32_t cell = options.columns[i];
    if (cell >= options.cells || plan_[cell] != skip) throw std::invalid_argument("CsvReader: cell taken twice");
    plan_[cell] = static_cast<std::int32_t>(i);
    if (std::find(options.texts.begin(), options.texts.end(), cell) != options.texts.end())
      columns_[i].is_text = columns_[i].is_number = true;
    const auto among = [cell](const std::vector<std::uint32_t>& cells) {
      return std::find(cells.begin(), cells.end(), cell) != cells.end();
    };
    columns_[i].has_arrivals = among(options.arrivals);
    columns_[i].is_unread = columns_[i].is_known = among(options.unread);
    if (columns_[i].is_unread) columns_[i].is_text = columns_[i].is_number = true;
  }
}

void CsvReader::reserve(std::size_t rows) {
  times_.reserve(rows);
  for (CsvColumn& column : columns_) column.truths.reserve(rows);
}

bool CsvReader::feed(std::string_view piece) {
  if (fault_) return false;
  if (!pending_.empty()) {
    const std::size_t end = piece.find('\n');
    pending_.append(piece.substr(0, end == std::string_view::npos ? piece.size() : end + 1));
    if (end == std::string_view::npos) {
      if (pending_.size() > longest_line) {
        ++line_;
        pending_.push_back('\n');
        fail(CsvFaultKind::line_too_long, pending_.data(), pending_.data(), 0);
      }
      return !fault_;
    }
    read_lines(pending_.data(), pending_.data() + pending_.size());
    pending_.clear();
    piece.remove_prefix(end + 1);
    if (fault_) return false;
  }
  const std::size_t last = piece.rfind('\n');
  if (last != std::string_view::npos) {
    const char* const begin = piece.data();
    if (read_lines(begin, begin + last + 1) == nullptr) return false;
    piece.remove_prefix(last + 1);
  }
  pending_.assign(piece);
  return true;
}

bool CsvReader::finish(bool whole) {
  if (fault_) return false;
  if (!whole) pending_.clear();
  if (!pending_.empty()) {
    pending_.push_back('\n');
    cut_off_ = read_lines(pending_.data(), pending_.data() + pending_.size()) == nullptr;
    pending_.clear();
  }
  if (!fault_ && any_row_ && !complete_) {
    for (std::size_t cell = 0; cell < plan_.size(); ++cell)
      if (plan_[cell] >= 0 && !columns_[static_cast<std::size_t>(plan_[cell])].is_known && !fault_)
        fault_ = CsvFault{CsvFaultKind::missing_value, line_, 0, 0, "", static_cast<std::int32_t>(cell)};
  }
  return !fault_;
}

std::vector<CsvColumn> CsvReader::take_columns() {
  std::vector<CsvColumn> taken(columns_.size());
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    CsvColumn& column = columns_[i];
    taken[i].truths = std::exchange(column.truths, {});
    taken[i].numbers = std::exchange(column.numbers, {});
    taken[i].is_number = column.is_number;
    taken[i].has_words = column.has_words;
    taken[i].is_text = column.is_text;
    taken[i].last = column.last;
    taken[i].is_known = column.is_known;
    if (!column.is_text) continue;
    // The texts are numbered anew: a stream of many texts needs no more memory than a piece of it.
    taken[i].labels = std::exchange(column.labels, {});
    column.places.clear();
    if (taken[i].labels.empty()) continue;
    column.labels.push_back(taken[i].labels[static_cast<std::size_t>(column.last)]);
    column.places.emplace(column.labels.front(), 0);
    column.last = 0;
  }
  return taken;
}

std::vector<std::vector<std::uint8_t>> CsvReader::take_arrivals() {
  std::vector<std::vector<std::uint8_t>> taken;
  for (CsvColumn& column : columns_)
    if (column.has_arrivals) taken.push_back(std::exchange(column.arrivals, {}));
  return taken;
}

const char* CsvReader::read_lines(const char* begin, const char* end) {
  while (begin != end) {
    ++line_;
    const char* p = past_blanks(begin, separator_);
    if (*p == '\n') {
      begin = p + 1;
    } else if (*p == '#') {
      begin = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p))) + 1;
    } else {
      begin = read_line(begin);
      if (begin == nullptr) {
        forget_partial_row();
        return nullptr;
      }
    }
  }
  return end;
}

const char* CsvReader::read_line(const char* begin) {
  row_ = times_.size();
  const char* p = begin;
  const auto cells = static_cast<std::int32_t>(plan_.size());
  for (std::int32_t cell = 0; cell < cells; ++cell) {
    const std::int32_t step = plan_[static_cast<std::size_t>(cell)];
    const char* end = nullptr;
    if (step == is_time) {
      end = dates_ ? read_date(p, begin, cell) : read_time(p, begin, cell);
    } else if (step == skip) {
      end = skip_cell(p, begin, cell);
    } else {
      CsvColumn& column = columns_[static_cast<std::size_t>(step)];
      end = column.is_text || column.has_arrivals ? read_rare(column, p, begin, cell)
                                                  : read_value(column, p, begin, cell);
    }
    if (end == nullptr) return nullptr;
    const bool last = cell + 1 == cells;
    if ((*end == '\n') != last)
      return fail(last ? CsvFaultKind::too_many_cells : CsvFaultKind::too_few_cells, last ? end + 1 : end, begin, cell);
    p = end + 1;
  }
  any_row_ = true;
  if (!complete_) begin_later();
  return p;
}

const char* CsvReader::read_rare(CsvColumn& column, const char* begin, const char* line, std::int32_t cell) {
  held_ = false;
  const char* const end = column.is_text ? read_text(column, begin, line, cell) : read_value(column, begin, line, cell);
  if (column.has_arrivals) column.arrivals.push_back(held_ ? 0 : 1);
  return end;
}

// Of a row in which some column has had no value yet, only what the others hold is kept.
void CsvReader::begin_later() {
  complete_ = std::all_of(columns_.begin(), columns_.end(), [](const CsvColumn& column) { return column.is_known; });
  if (complete_) return;
  ++left_out_;
  times_.resize(0);
  for (CsvColumn& column : columns_) {
    column.truths.clear();
    column.numbers.clear();
    column.arrivals.clear();
    column.is_number = column.is_text || (column.is_known && column.last != 0 && column.last != 1);
  }
}

// An empty cell. False where it is the place of a value that is not known yet.
bool CsvReader::hold(CsvColumn& column) {
  const bool is_known = column.is_known;
  held_ = true;
  put_number(column, column.last);
  column.is_known = is_known;
  return is_known;
}

const char* CsvReader::close_cell(const char* rest, const char* begin, const char* line, std::int32_t cell) {
  rest = past_blanks(rest, separator_);
  return ends_cell(*rest) ? rest : fail(CsvFaultKind::not_a_number, begin, line, cell);
}

const char* CsvReader::read_time(const char* begin, const char* line, std::int32_t cell) {
  const char* p = past_blanks(begin, separator_);
  const bool quoted = *p == '"';
  if (quoted) ++p;
  if (ends_cell(*p)) return fail(CsvFaultKind::missing_time, begin, line, cell);
  Decimal number;
  const char* rest = scan_decimal(p, point_, number);
  if (rest == p) return fail(CsvFaultKind::not_a_number, begin, line, cell);
  if (quoted) {
    if (*rest != '"') return fail(CsvFaultKind::not_a_number, begin, line, cell);
    ++rest;
  }
  rest = close_cell(rest, begin, line, cell);
  if (rest == nullptr) return nullptr;
  return put_time(number, rest, begin, line, cell);
}

const char* CsvReader::read_date(const char* begin, const char* line, std::int32_t cell) {
  const char* p = past_blanks(begin, separator_);
  const bool quoted = *p == '"';
  if (quoted) ++p;
  if (ends_cell(*p)) return fail(CsvFaultKind::missing_time, begin, line, cell);
  DateText date{p};
  date.scan(separator_);
  if (quoted) date.sign('"');
  if (!date.right) return fail(CsvFaultKind::not_a_number, begin, line, cell);
  const char* const rest = close_cell(date.p, begin, line, cell);
  if (rest == nullptr) return nullptr;
  if (date.too_fine) return fail(CsvFaultKind::time_too_fine, begin, line, cell);
  std::int64_t total = date.seconds;
  bool fits = true;
  for (std::int64_t n = 0; n < date.decimals; ++n) fits = fits && !__builtin_mul_overflow(total, 10, &total);
  fits = fits && !__builtin_add_overflow(total, date.fraction, &total);
  if (!fits) return fail(CsvFaultKind::time_too_large, begin, line, cell);
  const Decimal time{static_cast<std::uint64_t>(std::abs(total)), -date.decimals, total < 0};
  return put_time(time, rest, begin, line, cell);
}

// The place behind the cell, `rest`, or nullptr.
const char* CsvReader::put_time(const Decimal& time, const char* rest, const char* begin, const char* line,
                                std::int32_t cell) {
  switch (times_.put(time)) {
    case CsvTimeFault::none:
      return rest;
    case CsvTimeFault::decreasing:
      return fail(CsvFaultKind::decreasing_time, begin, line, cell);
    case CsvTimeFault::too_large:
      return fail(CsvFaultKind::time_too_large, begin, line, cell);
    case CsvTimeFault::too_fine:
      return fail(CsvFaultKind::time_too_fine, begin, line, cell);
    case CsvTimeFault::merged:
      return fail(CsvFaultKind::time_merged, begin, line, cell);
  }
  return nullptr;
}

const char* CsvReader::read_text(CsvColumn& column, const char* begin, const char* line, std::int32_t cell) {
  const char* p = past_blanks(begin, separator_);
  std::string text;
  const char* rest = p;
  const bool quoted = *p == '"';
  if (quoted) {
    for (++rest; *rest != '"' || rest[1] == '"'; ++rest) {
      if (*rest == '\n') return fail(CsvFaultKind::open_quote, begin, line, cell);
      if (*rest == '"') ++rest;  // two quotes stand for one
      text.push_back(*rest);
    }
    rest = close_cell(rest + 1, begin, line, cell);
    if (rest == nullptr) return nullptr;
  } else {
    while (!ends_cell(*rest)) ++rest;
    const char* end = rest;
    while (end != p && is_blank(end[-1])) --end;
    text.assign(p, end);
  }
  held_ = text.empty() && !quoted;  // between quotation marks it is the empty text
  if (column.is_unread) {
    held_ = text.empty() || is_missing(text);
  } else if (!held_) {
    const auto [place, is_new] = column.places.try_emplace(text, static_cast<double>(column.labels.size()));
    if (is_new) column.labels.push_back(text);
    column.last = place->second;
    column.is_known = true;
  }
  column.numbers.push_back(column.last);
  return rest;
}

const char* CsvReader::read_value(CsvColumn& column, const char* begin, const char* line, std::int32_t cell) {
  // The common cases: a single 0 or 1 in a column of truth values, and a short decimal number.
  if (ends_cell(begin[1]) && static_cast<unsigned char>(*begin - '0') < 2 && !column.is_number) {
    column.truths.push_back(static_cast<std::uint8_t>(*begin - '0'));
    column.last = *begin - '0';
    column.is_known = true;
    return begin + 1;
  }
  if (is_digit(*begin) || *begin == '-') {
    Decimal number;
    const char* const rest = scan_decimal(begin, point_, number);
    double value = 0;
    if (rest != begin && ends_cell(*rest) && is_divided(number, value)) {
      if (column.is_number) {
        column.numbers.push_back(value);  // it has had a value, or it would be one of truth values yet
        column.last = value;
        return rest;
      }
      if (!column.has_words || value == 0 || value == 1) {
        put_number(column, value);
        return rest;
      }
    }
  }
  return read_slow_value(column, begin, line, cell);
}

const char* CsvReader::read_slow_value(CsvColumn& column, const char* begin, const char* line, std::int32_t cell) {
  const char* p = past_blanks(begin, separator_);
  const bool quoted = *p == '"';
  if (quoted) ++p;
  const char* rest = p;
  while (quoted ? *rest != '"' && *rest != '\n' : !ends_cell(*rest)) ++rest;
  const char* end = rest;
  if (quoted) {
    if (*rest != '"') return fail(CsvFaultKind::open_quote, begin, line, cell);
    ++rest;
  }
  while (end != p && is_blank(end[-1])) --end;
  rest = close_cell(rest, begin, line, cell);
  if (rest == nullptr) return nullptr;
  const std::string_view text(p, static_cast<std::size_t>(end - p));
  if (text.empty() || is_missing(text)) {
    hold(column);
    return rest;
  }
  const bool is_true = same_word(text, "true");
  if (is_true || same_word(text, "false")) {
    if (column.is_number) return fail(CsvFaultKind::mixed_column, begin, line, cell);
    column.has_words = true;
    column.truths.push_back(is_true ? 1 : 0);
    column.last = is_true ? 1 : 0;
    column.is_known = true;
    return rest;
  }
  double value = 0;
  std::string number(*p == '+' && end - p > 1 && p[1] != '-' ? p + 1 : p, end);
  if (point_ != '.') {
    if (number.find('.') != std::string::npos) return fail(CsvFaultKind::not_a_number, begin, line, cell);
    std::replace(number.begin(), number.end(), point_, '.');
  }
  const char* const last = number.data() + number.size();
  const auto [stopped, error] = read_number(number.data(), last, value);
  if (error == std::errc::invalid_argument || stopped != last)
    return fail(CsvFaultKind::not_a_number, begin, line, cell);
  if (error == std::errc::result_out_of_range) {
    // from_chars leaves open which of the two it was; strtod gives 0 or a subnormal number where it is tiny.
    value = std::strtod(number.c_str(), nullptr);
    if (!std::isfinite(value)) return fail(CsvFaultKind::not_finite, begin, line, cell);
  }
  if (std::isnan(value)) return fail(CsvFaultKind::not_finite, begin, line, cell);
  if (column.has_words && value != 0 && value != 1) return fail(CsvFaultKind::mixed_column, begin, line, cell);
  put_number(column, value);
  return rest;
}

void CsvReader::put_number(CsvColumn& column, double value) {
  column.last = value;
  column.is_known = true;
  if (!column.is_number) {
    if (value == 0 || value == 1) {
      column.truths.push_back(value == 1 ? 1 : 0);
      return;
    }
    column.numbers.reserve(column.truths.capacity());
    column.numbers.assign(column.truths.begin(), column.truths.end());
    column.truths = {};
    column.is_number = true;
  }
  column.numbers.push_back(value);
}

const char* CsvReader::skip_cell(const char* begin, const char* line, std::int32_t cell) {
  const char* p = past_blanks(begin, separator_);
  if (*p == '"') {
    for (++p; *p != '\n'; ++p) {
      if (*p != '"') continue;
      if (p[1] != '"') break;
      ++p;  // two quotes stand for one
    }
    if (*p == '\n') return fail(CsvFaultKind::open_quote, begin, line, cell);
    ++p;
  }
  while (!ends_cell(*p)) ++p;
  return p;
}

const char* CsvReader::fail(CsvFaultKind kind, const char* begin, const char* line, std::int32_t cell) {
  const char* end = line;
  while (*end != '\n') ++end;
  const char* start = begin;
  while (start < end && is_blank(*start) && *start != separator_) ++start;
  const char* stop = start;
  if (start < end && *start == '"') stop = std::find(start + 1, end, '"');
  while (stop < end && *stop != separator_) ++stop;
  while (stop > start && is_blank(stop[-1])) --stop;
  std::string text(line, end);
  if (!text.empty() && text.back() == '\r') text.pop_back();
  fault_ = CsvFault{
      kind, line_, static_cast<std::uint64_t>(start - line), static_cast<std::uint64_t>(stop - start), std::move(text),
      cell};
  return nullptr;
}

// After a fault within a row: every column ends with the row before it.
void CsvReader::forget_partial_row() {
  const std::size_t rows = row_;
  times_.resize(rows);
  for (CsvColumn& column : columns_) {
    if (column.is_number) {
      column.numbers.resize(rows);
    } else {
      column.truths.resize(rows);
    }
    if (column.has_arrivals) column.arrivals.resize(rows);
  }
}

}  // namespace tachk::csv
