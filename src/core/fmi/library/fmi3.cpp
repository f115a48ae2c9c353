// The functions of FMI 3.0 that a unit for co-simulation has. `fmi3_unsupported.cpp` has those that it does not.
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "fmi/instance.hpp"

extern "C" {
#include <fmi3Functions.h>
}

namespace {

using tachk::fmi::Advance;
using tachk::fmi::Instance;
using tachk::fmi::Mode;
using tachk::fmi::Snapshot;
using tachk::fmi::Type;
using tachk::fmi::UnitRun;

// The additional data of a unit of this version.
struct Unit : Instance {
  using Instance::Instance;
  bool event_mode = false;
  bool early_return = false;
};

template <class Body>
fmi3Status guard(fmi3Instance instance, Body body) {
  return tachk::fmi::guarded(instance, fmi3OK, fmi3Error, [&](Instance& unit) { body(static_cast<Unit&>(unit)); });
}

template <class Value>
fmi3Status get(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count, Value* values,
               std::size_t wanted, Type type) {
  return guard(instance, [&](Unit& unit) {
    if (wanted != count) throw std::invalid_argument("a variable has one value");
    for (std::size_t n = 0; n < count; ++n) {
      if constexpr (std::is_same_v<Value, double>)
        values[n] = unit.run().real(references[n]);
      else
        values[n] = static_cast<Value>(unit.run().number(references[n], type));
    }
  });
}

template <class Value>
fmi3Status set(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count, const Value* values,
               std::size_t given, Type type) {
  return guard(instance, [&](Unit& unit) {
    if (given != count) throw std::invalid_argument("a variable has one value");
    for (std::size_t n = 0; n < count; ++n)
      unit.run().set_number(references[n], type, static_cast<std::int64_t>(values[n]));
  });
}

}  // namespace

extern "C" {

const char* fmi3GetVersion() { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance, fmi3Boolean, std::size_t, const fmi3String*) { return fmi3OK; }

// ---- creation -------------------------------------------------------------------------------------------------------

fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String token, fmi3String resources, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference*,
                                         std::size_t, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback logger, fmi3IntermediateUpdateCallback) {
  const auto log = [=](const char* message) {
    if (logger != nullptr) logger(environment, fmi3Error, "error", message);
  };
  try {
    auto unit = std::make_unique<Unit>(resources == nullptr ? "." : resources, token == nullptr ? "" : token, log);
    unit->event_mode = event_mode;
    unit->early_return = early_return;
    return static_cast<Instance*>(unit.release());
  } catch (const std::exception& error) {
    log(error.what());
    return nullptr;
  }
}

void fmi3FreeInstance(fmi3Instance instance) { delete static_cast<Unit*>(static_cast<Instance*>(instance)); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean, fmi3Float64, fmi3Float64 start,
                                       fmi3Boolean stops, fmi3Float64 stop) {
  return guard(instance, [&](Unit& unit) { unit.initialize(start, stops ? std::optional(stop) : std::nullopt); });
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  return guard(instance, [](Unit& unit) {
    unit.require(Mode::initialization, "ExitInitializationMode");
    unit.run().begin();
    unit.enter(unit.event_mode ? Mode::event : Mode::step);
  });
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
  return guard(instance, [](Unit& unit) { unit.enter(Mode::terminated); });
}

fmi3Status fmi3Reset(fmi3Instance instance) {
  return guard(instance, [](Unit& unit) { unit.reset(); });
}

// ---- values ---------------------------------------------------------------------------------------------------------

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                          fmi3Float64* values, std::size_t wanted) {
  return get(instance, references, count, values, wanted, Type::real);
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                        fmi3Int32* values, std::size_t wanted) {
  return get(instance, references, count, values, wanted, Type::integer);
}

// Enumerations are 64-bit integers.
fmi3Status fmi3GetInt64(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                        fmi3Int64* values, std::size_t wanted) {
  return get(instance, references, count, values, wanted, Type::enumeration);
}

fmi3Status fmi3GetUInt64(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                         fmi3UInt64* values, std::size_t wanted) {
  return get(instance, references, count, values, wanted, Type::natural);
}

fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                          fmi3Boolean* values, std::size_t wanted) {
  return get(instance, references, count, values, wanted, Type::truth);
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                        fmi3Clock* values) {
  return guard(instance, [&](Unit& unit) {
    unit.require(Mode::event, "GetClock");
    for (std::size_t n = 0; n < count; ++n) values[n] = unit.run().ticks(references[n]);
  });
}

