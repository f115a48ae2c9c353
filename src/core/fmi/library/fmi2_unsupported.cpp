// The functions of FMI 2.0 for what a unit does not have: model exchange, derivatives, texts, steps that go on behind.
#include <cstddef>

#include "fmi/instance.hpp"

extern "C" {
#include <fmi2Functions.h>
}

namespace {

fmi2Status unsupported(fmi2Component component, const char* function) {
  if (component != nullptr) static_cast<tachk::fmi::Instance*>(component)->log(function);
  return fmi2Error;
}

// Nothing of nothing is no mistake.
fmi2Status unsupported_unless_empty(fmi2Component component, std::size_t count, const char* function) {
  return count == 0 ? fmi2OK : unsupported(component, function);
}

}  // namespace

extern "C" {

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference*, std::size_t count, fmi2String*) {
  return unsupported_unless_empty(component, count, "fmi2GetString is not for units of this kind");
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference*, std::size_t count, const fmi2Real*) {
  return unsupported_unless_empty(component, count, "fmi2SetReal is not for units of this kind");
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference*, std::size_t count, const fmi2String*) {
  return unsupported_unless_empty(component, count, "fmi2SetString is not for units of this kind");
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference*, std::size_t count,
                                        const fmi2ValueReference*, std::size_t, const fmi2Real*, fmi2Real*) {
  return unsupported_unless_empty(component, count, "fmi2GetDirectionalDerivative is not for units of this kind");
}

fmi2Status fmi2EnterEventMode(fmi2Component component) {
  return unsupported(component, "fmi2EnterEventMode is not for units of this kind");
}

fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo*) {
  return unsupported(component, "fmi2NewDiscreteStates is not for units of this kind");
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) {
  return unsupported(component, "fmi2EnterContinuousTimeMode is not for units of this kind");
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean, fmi2Boolean*, fmi2Boolean*) {
  return unsupported(component, "fmi2CompletedIntegratorStep is not for units of this kind");
}

fmi2Status fmi2SetTime(fmi2Component component, fmi2Real) {
  return unsupported(component, "fmi2SetTime is not for units of this kind");
}

fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real*, std::size_t count) {
  return unsupported_unless_empty(component, count, "fmi2SetContinuousStates is not for units of this kind");
}

fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real*, std::size_t count) {
  return unsupported_unless_empty(component, count, "fmi2GetDerivatives is not for units of this kind");
}

fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real*, std::size_t count) {
  return unsupported_unless_empty(component, count, "fmi2GetEventIndicators is not for units of this kind");
}

fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real*, std::size_t count) {
  return unsupported_unless_empty(component, count, "fmi2GetContinuousStates is not for units of this kind");
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component, fmi2Real*, std::size_t count) {
  return unsupported_unless_empty(component, count, "fmi2GetNominalsOfContinuousStates is not for units of this kind");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference*, std::size_t count,
                                       const fmi2Integer*, const fmi2Real*) {
  return unsupported_unless_empty(component, count, "fmi2SetRealInputDerivatives is not for units of this kind");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference*, std::size_t count,
                                        const fmi2Integer*, fmi2Real*) {
  return unsupported_unless_empty(component, count, "fmi2GetRealOutputDerivatives is not for units of this kind");
}

fmi2Status fmi2CancelStep(fmi2Component component) {
  return unsupported(component, "fmi2CancelStep is not for units of this kind");
}

fmi2Status fmi2GetStatus(fmi2Component, const fmi2StatusKind, fmi2Status*) { return fmi2Discard; }

fmi2Status fmi2GetIntegerStatus(fmi2Component, const fmi2StatusKind, fmi2Integer*) { return fmi2Discard; }

fmi2Status fmi2GetStringStatus(fmi2Component, const fmi2StatusKind, fmi2String*) { return fmi2Discard; }

}  // extern "C"
