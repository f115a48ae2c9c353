// tachk._core.CsvReader: pieces of text in, arrays out without a copy.
#include "csv.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "csv/csv_reader.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using csv::CsvReader;

namespace {

// Kind, line, offset and length in bytes, number of the cell, the line itself (which need not be UTF-8).
using CsvFaultTuple = std::tuple<csv::CsvFaultKind, std::uint64_t, std::uint64_t, std::uint64_t, int, nb::bytes>;

std::unique_ptr<CsvReader> make_reader(char separator, char point, std::uint32_t cells, std::uint32_t time,
                                       const std::vector<std::uint32_t>& columns,
                                       const std::vector<std::uint32_t>& texts,
                                       const std::vector<std::uint32_t>& arrivals,
                                       const std::vector<std::uint32_t>& unread, bool dates, std::uint64_t first_line,
                                       std::uint32_t decimals, std::uint32_t most_decimals,
                                       std::uint32_t usual_decimals, bool binary, bool rounding, bool shortening) {
  return std::make_unique<CsvReader>(
      csv::CsvOptions{separator,
                      point,
                      cells,
                      time,
                      columns,
                      texts,
                      arrivals,
                      unread,
                      dates,
                      first_line,
                      {decimals, most_decimals, usual_decimals, binary, rounding, shortening}});
}

std::optional<CsvFaultTuple> csv_fault_of(const CsvReader& self) {
  const auto& fault = self.fault();
  if (!fault) return std::nullopt;
  return CsvFaultTuple{fault->kind,   fault->line, fault->offset,
                       fault->length, fault->cell, nb::bytes(fault->text.data(), fault->text.size())};
}

nb::list take_arrivals(CsvReader& self) {
  nb::list taken;
  for (auto& flags : self.take_arrivals()) taken.append(as_array(std::move(flags)));
  return taken;
}

nb::tuple take_rows(CsvReader& self) {
  nb::list columns;
  nb::list labels;
  for (csv::CsvColumn& column : self.take_columns()) {
    columns.append(column.is_number ? as_array(std::move(column.numbers)) : as_array(std::move(column.truths)));
    nb::list texts;
    for (const std::string& text : column.labels) texts.append(nb::bytes(text.data(), text.size()));
    labels.append(texts);
  }
  return nb::make_tuple(as_array(self.take_times()), columns, labels);
}

}  // namespace

void bind_csv(nb::module_& m) {
  using Kind = csv::CsvFaultKind;
  nb::enum_<Kind>(m, "CsvFaultKind")
      .value("NOT_A_NUMBER", Kind::not_a_number)
      .value("NOT_FINITE", Kind::not_finite)
      .value("MISSING_TIME", Kind::missing_time)
      .value("MISSING_VALUE", Kind::missing_value)
      .value("DECREASING_TIME", Kind::decreasing_time)
      .value("TOO_FEW_CELLS", Kind::too_few_cells)
      .value("TOO_MANY_CELLS", Kind::too_many_cells)
      .value("TIME_TOO_LARGE", Kind::time_too_large)
      .value("TIME_TOO_FINE", Kind::time_too_fine)
      .value("TIME_MERGED", Kind::time_merged)
      .value("OPEN_QUOTE", Kind::open_quote)
      .value("MIXED_COLUMN", Kind::mixed_column)
      .value("LINE_TOO_LONG", Kind::line_too_long);
  nb::class_<CsvReader>(m, "CsvReader")
      .def(nb::new_(&make_reader), nb::kw_only(), nb::arg("separator"), nb::arg("point"), nb::arg("cells"),
           nb::arg("time"), nb::arg("columns"), nb::arg("texts"), nb::arg("arrivals"), nb::arg("unread"),
           nb::arg("dates"), nb::arg("first_line"), nb::arg("decimals"), nb::arg("most_decimals"),
           nb::arg("usual_decimals"), nb::arg("binary"), nb::arg("rounding"), nb::arg("shortening"))
      .def(
          "feed",
          [](CsvReader& self, const nb::bytes& piece) {
            const std::string_view text(piece.c_str(), piece.size());
            nb::gil_scoped_release released;
            return self.feed(text);
          },
          nb::arg("piece"), "Reads the lines that are complete with this piece; False after a fault.")
      .def("finish", &CsvReader::finish, nb::arg("whole") = true,
           "Reads the last line, or forgets it if the file is not there to its end; False after a fault.")
      .def("is_cut_off", &CsvReader::is_cut_off, "The fault is in a last line without a line break.")
      .def("reserve", &CsvReader::reserve, nb::arg("rows"), "Makes room for this many rows.")
      .def(
          "rows", [](const CsvReader& self) { return self.times().size(); }, "How many rows wait to be taken.")
      .def("left_out", &CsvReader::left_out, "How many rows come before every column has a value.")
      .def("any_row", &CsvReader::any_row, "True if a row has been read.")
      .def(
          "decimals", [](const CsvReader& self) { return self.times().decimals(); },
          "Times are counted in units of 10 to the minus this.")
      .def(
          "rounded", [](const CsvReader& self) { return self.times().rounded(); }, "True if some time was rounded.")
      .def(
          "shortened", [](const CsvReader& self) { return self.times().shortened(); },
          "True if some time was read as the shorter decimal number of a double.")
      .def(
          "unprinted", [](const CsvReader& self) { return self.times().unprinted(); },
          "True if some time has as many digits, and is not what a double prints as.")
      .def("take_arrivals", &take_arrivals, "Of the columns that tell it, whether each row had a value; before `take`.")
      .def("take", &take_rows,
           "The rows read since the last time: (times, columns, for each the texts that its numbers stand for).")
      .def("fault", &csv_fault_of, "(kind, line, offset, length, cell, line text), or None.");
}

}  // namespace tachk::bind
