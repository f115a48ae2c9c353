#include "estimation.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "estimation/state_estimate.hpp"
#include "patiently.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using estimation::Raw;
using estimation::StateEstimate;

namespace {

// (number of the channel, stream, whether it is an input, columns: (slot or None, constant))
using ChannelTuple =
    std::tuple<std::int32_t, std::uint32_t, bool, std::vector<std::pair<std::optional<std::uint32_t>, std::int32_t>>>;
using WindowTuple = std::pair<Raw, Raw>;
using EventTuple = std::tuple<std::size_t, std::vector<std::int32_t>, std::vector<WindowTuple>, std::vector<Raw>>;

WindowTuple pair_of(const estimation::Window& window) { return {window.low, window.high}; }

std::unique_ptr<StateEstimate> make_estimate(const std::vector<std::int64_t>& image,
                                             const reachability::Options& options, const reachability::Limits& limits,
                                             const std::vector<ChannelTuple>& channels, std::size_t streams,
                                             const std::vector<std::optional<std::uint32_t>>& marks) {
  std::vector<estimation::VisibleChannel> visible;
  for (const auto& [channel, stream, input, columns] : channels) {
    visible.push_back({channel, stream, input, {}});
    for (const auto& [slot, value] : columns) visible.back().columns.push_back({slot, value});
  }
  return std::make_unique<StateEstimate>(program::decode_program(image), options, limits, std::move(visible), streams,
                                         marks);
}

}  // namespace

void bind_estimation(nb::module_& m) {
  nb::class_<StateEstimate>(m, "StateEstimate")
      .def(nb::new_(&make_estimate), nb::arg("image"), nb::arg("options"), nb::arg("limits"), nb::arg("channels"),
           nb::arg("streams"), nb::arg("marks"))
      .def(
          "observe",
          [](StateEstimate& self, std::size_t stream, std::vector<std::optional<std::int32_t>> values, Raw earliest,
             Raw latest, bool optional) { self.observe(stream, {std::move(values), earliest, latest, optional}); },
          nb::arg("stream"), nb::arg("values"), nb::arg("earliest"), nb::arg("latest"), nb::arg("optional") = false,
          "Adds an event behind those of its stream.")
      .def("advance", &StateEstimate::advance, nb::arg("until"), "Begins an exploration up to a moment.")
      .def("predict", &StateEstimate::predict, nb::arg("until"),
           "Begins an exploration of what may happen first if nothing else is seen.")
      .def("conclude", &StateEstimate::conclude,
           "Begins an exploration of whether all observations can happen, however the system goes on unseen.")
      .def("watch", &StateEstimate::watch, nb::arg("edges"), "From now on `passed` is about these edges.")
      .def("passed", &StateEstimate::passed, "Whether one of them was possible on the way to the present moment.")
      .def("seek", &StateEstimate::seek, nb::arg("until"), nb::arg("edges"), nb::arg("states"),
           "Begins an exploration for runs that take one of these edges.")
      .def("run", &run_patiently<StateEstimate>, nb::arg("expansions"), nb::arg("seconds") = nb::none(),
           nb::arg("poll") = nb::none(), "Explores up to this many states.")
      .def("size", &StateEstimate::size, "How many symbolic states are possible at the present moment.")
      .def("explored", &StateEstimate::explored, "How many states were explored in all.")
      .def("covered", &StateEstimate::covered, "The marks of the edges that were taken for sure.")
      .def(
          "prediction",
          [](const StateEstimate& self) {
            const estimation::Prediction& prediction = self.prediction();
            std::vector<EventTuple> events;
            for (const estimation::PossibleEvent& event : prediction.events) {
              std::vector<WindowTuple> windows;
              for (const estimation::Window& window : event.windows) windows.push_back(pair_of(window));
              events.push_back({event.channel, event.values, std::move(windows), event.boundaries});
            }
            std::vector<std::pair<std::size_t, WindowTuple>> blocked;
            for (const estimation::Blocking& blocking : prediction.blocked)
              blocked.push_back({blocking.channel, pair_of(blocking.window)});
            return std::make_tuple(events, blocked, prediction.silent_until);
          },
          "(events: (place of the channel, values, windows, where single ones begin or end), blocked: (place of the "
          "channel, window), how long "
          "silence may last)")
      .def(
          "lead",
          [](const StateEstimate& self) {
            std::optional<std::tuple<std::size_t, std::vector<std::int32_t>, WindowTuple>> lead;
            if (self.lead()) lead = {self.lead()->channel, self.lead()->values, pair_of(self.lead()->window)};
            return std::make_pair(self.found(), lead);
          },
          "(whether all observations can happen, or an edge was found; the first event of that run)");
}

}  // namespace tachk::bind
