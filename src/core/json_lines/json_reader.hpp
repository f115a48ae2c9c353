// Recorded signals as JSON lines: an object a line, with a time and the values that change then.
//
// What is unusual is not read here but by the general reader, in Python, which also says what is wrong: this one reads
// a file whole, and then as that one does, or gives up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "csv/csv_times.hpp"

namespace tachk::json_lines {

enum class JsonKind {
  none,  // no value so far
  number,
  truth,
  text,
};

// The values that a column is given, and the rows that give them.
struct JsonColumn {
  std::string name;  // behind dots and in brackets, as in pose.x and v[0]
  JsonKind kind = JsonKind::none;
  std::vector<std::int64_t> rows;
  std::vector<double> values;  // of texts the places in `labels`
  std::vector<std::string> labels;
  std::unordered_map<std::string, double> places = {};
  std::int64_t last = -1;  // the last row that names it
};

class JsonReader {
 public:
  // `dates`: times are dates of ISO 8601, counted in seconds since 1970, and not numbers.
  JsonReader(std::string time, bool dates);

  // Reads the lines that are complete with this piece. False: it has given up, and has forgotten what it read.
  bool feed(std::string_view piece);
  // Reads the last line. False: as above.
  bool finish();

  const csv::CsvTimes& times() const { return times_; }
  std::vector<std::int64_t> take_times() { return times_.take(); }
  std::vector<JsonColumn> take_columns();

 private:
  bool read_lines(const char* begin, const char* end);
  bool read_line(const char* p);
  const char* read_object(const char* p, int depth);
  const char* read_array(const char* p, int depth);
  const char* read_value(const char* p, int depth);
  const char* read_text(const char* p, std::string& text);
  const char* read_escape(const char* p, std::string& text);
  const char* read_plain(const char* p);
  const char* read_number_value(const char* p);
  const char* read_time(const char* p);
  const char* read_date(const char* p);
  JsonColumn* named();
  bool put(JsonKind kind, double value);
  bool give_up();

  std::string time_;
  bool dates_ = false;
  bool gave_up_ = false;
  bool timed_ = false;  // this line has had its time
  std::int64_t row_ = 0;
  std::string path_;  // of the value that is read
  std::string text_;
  std::string pending_;  // the beginning of a line
  csv::CsvTimes times_;
  std::vector<JsonColumn> columns_;
  std::unordered_map<std::string, std::size_t> numbers_;
};

}  // namespace tachk::json_lines
