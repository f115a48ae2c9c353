// tachk._core.PathOfRun; used through tachk.engine.exact.exact_run.
#include "runs.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "machine/machine.hpp"
#include "program/program.hpp"
#include "runs/ending.hpp"
#include "runs/judge.hpp"
#include "runs/path.hpp"
#include "runs/schedule.hpp"

namespace tachk::bind {

namespace nb = nanobind;

namespace {

using Column = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

struct PathOfRun {
  program::Program program;
  runs::RunPath path;

  PathOfRun(const std::vector<std::int64_t>& image, const std::vector<std::vector<std::uint32_t>>& actions)
      : program(program::decode_program(image)) {
    for (const auto& edges : actions) {
      for (const std::uint32_t edge : edges)
        if (edge >= program.edges.size()) throw std::invalid_argument("there is no such edge");
      path.edges.insert(path.edges.end(), edges.begin(), edges.end());
      path.ends.push_back(path.edges.size());
    }
  }

  const program::Goal& goal() const {
    if (program.goals.size() != 1) throw std::invalid_argument("a run goes to one goal");
    return program.goals.front();
  }

  std::optional<runs::RunEnd> end() const {
    const nb::gil_scoped_release released;
    try {
      return runs::end_of(program, path);
    } catch (const machine::ModelFault&) {
      return std::nullopt;
    }
  }

  std::optional<runs::Moments> earliest() const {
    const nb::gil_scoped_release released;
    try {
      return runs::earliest_moments(program, path, goal());
    } catch (const machine::ModelFault&) {
      return std::nullopt;
    }
  }

  std::optional<runs::StateOfRun> state(const runs::Moments& moments, std::size_t transitions) const {
    const nb::gil_scoped_release released;
    try {
      return runs::state_after(program, path, moments, transitions);
    } catch (const machine::ModelFault&) {
      return std::nullopt;
    }
  }

  std::optional<runs::RunObjection> objection(runs::Moments moments) const {
    const nb::gil_scoped_release released;
    try {
      return runs::objection_to(program, path, moments, goal());
    } catch (const machine::ModelFault&) {
      return runs::RunObjection{0, "a run-time error"};
    }
  }
};

}  // namespace

void bind_runs(nb::module_& m) {
  nb::class_<PathOfRun>(m, "PathOfRun",
                        "A path of a program to its goal, which becomes a run by the times it is given.")
      .def(nb::new_([](const std::vector<std::int64_t>& image, const std::vector<std::vector<std::uint32_t>>& actions) {
             return std::make_unique<PathOfRun>(image, actions);
           }),
           nb::arg("image"), nb::arg("actions"))
      .def(
          "end",
          [](const PathOfRun& self) -> nb::object {
            const auto found = self.end();
            return found ? nb::make_tuple(found->slots, found->bounds) : nb::object(nb::none());
          },
          "(slots, raw bounds of the clocks row by row) of the state in which the path ends, or None.")
      .def(
          "earliest",
          [](const PathOfRun& self) -> nb::object {
            const auto found = self.earliest();
            // A list: an array would load numpy, which takes longer than most runs.
            return found ? nb::make_tuple(found->unit, found->ticks) : nb::object(nb::none());
          },
          "(ticks in a unit of time, the earliest moments of all transitions and of the end), or None.")
      .def(
          "objection",
          [](const PathOfRun& self, std::int64_t unit, const Column& ticks) {
            const auto found = self.objection({unit, {ticks.data(), ticks.data() + ticks.shape(0)}});
            using Answer = std::tuple<std::size_t, std::string>;
            return found ? std::optional(Answer{found->step, found->reason}) : std::nullopt;
          },
          nb::arg("unit"), nb::arg("ticks"), "(number of the step, what is wrong with it), or None if all is right.")
      .def(
          "state",
          [](const PathOfRun& self, std::int64_t unit, const Column& ticks, std::size_t transitions) -> nb::object {
            const auto found = self.state({unit, {ticks.data(), ticks.data() + ticks.shape(0)}}, transitions);
            return found ? nb::make_tuple(found->slots, found->clocks) : nb::object(nb::none());
          },
          nb::arg("unit"), nb::arg("ticks"), nb::arg("transitions"),
          "(slots, ticks that each clock shows) right after so many transitions, or None.");
}

}  // namespace tachk::bind
