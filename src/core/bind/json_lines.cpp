// tachk._core.JsonReader: pieces of text in, the values of each column out as arrays.
#include "json_lines.hpp"

#include <nanobind/ndarray.h>

#include <string>
#include <string_view>
#include <utility>

#include "arrays.hpp"
#include "json_lines/json_reader.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using json_lines::JsonColumn;
using json_lines::JsonReader;

namespace {

nb::bytes bytes_of(const std::string& text) { return nb::bytes(text.data(), text.size()); }

nb::tuple take_table(JsonReader& self) {
  nb::list columns;
  for (JsonColumn& column : self.take_columns()) {
    nb::list labels;
    for (const std::string& text : column.labels) labels.append(bytes_of(text));
    columns.append(nb::make_tuple(bytes_of(column.name), column.kind, as_array(std::move(column.rows)),
                                  as_array(std::move(column.values)), labels));
  }
  const std::uint32_t decimals = self.times().decimals();
  return nb::make_tuple(as_array(self.take_times()), decimals, columns);
}

}  // namespace

void bind_json_lines(nb::module_& m) {
  using Kind = json_lines::JsonKind;
  nb::enum_<Kind>(m, "JsonKind")
      .value("NONE", Kind::none)
      .value("NUMBER", Kind::number)
      .value("TRUTH", Kind::truth)
      .value("TEXT", Kind::text);
  nb::class_<JsonReader>(m, "JsonReader")
      .def(
          "__init__",
          [](JsonReader* self, const nb::bytes& time, bool dates) {
            new (self) JsonReader(std::string(time.c_str(), time.size()), dates);
          },
          nb::arg("time"), nb::arg("dates"))
      .def(
          "feed",
          [](JsonReader& self, const nb::bytes& piece) {
            const std::string_view text(piece.c_str(), piece.size());
            nb::gil_scoped_release released;
            return self.feed(text);
          },
          nb::arg("piece"), "Reads the lines that are complete with this piece; False: it gives up.")
      .def("finish", &JsonReader::finish, "Reads the last line; False: it gives up.")
      .def("take", &take_table,
           "(times, how many decimals they are counted in, for each column name, kind, rows, values and the texts that "
           "these stand for).");
}

}  // namespace tachk::bind
