// tachk._core.split; used through tachk.engine.simulation.splitting.
#include "simulation/splitting.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "interruption.hpp"
#include "program/program.hpp"
#include "reachability/distances.hpp"
#include "simulation.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using reachability::Distances;

void bind_splitting(nb::module_& m) {
  nb::class_<Distances>(m, "Levels", "How far discrete states are from the first goal of a program.")
      .def(
          "__init__",
          [](Distances* self, const std::vector<std::int64_t>& image, std::size_t zones) {
            program::Program program = program::decode_program(image);
            const nb::gil_scoped_release released;
            new (self) Distances(reachability::distances(std::move(program), zones));
          },
          nb::arg("image"), nb::arg("zones"))
      .def_prop_ro("top", [](const Distances& self) { return self.levels.top(); })
      .def_ro("states", &Distances::states)
      .def_ro("whole", &Distances::whole)
      .def_ro("reached", &Distances::reached);
  m.def(
      "split",
      [](const simulation::Simulation& simulation, const Distances& levels, const simulation::RunQuestion& question,
         std::uint64_t seed, std::uint64_t first, std::uint64_t replications, std::uint64_t effort, unsigned threads,
         std::uint64_t most_steps, const nb::callable& check) {
        simulation::SplittingRequest request{seed, first, replications, effort, threads, most_steps, {}};
        std::vector<std::tuple<double, std::uint64_t, std::uint64_t>> result;
        interruptibly(request, check, [&] {
          for (const simulation::Replication& each : simulation::split(simulation, levels.levels, question, request))
            result.emplace_back(each.probability, each.transitions, each.unknown);
        });
        return result;
      },
      nb::arg("simulation"), nb::arg("levels"), nb::arg("question"), nb::kw_only(), nb::arg("seed"), nb::arg("first"),
      nb::arg("replications"), nb::arg("effort"), nb::arg("threads"), nb::arg("most_steps"), nb::arg("check"),
      "(estimate, transitions, unknown runs) of these replications. Raises what `check` raises.");
}

}  // namespace tachk::bind
