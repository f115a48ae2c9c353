// The functions of FMI 2.0 that a unit for co-simulation has. `fmi2_unsupported.cpp` has those that it does not.
#include <cctype>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "fmi/instance.hpp"

extern "C" {
#include <fmi2Functions.h>
}

namespace {

using tachk::fmi::Advance;
using tachk::fmi::Instance;
using tachk::fmi::Mode;
using tachk::fmi::Snapshot;
using tachk::fmi::Type;

// The additional data of a unit of this version.
struct Unit : Instance {
  using Instance::Instance;
  double start = 0;
  std::optional<double> stop;
  double last = 0;    // where the last step ended
  bool over = false;  // nothing can happen any more
};

template <class Body>
fmi2Status guard(fmi2Component component, Body body) {
  return tachk::fmi::guarded(component, fmi2OK, fmi2Error, [&](Instance& unit) { body(static_cast<Unit&>(unit)); });
}

// The path that a file URI stands for.
std::string path_of(const std::string& uri) {
  std::string rest = uri;
  for (const char* scheme : {"file://localhost/", "file:///", "file:/"})
    if (rest.rfind(scheme, 0) == 0) {
      rest = rest.substr(std::strlen(scheme) - 1);
      break;
    }
  std::string path;
  for (std::size_t n = 0; n < rest.size(); ++n) {
    const bool escaped = rest[n] == '%' && n + 2 < rest.size() &&
                         std::isxdigit(static_cast<unsigned char>(rest[n + 1])) &&
                         std::isxdigit(static_cast<unsigned char>(rest[n + 2]));
    path += escaped ? static_cast<char>(std::stoi(rest.substr(n + 1, 2), nullptr, 16)) : rest[n];
    if (escaped) n += 2;
  }
  return path;
}

// Integers stand for everything that is counted here.
Type integral(Unit& unit, fmi2ValueReference reference) {
  const auto& variables = unit.resource().variables;
  const Type type = reference < variables.size() ? variables[reference].type : Type::integer;
  return type == Type::enumeration || type == Type::natural ? type : Type::integer;
}

}  // namespace

extern "C" {

const char* fmi2GetTypesPlatform() { return fmi2TypesPlatform; }

const char* fmi2GetVersion() { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component, fmi2Boolean, std::size_t, const fmi2String*) { return fmi2OK; }

// ---- creation -------------------------------------------------------------------------------------------------------

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type kind, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* callbacks, fmi2Boolean, fmi2Boolean) {
  const fmi2CallbackFunctions given = callbacks == nullptr ? fmi2CallbackFunctions{} : *callbacks;
  const auto log = [given, called = std::string(name == nullptr ? "" : name)](const char* message) {
    if (given.logger != nullptr)
      given.logger(given.componentEnvironment, called.c_str(), fmi2Error, "error", "%s", message);
  };
  try {
    if (kind != fmi2CoSimulation) throw std::invalid_argument("this unit is for co-simulation");
    auto unit =
        std::make_unique<Unit>(path_of(resources == nullptr ? "." : resources), guid == nullptr ? "" : guid, log);
    return static_cast<Instance*>(unit.release());
  } catch (const std::exception& error) {
    log(error.what());
    return nullptr;
  }
}

void fmi2FreeInstance(fmi2Component component) { delete static_cast<Unit*>(static_cast<Instance*>(component)); }

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean stops,
                               fmi2Real stop) {
  return guard(component, [&](Unit& unit) {
    unit.require(Mode::instantiated, "SetupExperiment");
    unit.start = start;
    unit.stop = stops != fmi2False ? std::optional(stop) : std::nullopt;
  });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return guard(component, [](Unit& unit) { unit.initialize(unit.start, unit.stop); });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  return guard(component, [](Unit& unit) {
    unit.require(Mode::initialization, "ExitInitializationMode");
    unit.run().begin();
    unit.last = unit.start;
    unit.enter(Mode::step);
  });
}

