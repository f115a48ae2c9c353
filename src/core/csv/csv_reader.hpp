// Recorded signals as comma-separated text: numbers and truth values, with one column of exact decimal times.
//
// Text arrives in pieces cut anywhere; whole lines are read as soon as they are there. The header is not this class's
// business: the caller has found the columns. A fault stops the reading, and the rows before it stay available.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace tachk {

enum class CsvFaultKind {
  not_a_number,
  not_finite,
  missing_time,
  missing_value,  // an empty cell in the first row; later ones hold the value before
  decreasing_time,
  too_few_cells,
  too_many_cells,
  time_too_large,  // it does not fit into 64 bits of ticks
  time_too_fine,   // it has more decimals than allowed
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
  std::uint32_t cells = 1;             // in each row
  std::uint32_t time = 0;              // the cell of the time
  std::vector<std::uint32_t> columns;  // the cells of the values that are kept; others may hold anything
  std::vector<std::uint32_t> texts;    // those of them that hold texts
  bool dates = false;                  // times are dates of ISO 8601, counted in seconds since 1970
  std::uint64_t first_line = 1;        // the number of the first line that is fed
  std::uint32_t decimals = 0;          // the times are counted in units of 10^-decimals at least
  std::uint32_t most_decimals = 18;    // a finer time is a fault
};

// Values are kept as truth values while nothing but 0, 1, true and false has been seen, else as numbers.
struct CsvColumn {
  std::vector<std::uint8_t> truths;
  std::vector<double> numbers;
  bool is_number = false;
  bool has_words = false;
  bool is_text = false;  // then the numbers are places in `labels`
  double last = 0;
  std::vector<std::string> labels;
  std::unordered_map<std::string, double> places;
};

class CsvReader {
 public:
  explicit CsvReader(CsvOptions options);

  // Reads every line that is complete with this piece. False after a fault.
  bool feed(std::string_view piece);
  // Reads the last line if it has no line break. False after a fault.
  bool finish();
  void reserve(std::size_t rows);

  const std::optional<CsvFault>& fault() const { return fault_; }
  std::uint32_t decimals() const { return decimals_; }
  std::size_t rows() const { return times_.size(); }

  // Hands over what was read since the last time; the numbering of lines and the values to hold go on.
  std::vector<std::int64_t> take_times();
  std::vector<CsvColumn> take_columns();

 private:
  static constexpr std::int32_t skip = -2;
  static constexpr std::int32_t is_time = -1;
  static constexpr std::size_t longest_line = std::size_t{1} << 24;

  const char* read_lines(const char* begin, const char* end);
  const char* read_line(const char* begin);
  const char* read_time(const char* begin, const char* line, std::int32_t cell);
  const char* read_date(const char* begin, const char* line, std::int32_t cell);
  const char* read_text(CsvColumn& column, const char* begin, const char* line, std::int32_t cell);
  const char* read_value(CsvColumn& column, const char* begin, const char* line, std::int32_t cell);
  const char* read_slow_value(CsvColumn& column, const char* begin, const char* line, std::int32_t cell);
  const char* skip_cell(const char* begin, const char* line, std::int32_t cell);
  const char* close_cell(const char* rest, const char* begin, const char* line, std::int32_t cell);
  bool put_time(std::uint64_t mantissa, std::int64_t decimals, bool negative, CsvFaultKind& problem);
  void put_number(CsvColumn& column, double value);
  bool ends_cell(char c) const { return c == separator_ || c == '\n'; }
  const char* fail(CsvFaultKind kind, const char* begin, const char* line, std::int32_t cell);
  void forget_partial_row();

  std::vector<std::int32_t> plan_;  // for each cell: skip, is_time, or the number of the column
  char separator_;
  bool dates_;
  std::uint32_t decimals_;
  std::uint32_t most_decimals_;
  std::uint64_t line_;
  bool any_row_ = false;
  std::int64_t last_time_ = 0;
  std::vector<std::int64_t> times_;
  std::vector<CsvColumn> columns_;
  std::string carried_;  // the beginning of a line whose end has not come yet
  std::optional<CsvFault> fault_;
};

}  // namespace tachk
