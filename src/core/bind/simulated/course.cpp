// tachk._core.Course; used through tachk.simulation.fmi.course.
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <cstdint>
#include <memory>
#include <string>

#include "fmi/blueprint.hpp"
#include "fmi/course.hpp"
#include "simulation.hpp"

namespace tachk::bind {

namespace nb = nanobind;

void bind_course(nb::module_& m) {
  using fmi::Course;
  nb::class_<Course>(m, "Course", "A run of a unit under way, which its surroundings take part in. Times are in ticks.")
      .def(nb::new_([](const std::string& path) {
             return std::make_unique<Course>(std::make_shared<const fmi::Blueprint>(path));
           }),
           nb::arg("path"))
      .def(
          "number",
          [](Course& self, std::uint32_t place, int type) { return self.number(place, static_cast<fmi::Type>(type)); },
          nb::arg("place"), nb::arg("type"), "The value of a variable.")
      .def(
          "set_number",
          [](Course& self, std::uint32_t place, int type, std::int64_t value) {
            self.set_number(place, static_cast<fmi::Type>(type), value);
          },
          nb::arg("place"), nb::arg("type"), nb::arg("value"), "Sets a parameter or an input.")
      .def("ticks", &Course::ticks, nb::arg("place"), "Whether the last transition used a channel.")
      .def("set_ticks", &Course::set_ticks, nb::arg("place"), "The surroundings send over a channel.")
      .def("begin", &Course::begin, "Begins the run.")
      .def_prop_ro("now", &Course::now)
      .def("next_event", &Course::next_event, "When something may happen next.")
      .def("wait_until", &Course::wait_until, nb::arg("moment"), "Time passes, at most up to the next event.")
      .def("react", &Course::react, "What happens now: whether something did.")
      .def_prop_ro("over", [](const Course& self) { return self.ending().has_value(); });
}

}  // namespace tachk::bind
