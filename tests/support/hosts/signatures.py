"""The functions of the standards that take an instance, by the types of what they take behind it: read from the standards' headers."""

import re
from ctypes import POINTER, c_bool, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t, c_uint32, c_void_p
from pathlib import Path

import fmpy

REALS, COUNTS = POINTER(c_double), POINTER(c_int64)
HEADERS = Path(fmpy.__file__).parent / "c-code"
KINDS = {"size_t": c_size_t, "ValueReference": c_uint32, "String": c_char_p, "FMUstate": c_void_p, "FMUState": c_void_p}
KINDS |= {"Real": c_double, "Integer": c_int, "StatusKind": c_int, "Status": c_int, "Float64": c_double, "Int32": c_int32, "Int64": c_int64}


def _kind(argument: str, boolean: type) -> type:
    """Of an argument as the header declares it; of arrays of what no test fills the address alone."""
    base = re.match(r"\s*(?:const\s+)?(?:fmi\d)?(\w+)", argument)[1]
    kind = boolean if base == "Boolean" else KINDS.get(base)
    if base == "Byte":
        return c_char_p
    return kind if not re.search(r"[*\[]", argument) else POINTER(kind) if kind else c_void_p


def _signatures(standard: int, boolean: type) -> dict[str, list[type]]:
    text = (HEADERS / f"fmi{standard}FunctionTypes.h").read_text()
    if standard == 2:
        text = re.sub(r"for Model Exchange\s*\*+/.*?/\*+[^*]*for Co-Simulation\s*\*+/", "*/", text, flags=re.DOTALL)
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    found = re.findall(rf"typedef\s+fmi{standard}Status\s+fmi{standard}(\w+)TYPE\s*\(([^)]*)\)", text)
    return {name: [_kind(each, boolean) for each in arguments.split(",")[1:]] for name, arguments in found}


SIGNATURES = _signatures(2, c_int)
"""Of FMI 2.0, without those of model exchange alone"""
SIGNATURES3 = _signatures(3, c_bool)
OTHER_TYPES = [name for name in SIGNATURES3 if re.fullmatch("[GS]et(Float32|U?Int(8|16)|U?Int32|UInt64|Boolean|String)", name)]
"""Getters and setters of types that no variable has"""
PRESENT = f"""SetDebugLogging EnterInitializationMode ExitInitializationMode Terminate Reset GetFloat64 SetFloat64 GetInt64 SetInt64
    GetClock SetClock GetBinary SetBinary GetOutputDerivatives DoStep GetFMUState FreeFMUState SetFMUState SerializedFMUStateSize
    SerializeFMUState DeserializeFMUState {" ".join(OTHER_TYPES)}""".split()
ABSENT = {name: kinds for name, kinds in SIGNATURES3.items() if name not in PRESENT}
"""What there is nothing behind"""
