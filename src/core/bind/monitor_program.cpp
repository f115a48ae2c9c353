#include "monitor_program.hpp"

#include <nanobind/stl/vector.h>

#include <stdexcept>

namespace tachk::bind {

namespace nb = nanobind;

namespace {

std::vector<monitoring::ValueInstruction> read_code(nb::handle code) {
  std::vector<monitoring::ValueInstruction> result;
  for (nb::handle instruction : code) {
    monitoring::ValueInstruction read;
    read.operation = static_cast<monitoring::ValueOperator>(nb::cast<int>(instruction.attr("operator")));
    const double operand = nb::cast<double>(instruction.attr("operand"));
    if (read.operation == monitoring::ValueOperator::column) {
      read.column = static_cast<std::size_t>(operand);
    } else {
      read.number = operand;
    }
    result.push_back(read);
  }
  return result;
}

}  // namespace

monitoring::MonitorProgram monitor_program_from(nb::handle program) {
  monitoring::MonitorProgram result;
  result.columns = nb::len(nb::object(program.attr("columns")));
  for (nb::handle atom : program.attr("atoms"))
    result.atoms.push_back({static_cast<monitoring::Relation>(nb::cast<int>(atom.attr("relation"))),
                            read_code(atom.attr("left")), read_code(atom.attr("right"))});
  for (nb::handle node : program.attr("nodes")) {
    monitoring::MonitorNode read;
    read.kind = static_cast<monitoring::NodeKind>(nb::cast<int>(node.attr("kind")));
    read.operands = nb::cast<std::vector<std::size_t>>(node.attr("operands"));
    const int atom = nb::cast<int>(node.attr("atom"));
    read.atom = atom < 0 ? 0 : static_cast<std::size_t>(atom);
    read.lower = nb::cast<std::int64_t>(node.attr("lower"));
    read.upper = nb::cast<std::int64_t>(node.attr("upper"));
    read.lower_closed = nb::cast<bool>(node.attr("lower_closed"));
    read.upper_closed = nb::cast<bool>(node.attr("upper_closed"));
    result.nodes.push_back(std::move(read));
  }
  monitoring::validate(result);
  return result;
}

SampleView::SampleView(const std::int64_t* ticks, std::size_t count, const nb::sequence& columns) {
  using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  using Flags = nb::ndarray<const bool, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  for (nb::handle column : columns) {
    held_.push_back(nb::borrow(column));
    std::size_t length = 0;
    Numbers numbers;
    Bytes bytes;
    Flags flags;
    if (nb::try_cast(column, numbers, false)) {
      length = numbers.shape(0);
      columns_.push_back({numbers.data(), nullptr});
    } else if (nb::try_cast(column, bytes, false)) {
      length = bytes.shape(0);
      columns_.push_back({nullptr, bytes.data()});
    } else if (nb::try_cast(column, flags, false)) {
      length = flags.shape(0);
      columns_.push_back({nullptr, reinterpret_cast<const std::uint8_t*>(flags.data())});
    } else {
      throw std::invalid_argument("a column is a contiguous array of float64, uint8 or bool");
    }
    if (length != count) throw std::invalid_argument("every column has a value for every time");
  }
  samples_ = {ticks, columns_.data(), count};
}

}  // namespace tachk::bind
