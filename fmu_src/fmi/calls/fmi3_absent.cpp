/// The functions of FMI 3.0 that are not implemented: model exchange and scheduled execution, events and clocks, structural parameters,
/// dependencies of single elements, partial derivatives. modelDescription.xml claims none of them.
extern "C" {
#include "fmi3Functions.h"
}

#include "calls/fmi3.hpp"

using namespace softffd::fmi;

namespace {

fmi3Status absent(fmi3Instance handle, const char* name) noexcept {
  return guarded3(handle, {name, function3::any_phase}, {},
                  [&](Instance&) { throw CallError(std::string(name) + ": not available; modelDescription.xml does not claim it"); });
}

fmi3Instance no_instance(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, const char* message) noexcept {
  if (log) log(environment, fmi3Error, log_error, message);
  return nullptr;
}

}  // namespace

extern "C" {

fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log) {
  return no_instance(environment, log, "fmi3InstantiateModelExchange: not available; wanted fmi3InstantiateCoSimulation");
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback,
                                               fmi3LockPreemptionCallback, fmi3UnlockPreemptionCallback) {
  return no_instance(environment, log, "fmi3InstantiateScheduledExecution: not available; wanted fmi3InstantiateCoSimulation");
}

// clang-format off
#define SOFTFFD_ABSENT(name, ...) \
  fmi3Status name(fmi3Instance handle __VA_OPT__(, ) __VA_ARGS__) { return absent(handle, #name); }
#define REFERENCES const fmi3ValueReference[], size_t
SOFTFFD_ABSENT(fmi3EnterEventMode)
SOFTFFD_ABSENT(fmi3EnterStepMode)
SOFTFFD_ABSENT(fmi3EnterContinuousTimeMode)
SOFTFFD_ABSENT(fmi3EnterConfigurationMode)
SOFTFFD_ABSENT(fmi3ExitConfigurationMode)
SOFTFFD_ABSENT(fmi3EvaluateDiscreteStates)
SOFTFFD_ABSENT(fmi3UpdateDiscreteStates, fmi3Boolean*, fmi3Boolean*, fmi3Boolean*, fmi3Boolean*, fmi3Boolean*, fmi3Float64*)
SOFTFFD_ABSENT(fmi3GetNumberOfVariableDependencies, fmi3ValueReference, size_t*)
SOFTFFD_ABSENT(fmi3GetVariableDependencies, fmi3ValueReference, size_t[], fmi3ValueReference[], size_t[], fmi3DependencyKind[], size_t)
SOFTFFD_ABSENT(fmi3GetDirectionalDerivative, REFERENCES, REFERENCES, const fmi3Float64[], size_t, fmi3Float64[], size_t)
SOFTFFD_ABSENT(fmi3GetAdjointDerivative, REFERENCES, REFERENCES, const fmi3Float64[], size_t, fmi3Float64[], size_t)
SOFTFFD_ABSENT(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64[], fmi3IntervalQualifier[])
SOFTFFD_ABSENT(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64[], fmi3UInt64[], fmi3IntervalQualifier[])
SOFTFFD_ABSENT(fmi3GetShiftDecimal, REFERENCES, fmi3Float64[])
SOFTFFD_ABSENT(fmi3GetShiftFraction, REFERENCES, fmi3UInt64[], fmi3UInt64[])
SOFTFFD_ABSENT(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64[])
SOFTFFD_ABSENT(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64[], const fmi3UInt64[])
SOFTFFD_ABSENT(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64[])
SOFTFFD_ABSENT(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64[], const fmi3UInt64[])
SOFTFFD_ABSENT(fmi3CompletedIntegratorStep, fmi3Boolean, fmi3Boolean*, fmi3Boolean*)
SOFTFFD_ABSENT(fmi3SetTime, fmi3Float64)
SOFTFFD_ABSENT(fmi3SetContinuousStates, const fmi3Float64[], size_t)
SOFTFFD_ABSENT(fmi3GetContinuousStateDerivatives, fmi3Float64[], size_t)
SOFTFFD_ABSENT(fmi3GetEventIndicators, fmi3Float64[], size_t)
SOFTFFD_ABSENT(fmi3GetContinuousStates, fmi3Float64[], size_t)
SOFTFFD_ABSENT(fmi3GetNominalsOfContinuousStates, fmi3Float64[], size_t)
SOFTFFD_ABSENT(fmi3GetNumberOfEventIndicators, size_t*)
SOFTFFD_ABSENT(fmi3GetNumberOfContinuousStates, size_t*)
SOFTFFD_ABSENT(fmi3ActivateModelPartition, fmi3ValueReference, fmi3Float64)
#undef REFERENCES
#undef SOFTFFD_ABSENT
// clang-format on

}  // extern "C"
