// The reader of JSON lines: values, times, texts, what it gives up on; whatever the pieces.
#include "json_lines/json_reader.hpp"

#include <string>
#include <string_view>
#include <vector>

#include "check.hpp"

namespace {

using namespace tachk::json_lines;

constexpr std::string_view lines =
    "{\"time\": 0.25, \"on\": true, \"pose\": {\"x\": [1, -2.5e1]}}\r\n"
    "\n"
    "{\"mode\": \"a\\u00e9\\ud83d\\ude00\", \"time\": 1, \"on\": null}";

void check_lines(JsonReader& reader) {
  CHECK(reader.finish());
  CHECK(reader.times().decimals() == 2);
  CHECK((reader.take_times() == std::vector<std::int64_t>{25, 100}));
  const std::vector<JsonColumn> columns = reader.take_columns();
  CHECK(columns.size() == 4);
  CHECK(columns[0].name == "on" && columns[0].kind == JsonKind::truth && columns[0].rows.size() == 1);
  CHECK(columns[1].name == "pose.x[0]" && columns[2].name == "pose.x[1]");
  CHECK((columns[2].values == std::vector<double>{-25}));
  CHECK(columns[3].kind == JsonKind::text && columns[3].labels[0] == "a\u00e9\U0001F600");
  CHECK((columns[3].rows == std::vector<std::int64_t>{1}));
}

void reads_lines() {
  JsonReader reader("time", false);
  CHECK(reader.feed(lines));
  check_lines(reader);
}

void reads_pieces() {
  for (std::size_t size = 1; size < 9; ++size) {
    JsonReader reader("time", false);
    for (std::size_t place = 0; place < lines.size(); place += size) CHECK(reader.feed(lines.substr(place, size)));
    check_lines(reader);
  }
}

void reads_dates() {
  JsonReader reader("t", true);
  CHECK(reader.feed("{\"t\": \"1970-01-01T00:00:02.5Z\"}\n"));
  CHECK(reader.finish());
  CHECK((reader.take_times() == std::vector<std::int64_t>{25}));
}

void gives_up() {
  for (const std::string_view line :
       {"{", "}", "[]", "{\"t\": 1", "{\"t\": 01}", "{\"t\": 1.}", "{\"t\": 1, \"t\": 2}",
        "{\"t\": 1, \"a\": 1, \"a\": 1}", "{\"a\": 1}", "{\"t\": 1, \"a\": \"\\ud800\"}", "{\"t\": 1, \"a\": 1e999}",
        "{\"t\": 1} x", "{\"t\": 1, }", "{\"t\": 1, \"\": 2}", "{\"t\": 0.30000000000000004}",
        "{\"t\": 1, \"a\": [1, true], \"a[0]\": 1}", "{\"t\": 1, \"a\": \"\t\"}"}) {
    JsonReader reader("t", false);
    CHECK(!(reader.feed(line) && reader.finish()));
    CHECK(!reader.finish());
    CHECK(reader.take_columns().empty());
  }
  JsonReader backwards("t", false);
  CHECK(!backwards.feed("{\"t\": 1}\n{\"t\": 0}\n"));
  JsonReader mixed("t", false);
  CHECK(!mixed.feed("{\"t\": 1, \"a\": 1}\n{\"t\": 1, \"a\": true}\n"));
}

}  // namespace

int main() {
  reads_lines();
  reads_pieces();
  reads_dates();
  gives_up();
}
