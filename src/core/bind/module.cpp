// tachk._core: the exploration engine as one class. The border is crossed once to build, once for each slice of the
// search (without the interpreter lock), and once to read results.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <string>
#include <tuple>

#include "csv.hpp"
#include "group.hpp"
#include "linear.hpp"
#include "offline.hpp"
#include "online.hpp"
#include "reachability/explorer.hpp"

namespace nb = nanobind;

namespace {

using FaultTuple = std::tuple<int, int, std::vector<std::vector<std::uint32_t>>, std::vector<std::uint32_t>>;

std::unique_ptr<tachk::Explorer> make_explorer(const std::vector<std::int64_t>& image, int order, std::uint32_t seed,
                                               int extrapolation, bool local_bounds, bool subsumption, int least_width,
                                               bool scale, bool vector, bool reclaim, std::uint32_t pack_clocks,
                                               std::uint32_t passing, bool shortest, std::uint32_t chunk_words,
                                               std::uint64_t state_limit, std::uint64_t memory_limit,
                                               std::uint32_t depth_limit) {
  tachk::Options options;
  options.order = static_cast<tachk::SearchOrder>(order);
  options.seed = seed;
  options.extrapolation = static_cast<tachk::Extrapolation>(extrapolation);
  options.local_bounds = local_bounds;
  options.subsumption = subsumption;
  options.least_width = static_cast<tachk::Width>(least_width);
  options.scale = scale;
  options.vector = vector;
  options.reclaim = reclaim;
  options.pack_clocks = pack_clocks;
  options.passing = passing;
  options.shortest = shortest;
  options.chunk_words = chunk_words;
  options.state_limit = state_limit;
  options.memory_limit = memory_limit;
  options.depth_limit = depth_limit;
  return std::make_unique<tachk::Explorer>(tachk::decode_program(image), options);
}

std::optional<FaultTuple> fault_of(tachk::Explorer& explorer) {
  const auto& fault = explorer.fault();
  if (!fault) return std::nullopt;
  std::vector<std::vector<std::uint32_t>> path;
  if (fault->node != tachk::no_node) path = explorer.path(fault->node);
  path.insert(path.end(), fault->passed.begin(), fault->passed.end());
  return FaultTuple{static_cast<int>(fault->kind), fault->position, std::move(path), fault->edges};
}

}  // namespace

NB_MODULE(_core, m) {
  m.doc() = "The C++ core: the exploration engine, the monitors and the reader of tables.";

  nb::class_<tachk::Explorer>(m, "Explorer")
      .def(nb::new_(&make_explorer), nb::arg("image"), nb::kw_only(), nb::arg("order"), nb::arg("seed"),
           nb::arg("extrapolation"), nb::arg("local_bounds"), nb::arg("subsumption"), nb::arg("least_width"),
           nb::arg("scale"), nb::arg("vector"), nb::arg("reclaim"), nb::arg("pack_clocks"), nb::arg("passing"),
           nb::arg("shortest"), nb::arg("chunk_words"), nb::arg("state_limit"), nb::arg("memory_limit"),
           nb::arg("depth_limit"))
      .def(
          "run", [](tachk::Explorer& self, std::uint64_t expansions) { return static_cast<int>(self.run(expansions)); },
          nb::arg("expansions"), nb::call_guard<nb::gil_scoped_release>(), "Explores up to this many states.")
      .def(
          "statistics",
          [](const tachk::Explorer& self) {
            const tachk::Statistics s = self.statistics();
            return std::make_tuple(s.explored, s.stored, s.transitions, s.bytes);
          },
          "(explored, stored, transitions, bytes)")
      .def("reached", &tachk::Explorer::reached, nb::arg("goal"), "The node where a goal was reached first, or None.")
      .def("path", &tachk::Explorer::path, nb::arg("node"), "The edge numbers of each action on the way to a node.")
      .def("leads_to", &tachk::Explorer::leads_to, nb::arg("actions"), nb::arg("goal"),
           "Whether these actions, as edge numbers, can end in a goal; for a fresh explorer without extrapolation.")
      .def("fault", &fault_of, "(kind, code position, path, edges of the action) of a run-time error, or None.")
      .def(
          "kernel", [](const tachk::Explorer& self) { return std::string(self.operations().name); },
          "Which implementation of the zone operations is in use.");

  bind_csv(m);
  bind_offline(m);
  bind_linear(m);
  bind_online(m);
  bind_group(m);
}
