// tachk._core.UnitRun; used through tachk.xrce.bridge.part.
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <cstdint>
#include <memory>
#include <string>

#include "fmi/resource_file.hpp"
#include "fmi/unit_run.hpp"
#include "simulation.hpp"

namespace tachk::bind {

namespace nb = nanobind;

void bind_unit_run(nb::module_& m) {
  using fmi::UnitRun;
  nb::class_<UnitRun>(m, "UnitRun", "A run of a unit with its environment. Times are in ticks.")
      .def(nb::new_([](const std::string& path) {
             return std::make_unique<UnitRun>(std::make_shared<const fmi::ResourceFile>(path));
           }),
           nb::arg("path"))
      .def(
          "number",
          [](UnitRun& self, std::uint32_t place, int type) { return self.number(place, static_cast<fmi::Type>(type)); },
          nb::arg("place"), nb::arg("type"), "The value of a variable.")
      .def(
          "set_number",
          [](UnitRun& self, std::uint32_t place, int type, std::int64_t value) {
            self.set_number(place, static_cast<fmi::Type>(type), value);
          },
          nb::arg("place"), nb::arg("type"), nb::arg("value"), "Sets a parameter or an input.")
      .def("ticks", &UnitRun::ticks, nb::arg("place"), "True if the last transition used a channel.")
      .def("set_ticks", &UnitRun::set_ticks, nb::arg("place"), "The environment sends over a channel.")
      .def("begin", &UnitRun::begin, "Begins the run.")
      .def_prop_ro("now", &UnitRun::now)
      .def("next_event", &UnitRun::next_event, "The moment of the next event.")
      .def("wait_until", &UnitRun::wait_until, nb::arg("moment"), "Time passes, at most up to the next event.")
      .def("react", &UnitRun::react, "Lets happen what is due now. True if something did.")
      .def_prop_ro("over", [](const UnitRun& self) { return self.ending().has_value(); });
}

}  // namespace tachk::bind
