"""The same host on the C functions of FMI 3.0. It speaks of variables by the names that they have in FMI 2.0, so that one schedule and one
run serve both: what is an element of an array is put there, and the arrays that hold it are set as a whole."""

from ctypes import CFUNCTYPE, byref, c_bool, c_char_p, c_double, c_int, c_int64, c_size_t, c_uint32, c_void_p, create_string_buffer

import fmpy
import numpy as np

from c_host import Fmu, Host, ints
from signatures import COUNTS, REALS, SIGNATURES3
from softffd import Scene
from softffd.fmu.interface import elements
from softffd.fmu.package import scene_masses
from softffd.fmu.variables import variables
from softffd.names import parse_name

Logger = CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
SPELLED = {"FMUstate": "FMUState", "DeSerialize": "Deserialize", "RealOutput": "Output", "tReal": "tFloat64", "tInteger": "tInt64"}
"""Functions' names of FMI 2.0 and those of FMI 3.0, where they differ"""


class Fmu3(Fmu):
    """An unpacked FMU of FMI 3.0."""

    standard, signatures, platform = "fmi3", SIGNATURES3, fmpy.platform_tuple
    instantiation = (
        "InstantiateCoSimulation",
        [*(c_char_p, c_char_p, c_char_p, c_bool, c_bool, c_bool, c_bool, c_void_p, c_size_t, c_void_p, Logger, c_void_p)],
    )
    interpolates = False

    def find_variables(self, scene: Scene) -> None:
        self.resources = f"{self.unpacked / 'resources'}/".encode()
        self.arrays = {v.name: v for v in self.description.modelVariables}
        self.shapes = {name: tuple(int(dimension.start) for dimension in v.dimensions) for name, v in self.arrays.items()}
        self._orders: dict[tuple[str, ...], np.ndarray] = {}
        self.names = self._places([each.name for variable in variables(scene, scene_masses(scene).mass) for each in elements(variable)])

    def _places(self, names: list[str]) -> dict[str, tuple[str, int]]:
        """Array and element, row by row, by the names that FMI 2.0 has."""
        elements: dict[str, list[str]] = {}
        for name in names:
            array = name if name in self.arrays else name.partition("[")[0] if "[" in name else name.rpartition(".")[0]
            elements.setdefault(array, []).append(name)
        for array, own in elements.items():
            assert len(own) == int(np.prod(self.shapes[array])), array
            if len(self.shapes[array]) == 4:
                own.sort(key=lambda name: parse_name(name)[1:])
        places = {name: (array, n) for array, own in elements.items() for n, name in enumerate(own)}
        return {name: places[name] for name in names}

    def order(self, arrays: tuple[str, ...]) -> np.ndarray:
        """Where in these arrays, one after the other, the elements are in the order of FMI 2.0."""
        if arrays not in self._orders:
            begins = dict(zip(arrays, np.cumsum([0, *(int(np.prod(self.shapes[name])) for name in arrays)]), strict=False))
            self._orders[arrays] = np.array([begins[array] + n for array, n in self.names.values() if array in begins], dtype=int)
        return self._orders[arrays]

    def of(self, causality: str, kind: str) -> list[str]:
        """Names of arrays."""
        return [name for name, v in self.arrays.items() if v.causality == causality and v.type == kind]

    def host(self, **options) -> "Host3":
        return Host3(self, **options)

    def spelled(self, function: str) -> str:
        for two, three in SPELLED.items():
            function = function.replace(two, three)
        return function