fmi3Status fmi3SetInt32(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                        const fmi3Int32* values, std::size_t given) {
  return set(instance, references, count, values, given, Type::integer);
}

fmi3Status fmi3SetInt64(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                        const fmi3Int64* values, std::size_t given) {
  return set(instance, references, count, values, given, Type::enumeration);
}

fmi3Status fmi3SetUInt64(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                         const fmi3UInt64* values, std::size_t given) {
  return set(instance, references, count, values, given, Type::natural);
}

fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                          const fmi3Boolean* values, std::size_t given) {
  return set(instance, references, count, values, given, Type::truth);
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference* references, std::size_t count,
                        const fmi3Clock* values) {
  return guard(instance, [&](Unit& unit) {
    unit.require(Mode::event, "SetClock");
    for (std::size_t n = 0; n < count; ++n)
      if (values[n]) unit.run().set_ticks(references[n]);
  });
}

// ---- states ---------------------------------------------------------------------------------------------------------

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return guard(instance, [&](Unit& unit) {
    delete static_cast<Snapshot*>(*state);
    *state = unit.snapshot().release();
  });
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  return guard(instance, [&](Unit& unit) { unit.restore(*static_cast<Snapshot*>(state)); });
}

fmi3Status fmi3FreeFMUState(fmi3Instance, fmi3FMUState* state) {
  if (state != nullptr) {
    delete static_cast<Snapshot*>(*state);
    *state = nullptr;
  }
  return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, std::size_t* size) {
  return guard(instance, [&](Unit&) { *size = static_cast<Snapshot*>(state)->bytes().size(); });
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte* bytes, std::size_t size) {
  return guard(instance, [&](Unit&) {
    const std::vector<std::byte> written = static_cast<Snapshot*>(state)->bytes();
    if (written.size() > size) throw std::invalid_argument("there is too little room for the state");
    std::memcpy(bytes, written.data(), written.size());
  });
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte* bytes, std::size_t size,
                                   fmi3FMUState* state) {
  return guard(instance,
               [&](Unit& unit) { *state = unit.snapshot_of(std::as_bytes(std::span(bytes, size))).release(); });
}

// ---- the run --------------------------------------------------------------------------------------------------------

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  return guard(instance, [](Unit& unit) {
    if (!unit.event_mode) throw std::logic_error("EnterEventMode was called without event mode");
    unit.require(Mode::step, "EnterEventMode");
    unit.enter(Mode::event);
  });
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  return guard(instance, [](Unit& unit) {
    unit.require(Mode::event, "EnterStepMode");
    unit.enter(Mode::step);
  });
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
  return guard(instance, [](Unit& unit) { unit.require(Mode::event, "EvaluateDiscreteStates"); });
}

// One transition, or all that the environment has sent; masters come again while there is more.
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* again, fmi3Boolean* over,
                                    fmi3Boolean* nominals_changed, fmi3Boolean* states_changed, fmi3Boolean* known,
                                    fmi3Float64* next_time) {
  return guard(instance, [&](Unit& unit) {
    unit.require(Mode::event, "UpdateDiscreteStates");
    UnitRun& run = unit.run();
    const bool happened = run.react();
    const tachk::flow::Ticks next = run.next_event();
    *again = happened && (next <= run.now() || run.ticking());
    *over = run.ending().has_value();
    *nominals_changed = false;
    *states_changed = false;
    *known = next < tachk::flow::never;
    *next_time = *known ? unit.run().scale().seconds(run.start() + next) : 0.0;
  });
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 size, fmi3Boolean, fmi3Boolean* event,
                      fmi3Boolean* over, fmi3Boolean* early, fmi3Float64* last) {
  return guard(instance, [&](Unit& unit) {
    const Advance done = unit.advance(time, size, unit.event_mode && unit.early_return, !unit.event_mode);
    const double end = unit.run().scale().seconds(unit.run().start() + done.end);
    const bool whole = done.end == unit.run().scale().ticks(time + size) - unit.run().start();
    *event = done.event && unit.event_mode;
    *over = done.over;
    *early = !whole && unit.early_return;
    *last = whole ? time + size : end;
    if (!whole && !done.over && !unit.early_return)
      throw std::logic_error("time cannot pass before the inputs change, and a step may not return early");
  });
}

}  // extern "C"
