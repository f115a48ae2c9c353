// The functions of FMI 3.0 for what a unit does not have: derivatives, periodic clocks, other kinds of units, types.
#include <cstddef>

#include "fmi/instance.hpp"

extern "C" {
#include <fmi3Functions.h>
}

namespace {

fmi3Status unsupported(fmi3Instance instance, const char* function) {
  if (instance != nullptr) static_cast<tachk::fmi::Instance*>(instance)->log(function);
  return fmi3Error;
}

// Nothing of nothing is no mistake.
fmi3Status unsupported_unless_empty(fmi3Instance instance, std::size_t count, const char* function) {
  return count == 0 ? fmi3OK : unsupported(instance, function);
}

}  // namespace

extern "C" {

fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                          fmi3InstanceEnvironment, fmi3LogMessageCallback) {
  return nullptr;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                               fmi3InstanceEnvironment, fmi3LogMessageCallback, fmi3ClockUpdateCallback,
                                               fmi3LockPreemptionCallback, fmi3UnlockPreemptionCallback) {
  return nullptr;
}

fmi3Status fmi3GetFloat32(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3Float32*,
                          std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetFloat32 is not for units of this kind");
}

fmi3Status fmi3GetInt8(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3Int8*, std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetInt8 is not for units of this kind");
}

fmi3Status fmi3GetUInt8(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3UInt8*, std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetUInt8 is not for units of this kind");
}

fmi3Status fmi3GetInt16(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3Int16*, std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetInt16 is not for units of this kind");
}

fmi3Status fmi3GetUInt16(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3UInt16*,
                         std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetUInt16 is not for units of this kind");
}

fmi3Status fmi3GetUInt32(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3UInt32*,
                         std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetUInt32 is not for units of this kind");
}

fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3String*,
                         std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetString is not for units of this kind");
}

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, std::size_t*, fmi3Binary*,
                         std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetBinary is not for units of this kind");
}

fmi3Status fmi3SetFloat32(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const fmi3Float32*,
                          std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3SetFloat32 is not for units of this kind");
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const fmi3Float64*,
                          std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3SetFloat64 is not for units of this kind");
}

fmi3Status fmi3SetInt8(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const fmi3Int8*,
                       std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3SetInt8 is not for units of this kind");
}

fmi3Status fmi3SetUInt8(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const fmi3UInt8*,
                        std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3SetUInt8 is not for units of this kind");
}

fmi3Status fmi3SetInt16(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const fmi3Int16*,
                        std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3SetInt16 is not for units of this kind");
}

fmi3Status fmi3SetUInt16(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const fmi3UInt16*,
                         std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3SetUInt16 is not for units of this kind");
}

fmi3Status fmi3SetUInt32(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const fmi3UInt32*,
                         std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3SetUInt32 is not for units of this kind");
}

fmi3Status fmi3SetString(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const fmi3String*,
                         std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3SetString is not for units of this kind");
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const std::size_t*,
                         const fmi3Binary*, std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3SetBinary is not for units of this kind");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference, std::size_t*) {
  return unsupported(instance, "fmi3GetNumberOfVariableDependencies is not for units of this kind");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference, std::size_t*, fmi3ValueReference*,
                                       std::size_t*, fmi3DependencyKind*, std::size_t count) {
  return unsupported_unless_empty(instance, count, "fmi3GetVariableDependencies is not for units of this kind");
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference*, std::size_t count,
                                        const fmi3ValueReference*, std::size_t, const fmi3Float64*, std::size_t,
                                        fmi3Float64*, std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetDirectionalDerivative is not for units of this kind");
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference*, std::size_t count,
                                    const fmi3ValueReference*, std::size_t, const fmi3Float64*, std::size_t,
                                    fmi3Float64*, std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetAdjointDerivative is not for units of this kind");
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
  return unsupported(instance, "fmi3EnterConfigurationMode is not for units of this kind");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
  return unsupported(instance, "fmi3ExitConfigurationMode is not for units of this kind");
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3Float64*,
                                  fmi3IntervalQualifier*) {
  return unsupported_unless_empty(instance, count, "fmi3GetIntervalDecimal is not for units of this kind");
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3UInt64*,
                                   fmi3UInt64*, fmi3IntervalQualifier*) {
  return unsupported_unless_empty(instance, count, "fmi3GetIntervalFraction is not for units of this kind");
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3Float64*) {
  return unsupported_unless_empty(instance, count, "fmi3GetShiftDecimal is not for units of this kind");
}

fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, fmi3UInt64*,
                                fmi3UInt64*) {
  return unsupported_unless_empty(instance, count, "fmi3GetShiftFraction is not for units of this kind");
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference*, std::size_t count,
                                  const fmi3Float64*) {
  return unsupported_unless_empty(instance, count, "fmi3SetIntervalDecimal is not for units of this kind");
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance instance, const fmi3ValueReference*, std::size_t count,
                                   const fmi3UInt64*, const fmi3UInt64*) {
  return unsupported_unless_empty(instance, count, "fmi3SetIntervalFraction is not for units of this kind");
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference*, std::size_t count,
                               const fmi3Float64*) {
  return unsupported_unless_empty(instance, count, "fmi3SetShiftDecimal is not for units of this kind");
}

fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference*, std::size_t count, const fmi3UInt64*,
                                const fmi3UInt64*) {
  return unsupported_unless_empty(instance, count, "fmi3SetShiftFraction is not for units of this kind");
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  return unsupported(instance, "fmi3EnterContinuousTimeMode is not for units of this kind");
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean, fmi3Boolean*, fmi3Boolean*) {
  return unsupported(instance, "fmi3CompletedIntegratorStep is not for units of this kind");
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64) {
  return unsupported(instance, "fmi3SetTime is not for units of this kind");
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64*, std::size_t count) {
  return unsupported_unless_empty(instance, count, "fmi3SetContinuousStates is not for units of this kind");
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64*, std::size_t count) {
  return unsupported_unless_empty(instance, count, "fmi3GetContinuousStateDerivatives is not for units of this kind");
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64*, std::size_t count) {
  return unsupported_unless_empty(instance, count, "fmi3GetEventIndicators is not for units of this kind");
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64*, std::size_t count) {
  return unsupported_unless_empty(instance, count, "fmi3GetContinuousStates is not for units of this kind");
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64*, std::size_t count) {
  return unsupported_unless_empty(instance, count, "fmi3GetNominalsOfContinuousStates is not for units of this kind");
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, std::size_t*) {
  return unsupported(instance, "fmi3GetNumberOfEventIndicators is not for units of this kind");
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, std::size_t*) {
  return unsupported(instance, "fmi3GetNumberOfContinuousStates is not for units of this kind");
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference*, std::size_t count,
                                    const fmi3Int32*, fmi3Float64*, std::size_t) {
  return unsupported_unless_empty(instance, count, "fmi3GetOutputDerivatives is not for units of this kind");
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference, fmi3Float64) {
  return unsupported(instance, "fmi3ActivateModelPartition is not for units of this kind");
}

}  // extern "C"
