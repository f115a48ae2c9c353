// Recorded signals as comma-separated text: numbers and truth values, with one column of exact decimal times.
//
// Text arrives in pieces cut anywhere; whole lines are read as soon as they are there. The header is not this class's
// business: the caller has found the columns. A fault ends it, and the rows before it stay available. The
// rows begin when every column has a value; from then on an empty cell holds the one before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "csv/csv_times.hpp"

namespace tachk::csv {

enum class CsvFaultKind {
  not_a_number,
  not_finite,
  missing_time,
  missing_value,  // a column that never has a value
  decreasing_time,
  too_few_cells,
  too_many_cells,
  time_too_large,  // it does not fit into 64 bits of ticks
  time_too_fine,   // it has more decimals than allowed
  time_merged,     // rounded, it is the same as that of the row above, which is another one
  open_quote,
  mixed_column,  // truth values as words, and numbers other than 0 and 1
  line_too_long,
};

struct CsvFault {
  CsvFaultKind kind;
  std::uint64_t line;    // from 1
  std::uint64_t offset;  // of the cell in the line, in bytes
  std::uint64_t length;  // of the cell
  std::string text;      // the line
  std::int32_t cell;     // its number in the row, from 0
};

struct CsvOptions {
  char separator = ',';
  char point = '.';                     // or a comma, before the decimals of numbers
  std::uint32_t cells = 1;              // in each row
  std::uint32_t time = 0;               // the cell of the time
  std::vector<std::uint32_t> columns;   // the cells of the values that are kept; others may hold anything
  std::vector<std::uint32_t> texts;     // those of them that hold texts
  std::vector<std::uint32_t> arrivals;  // those columns for which the reader records the rows that have a value
  std::vector<std::uint32_t> unread;    // those of these that may hold anything: their values do not matter
  bool dates = false;                   // times are dates of ISO 8601, counted in seconds since 1970
  std::uint64_t first_line = 1;         // the number of the first line that is fed
  CsvTimeOptions times;
};

// Values are kept as truth values while nothing but 0, 1, true and false has been seen, else as numbers.
struct CsvColumn {
  std::vector<std::uint8_t> truths;
  std::vector<double> numbers;
  bool is_number = false;
  bool has_words = false;
  bool is_text = false;   // then the numbers are places in `labels`
  bool is_known = false;  // it has had a value
  bool has_arrivals = false;
  bool is_unread = false;
  double last = 0;
  std::vector<std::uint8_t> arrivals;  // whether the cell of the row had a value
  std::vector<std::string> labels;
  std::unordered_map<std::string, double> places;
};

class CsvReader {
 public:
  explicit CsvReader(CsvOptions options);

  // Reads every line that is complete with this piece. False after a fault.
  bool feed(std::string_view piece);
  // Reads the last line if it has no line break, or forgets it where the file is not there to its end. False after a
  // fault.
  bool finish(bool whole = true);
  // The last line has a fault and no line break: the file may have been cut off there.
  bool is_cut_off() const { return cut_off_; }
  void reserve(std::size_t rows);

  const std::optional<CsvFault>& fault() const { return fault_; }
  const CsvTimes& times() const { return times_; }
  // True if a row has been read.
  bool any_row() const { return any_row_; }
  // How many rows there are before every column has a value.
  std::size_t left_out() const { return left_out_; }

  // Hands over what was read since the last time; the numbering of lines and the values to hold go on.
  std::vector<std::int64_t> take_times() { return times_.take(); }
  std::vector<CsvColumn> take_columns();
  // Of the columns with arrivals, in the order of the columns; before the columns are taken.
  std::vector<std::vector<std::uint8_t>> take_arrivals();

 private:
  static constexpr std::int32_t skip = -2;
  static constexpr std::int32_t is_time = -1;
  static constexpr std::size_t longest_line = std::size_t{1} << 24;

  const char* read_lines(const char* begin, const char* end);
  const char* read_line(const char* begin);
  const char* read_time(const char* begin, const char* line, std::int32_t cell);
  const char* read_date(const char* begin, const char* line, std::int32_t cell);
  const char* read_rare(CsvColumn& column, const char* begin, const char* line, std::int32_t cell);
  const char* read_text(CsvColumn& column, const char* begin, const char* line, std::int32_t cell);
  const char* read_value(CsvColumn& column, const char* begin, const char* line, std::int32_t cell);
  const char* read_slow_value(CsvColumn& column, const char* begin, const char* line, std::int32_t cell);
  const char* skip_cell(const char* begin, const char* line, std::int32_t cell);
  const char* close_cell(const char* rest, const char* begin, const char* line, std::int32_t cell);
  const char* put_time(const Decimal& time, const char* rest, const char* begin, const char* line, std::int32_t cell);
  void put_number(CsvColumn& column, double value);
  bool hold(CsvColumn& column);
  void begin_later();
  bool ends_cell(char c) const { return c == separator_ || c == '\n'; }
  const char* fail(CsvFaultKind kind, const char* begin, const char* line, std::int32_t cell);
  void forget_partial_row();

  std::vector<std::int32_t> plan_;  // for each cell: skip, is_time, or the number of the column
  char separator_;
  char point_;
  bool dates_;
  std::uint64_t line_;
  std::size_t row_ = 0;  // the number of the row that is being read, among those that wait to be taken
  bool any_row_ = false;
  std::size_t left_out_ = 0;
  bool complete_ = false;  // every column has a value
  bool held_ = false;      // the last cell had no value
  bool cut_off_ = false;
  CsvTimes times_;
  std::vector<CsvColumn> columns_;
  std::string pending_;  // the beginning of a line whose end has not come yet
  std::optional<CsvFault> fault_;
};

}  // namespace tachk::csv
