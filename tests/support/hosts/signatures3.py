"""The functions of FMI 3.0's header that take an instance, by what they take behind it."""

from ctypes import POINTER, c_bool, c_char_p, c_double, c_int32, c_int64, c_size_t, c_uint32, c_void_p

REFERENCES, REALS, COUNTS, FLAG = POINTER(c_uint32), POINTER(c_double), POINTER(c_int64), POINTER(c_bool)
STATE, SIZE, ANY = POINTER(c_void_p), POINTER(c_size_t), c_void_p
SOME = [REFERENCES, c_size_t]


def _by_name(table: list) -> dict[str, list]:
    return {name: kinds for names, kinds in table for name in names.split()}


OTHER_TYPES = _by_name(
    [
        (f"{way}{kind}", [*SOME, ANY, c_size_t])
        for way in ("Get", "Set")
        for kind in ["Float32", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "UInt64", "Boolean", "String"]
    ]
)
"""Getters and setters of types that no variable has"""

SIGNATURES = OTHER_TYPES | _by_name(
    [
        ("GetClock SetClock", [*SOME, ANY]),
        ("GetBinary SetBinary", [*SOME, ANY, ANY, c_size_t]),
        ("SetDebugLogging", [c_bool, c_size_t, POINTER(c_char_p)]),
        ("EnterInitializationMode", [c_bool, c_double, c_double, c_bool, c_double]),
        ("ExitInitializationMode Terminate Reset", []),
        ("GetFloat64 SetFloat64", [*SOME, REALS, c_size_t]),
        ("GetInt64 SetInt64", [*SOME, COUNTS, c_size_t]),
        ("GetOutputDerivatives", [*SOME, POINTER(c_int32), REALS, c_size_t]),
        ("DoStep", [c_double, c_double, c_bool, FLAG, FLAG, FLAG, REALS]),
        ("GetFMUState FreeFMUState", [STATE]),
        ("SetFMUState", [c_void_p]),
        ("SerializedFMUStateSize", [c_void_p, SIZE]),
        ("SerializeFMUState", [c_void_p, c_char_p, c_size_t]),
        ("DeserializeFMUState", [c_char_p, c_size_t, STATE]),
    ]
)

ABSENT = _by_name(
    [
        ("EnterEventMode EnterStepMode EnterContinuousTimeMode EnterConfigurationMode ExitConfigurationMode EvaluateDiscreteStates", []),
        ("UpdateDiscreteStates", [FLAG, FLAG, FLAG, FLAG, FLAG, REALS]),
        ("GetNumberOfVariableDependencies", [c_uint32, SIZE]),
        ("GetVariableDependencies", [c_uint32, ANY, ANY, ANY, ANY, c_size_t]),
        ("GetDirectionalDerivative GetAdjointDerivative", [*SOME, *SOME, REALS, c_size_t, REALS, c_size_t]),
        ("GetIntervalDecimal GetShiftFraction SetIntervalFraction SetShiftFraction", [*SOME, ANY, ANY]),
        ("GetIntervalFraction", [*SOME, ANY, ANY, ANY]),
        ("GetShiftDecimal SetIntervalDecimal SetShiftDecimal", [*SOME, REALS]),
        ("CompletedIntegratorStep", [c_bool, FLAG, FLAG]),
        ("SetTime", [c_double]),
        ("SetContinuousStates GetContinuousStates GetContinuousStateDerivatives", [REALS, c_size_t]),
        ("GetNominalsOfContinuousStates GetEventIndicators", [REALS, c_size_t]),
        ("GetNumberOfEventIndicators GetNumberOfContinuousStates", [SIZE]),
        ("ActivateModelPartition", [c_uint32, c_double]),
    ]
)
"""What there is nothing behind"""
