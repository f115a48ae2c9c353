#include "localtime.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "localtime/local_explorer.hpp"
#include "patiently.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using localtime::LocalExplorer;

namespace {

std::unique_ptr<LocalExplorer> make_explorer(const std::vector<std::int64_t>& image,
                                             const reachability::Options& options, const reachability::Limits& limits) {
  return std::make_unique<LocalExplorer>(program::decode_program(image), options, limits);
}

std::tuple<std::optional<std::string>, std::size_t> local_agents(const std::vector<std::int64_t>& image) {
  const localtime::Agents agents = localtime::find_agents(program::decode_program(image));
  if (agents.obstacle != nullptr) return {std::string(agents.obstacle), 0};
  return {std::nullopt, agents.count};
}

}  // namespace

void bind_localtime(nb::module_& m) {
  m.def("local_agents", &local_agents, nb::arg("image"),
        "(why local times are not sound for a program, or None; how many agents have one).");
  nb::class_<LocalExplorer>(m, "LocalExplorer")
      .def(nb::new_(&make_explorer), nb::arg("image"), nb::arg("options"), nb::arg("limits"))
      .def("run", &run_patiently<LocalExplorer>, nb::arg("expansions"), nb::arg("seconds") = nb::none(),
           nb::arg("poll") = nb::none(),
           "Explores up to this many states; TIME_LIMIT if it was given up in the midst of one.")
      .def(
          "statistics",
          [](const LocalExplorer& self) {
            const reachability::Statistics s = self.statistics();
            return std::make_tuple(s.explored, s.stored, s.transitions, s.bytes);
          },
          "(explored, stored, transitions, bytes)")
      .def("effort", &LocalExplorer::effort, "The work so far, in states of a small network that would take as long.")
      .def("discrete_states", &LocalExplorer::discrete_states, "How many discrete states have been seen.")
      .def("permutes", &LocalExplorer::permutes, "True if interchangeable processes are permuted.")
      .def("reached", &LocalExplorer::reached, nb::arg("goal"), "The node where a goal was reached first, or None.")
      .def("path_to_goal", &LocalExplorer::path_to_goal, nb::arg("goal"),
           "The edge numbers of each action of a run to a goal that has been reached, in the order of time.");
}

}  // namespace tachk::bind