fmi2Status fmi2Terminate(fmi2Component component) {
  return guard(component, [](Unit& unit) { unit.enter(Mode::terminated); });
}

fmi2Status fmi2Reset(fmi2Component component) {
  return guard(component, [](Unit& unit) {
    unit.reset();
    unit.over = false;
  });
}

// ---- values ---------------------------------------------------------------------------------------------------------

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference* references, std::size_t count,
                       fmi2Real* values) {
  return guard(component, [&](Unit& unit) {
    for (std::size_t n = 0; n < count; ++n) values[n] = unit.run().real(references[n]);
  });
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference* references, std::size_t count,
                          fmi2Integer* values) {
  return guard(component, [&](Unit& unit) {
    for (std::size_t n = 0; n < count; ++n)
      values[n] = static_cast<fmi2Integer>(unit.run().number(references[n], integral(unit, references[n])));
  });
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference* references, std::size_t count,
                          fmi2Boolean* values) {
  return guard(component, [&](Unit& unit) {
    for (std::size_t n = 0; n < count; ++n)
      values[n] = unit.run().number(references[n], Type::truth) != 0 ? fmi2True : fmi2False;
  });
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference* references, std::size_t count,
                          const fmi2Integer* values) {
  return guard(component, [&](Unit& unit) {
    for (std::size_t n = 0; n < count; ++n)
      unit.run().set_number(references[n], integral(unit, references[n]), values[n]);
  });
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference* references, std::size_t count,
                          const fmi2Boolean* values) {
  return guard(component, [&](Unit& unit) {
    for (std::size_t n = 0; n < count; ++n)
      unit.run().set_number(references[n], Type::truth, values[n] == fmi2False ? 0 : 1);
  });
}

// ---- states ---------------------------------------------------------------------------------------------------------

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return guard(component, [&](Unit& unit) {
    delete static_cast<Snapshot*>(*state);
    *state = unit.snapshot().release();
  });
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return guard(component, [&](Unit& unit) {
    unit.restore(*static_cast<Snapshot*>(state));
    unit.over = unit.run().ending().has_value();
    unit.last = unit.run().scale().seconds(unit.run().start() + unit.run().now());
  });
}

fmi2Status fmi2FreeFMUstate(fmi2Component, fmi2FMUstate* state) {
  if (state != nullptr) {
    delete static_cast<Snapshot*>(*state);
    *state = nullptr;
  }
  return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, std::size_t* size) {
  return guard(component, [&](Unit&) { *size = static_cast<Snapshot*>(state)->bytes().size(); });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte* bytes, std::size_t size) {
  return guard(component, [&](Unit&) {
    const std::vector<std::byte> written = static_cast<Snapshot*>(state)->bytes();
    if (written.size() > size) throw std::invalid_argument("there is too little room for the state");
    std::memcpy(bytes, written.data(), written.size());
  });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte* bytes, std::size_t size,
                                   fmi2FMUstate* state) {
  return guard(component,
               [&](Unit& unit) { *state = unit.snapshot_of(std::as_bytes(std::span(bytes, size))).release(); });
}

// ---- the run --------------------------------------------------------------------------------------------------------

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real size, fmi2Boolean) {
  bool over = false;
  const fmi2Status status = guard(component, [&](Unit& unit) {
    const Advance done = unit.advance(time, size, false, true);
    if (done.event) throw std::invalid_argument("time cannot pass before the inputs change");
    unit.over = over = done.over;
    unit.last = done.over ? unit.run().scale().seconds(unit.run().start() + done.end) : time + size;
  });
  return status == fmi2OK && over ? fmi2Discard : status;
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real* value) {
  if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
  return guard(component, [&](Unit& unit) { *value = unit.last; });
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean* value) {
  if (kind != fmi2Terminated) return fmi2Discard;
  return guard(component, [&](Unit& unit) { *value = unit.over ? fmi2True : fmi2False; });
}

}  // extern "C"