class Host3(Host):
    """One instance of it."""

    fmu: Fmu3

    def __init__(self, fmu: Fmu3, *, logging: bool = False, name: bytes = b"host", logger: bool = True, **given):
        self.fmu, self.messages, self.name = fmu, [], name
        self._logger = Logger(self._note3) if logger else Logger()
        arguments = {"token": fmu.guid, "resources": fmu.resources, "events": False, "early": True, "intermediate": 0} | given
        strings = [create_string_buffer(text) if text is not None else None for text in (name, arguments["token"], arguments["resources"])]
        self.component = fmu.library.fmi3InstantiateCoSimulation(
            *strings, False, logging, arguments["events"], arguments["early"], None, arguments["intermediate"], 4711, self._logger, None
        )
        for memory in strings:  # valid during the call only
            if memory is not None:
                memory.raw = b"\xee" * len(memory)
        self.last = c_double()

    def _note3(self, environment, status, category, message) -> None:
        self.messages.append((environment, self.name, status, category, message))

    def __call__(self, function: str, *arguments) -> int:
        """Functions by their names in either standard."""
        function = self.fmu.spelled(function)
        if function == "DoStep" and len(arguments) == 3:
            self.flags = [c_bool(True) for _ in range(3)]
            arguments += (*map(byref, self.flags), byref(self.last))
        return super().__call__(function, *arguments)

    def enter(self, start: float = 0.0, stop: float | None = None, tolerance: float | None = None) -> int:
        return self("EnterInitializationMode", tolerance is not None, tolerance or 0.0, start, stop is not None, stop or 0.0)

    # ---- arrays ----

    def references(self, arrays) -> tuple:
        return (c_uint32 * len(arrays))(*(self.fmu.arrays[name].valueReference for name in arrays)), len(arrays)

    def size(self, arrays) -> int:
        return int(sum(np.prod(self.fmu.shapes[name]) for name in arrays))

    def get(self, *arrays: str, kind: str = "Float64") -> dict[str, np.ndarray]:
        """Several at once, by name."""
        values = np.zeros(self.size(arrays), dtype=np.float64 if kind == "Float64" else np.int64)
        self.must(f"Get{kind}", *self.references(arrays), values.ctypes.data_as(REALS if kind == "Float64" else COUNTS), len(values))
        return self._apart(arrays, values)

    def _apart(self, arrays, values: np.ndarray) -> dict[str, np.ndarray]:
        ends = np.cumsum([int(np.prod(self.fmu.shapes[name])) for name in arrays])
        return {name: part.reshape(self.fmu.shapes[name]) for name, part in zip(arrays, np.split(values, ends[:-1]), strict=True)}

    def put(self, arrays: dict[str, np.ndarray]) -> int:
        """Sets several at once."""
        values = np.concatenate([np.asarray(value, dtype=float).ravel() for value in arrays.values()])
        return self("SetFloat64", *self.references(list(arrays)), values.ctypes.data_as(REALS), len(values))

    # ---- by the names of FMI 2.0 ----

    def set(self, values: dict[str, float]) -> int:
        places = {name: self.fmu.names[name] for name in values}
        arrays = self.get(*dict.fromkeys(array for array, _ in places.values()))
        for name, (array, element) in places.items():
            arrays[array].reshape(-1)[element] = values[name]
        return self.put(arrays)

    def put_by_name(self, values: dict[str, float]) -> int:
        """Whatever the names are, without a look at what else the arrays hold: zeros."""
        arrays = {array: np.zeros(self.fmu.shapes[array]) for array, _ in map(self.fmu.names.get, values)}
        for name, value in values.items():
            array, element = self.fmu.names[name]
            arrays[array].reshape(-1)[element] = value
        return self.put(arrays)

    def set_integer(self, name: str, value: int) -> int:
        return self("SetInt64", *self.references([name]), (c_int64 * 1)(value), 1)

    def ask_slope(self, name: str, order: int = 1) -> int:
        count = self.size([name])
        return self("GetOutputDerivatives", *self.references([name]), ints([order]), (c_double * count)(), count)

    def set_rates(self, rates) -> None:
        raise AssertionError("inputs have no derivatives")

    def reached(self) -> float:
        return self.last.value

    def _in_order(self, arrays: dict[str, np.ndarray]) -> np.ndarray:
        """Elements one by one as FMI 2.0 lists them."""
        return np.concatenate([values.ravel() for values in arrays.values()])[self.fmu.order(tuple(arrays))]

    def settings(self) -> bytes:
        return self._in_order(self.get(*self.fmu.of("input", "Float64"), *self.fmu.of("parameter", "Float64"))).tobytes()

    def outputs(self) -> bytes:
        counted = self.fmu.of("output", "Int64")
        counts = self._in_order(self.get(*counted, kind="Int64")).astype(np.int32) if counted else np.zeros(0, np.int32)
        return self._in_order(self.get(*self.fmu.of("output", "Float64"))).tobytes() + counts.tobytes()

    def slopes(self) -> bytes:
        arrays = self.fmu.of("output", "Float64")
        values = np.zeros(self.size(arrays))
        references, count = self.references(arrays)
        self.must("GetOutputDerivatives", references, count, ints([1] * count), values.ctypes.data_as(REALS), len(values))
        return self._in_order(self._apart(arrays, values)).tobytes()
