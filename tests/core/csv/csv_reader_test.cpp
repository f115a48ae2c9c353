// The reader of recorded signals: values, exact times, held cells, faults; whatever the pieces.
#include "csv/csv_reader.hpp"

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "check.hpp"

namespace {

using namespace tachk::csv;

CsvOptions two_columns() {
  CsvOptions options;
  options.cells = 3;
  options.columns = {1, 2};
  return options;
}

void reads_rows() {
  CsvReader reader(two_columns());
  CHECK(reader.feed("0,1,2.5\r\n# note\n\n0.25,true,\n1.5,0,-1e2"));
  CHECK(reader.finish());
  CHECK(reader.times().decimals() == 2);
  CHECK((reader.take_times() == std::vector<std::int64_t>{0, 25, 150}));
  const std::vector<CsvColumn> columns = reader.take_columns();
  CHECK((columns[0].truths == std::vector<std::uint8_t>{1, 1, 0}) && !columns[0].is_number);
  CHECK((columns[1].numbers == std::vector<double>{2.5, 2.5, -100}) && columns[1].is_number);
  CHECK(reader.times().size() == 0);
}

void pieces_do_not_matter() {
  const std::string text = "0,1,7\n1,0,\n2.125,1,0.1\n\n# x\n3,\"true\", 12345678901234567890 \n4,x,1\n5,1,1\n";
  CsvReader whole(two_columns());
  whole.feed(text);
  whole.finish();
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    for (std::size_t second = cut; second <= text.size(); second += 5) {
      CsvReader reader(two_columns());
      reader.feed(std::string_view(text).substr(0, cut));
      reader.feed(std::string_view(text).substr(cut, second - cut));
      reader.feed(std::string_view(text).substr(second));
      reader.finish();
      CsvReader again(two_columns());
      again.feed(text);
      CHECK(reader.take_times() == again.take_times());
      CHECK(reader.take_columns()[1].numbers == again.take_columns()[1].numbers);
      CHECK(reader.fault().has_value() && reader.fault()->line == 7 && reader.fault()->offset == 2);
      CHECK(reader.fault()->kind == CsvFaultKind::not_a_number && reader.fault()->text == "4,x,1");
    }
  }
}

void a_fault_keeps_the_rows_before() {
  CsvReader reader(two_columns());
  CHECK(!reader.feed("0,1,7\n1,0,8\n2,1,x\n3,1,1\n"));
  CHECK(!reader.feed("4,1,1\n"));
  CHECK((reader.take_times() == std::vector<std::int64_t>{0, 1}));
  const std::vector<CsvColumn> columns = reader.take_columns();
  CHECK(columns[0].truths.size() == 2 && columns[1].numbers.size() == 2);
}

void taking_goes_on() {
  CsvReader reader(two_columns());
  reader.feed("0,1,7\n");
  reader.take_times();
  reader.take_columns();
  CHECK(reader.feed("1,,\n"));
  CHECK(reader.take_columns()[1].numbers == std::vector<double>{7});
  CHECK(!reader.feed("0.5,1,1\n"));
  CHECK(reader.fault()->kind == CsvFaultKind::decreasing_time && reader.fault()->line == 3);
}

void fixed_decimals() {
  CsvOptions options = two_columns();
  options.times.decimals = options.times.most_decimals = 3;
  CsvReader reader(options);
  CHECK(reader.feed("0.5,1,1\n"));
  CHECK(reader.take_times() == std::vector<std::int64_t>{500});
  CHECK(!reader.feed("0.5001,1,1\n"));
  CHECK(reader.fault()->kind == CsvFaultKind::time_too_fine);
}

void reads_dates_and_texts() {
  CsvOptions options = two_columns();
  options.texts = {2};
  options.dates = true;
  CsvReader reader(options);
  CHECK(reader.feed("1970-01-01,1,\"a \"\"b\"\"\"\n1970-01-02T01:00:00.250+01:00,0,\n"));
  CHECK((reader.take_times() == std::vector<std::int64_t>{0, 8640025}));
  const std::vector<CsvColumn> first = reader.take_columns();
  CHECK((first[1].labels == std::vector<std::string>{"a \"b\""}) && first[0].labels.empty());
  CHECK(reader.feed("2000-02-29 00:00Z,0,\n2000-03-01,0,c\n"));
  CHECK((reader.take_times() == std::vector<std::int64_t>{95178240000, 95186880000}));
  const std::vector<CsvColumn> second = reader.take_columns();
  CHECK((second[1].numbers == std::vector<double>{0, 1}));
  CHECK((second[1].labels == std::vector<std::string>{"a \"b\"", "c"}));
  CHECK(!reader.feed("2001-02-29,0,c\n") && reader.fault()->kind == CsvFaultKind::not_a_number);
}

void bad_options_are_rejected() {
  for (const int wrong : {0, 1, 2}) {
    CsvOptions options = two_columns();
    if (wrong == 0) options.time = 3;
    if (wrong == 1) options.columns = {0};
    if (wrong == 2) options.times.most_decimals = 19;
    bool rejected = false;
    try {
      CsvReader reader(options);
    } catch (const std::invalid_argument&) {
      rejected = true;
    }
    CHECK(rejected);
  }
}

}  // namespace

int main() {
  reads_rows();
  pieces_do_not_matter();
  a_fault_keeps_the_rows_before();
  taking_goes_on();
  fixed_decimals();
  reads_dates_and_texts();
  bad_options_are_rejected();
}
