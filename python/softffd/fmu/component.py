"""An FMU opened for a run, which a host drives through softffd.Simulation: its description, its variables, and an instance of it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from softffd.errors import FmuError, UnknownName
from softffd.fmu.absent import hint_for
from softffd.fmu.archive import library_in_tuple, unpack
from softffd.fmu.block import Block, number_of
from softffd.fmu.instance import Instance
from softffd.fmu.interface import ScalarVariable, read_interface
from softffd.fmu.notes import read_notes
from softffd.fmu.records import Resources
from softffd.installed import loaded_library
from softffd.lattice import LatticeBox

if TYPE_CHECKING:
    from softffd.scene.scene import Scene


class Component(Instance):
    """One instance of one FMU, a context manager. Every failing call raises FmuError with the component's own message.

    source: the path of an FMU; or a scene, whose FMU is written unpacked and whose library is the installed one.
    running: if False, only the description and the resources are read; nothing of the FMU is run, and there is no instance to call.
    A component that is not closed is freed with its last reference.
    """

    def __init__(self, source: Scene | str | Path, *, running: bool = True):
        if isinstance(source, str | Path) and not Path(source).is_file():
            got = "wanted an FMU, got a folder" if Path(source).is_dir() else "there is no such FMU"
            raise FmuError(f"{source}: {got}")
        super().__init__()
        self._unpacked = TemporaryDirectory(prefix="softffd-", ignore_cleanup_errors=True)
        self._folder = self._unpacked.name
        try:
            self._open(source, running)
        except BaseException:
            self.close()
            raise

    def _open(self, source: Scene | str | Path, running: bool) -> None:
        library = self._unpack(Path(source)) if isinstance(source, str | Path) else self._write(source)
        self.lattice: LatticeBox | None = self.resources.lattice  # only FMUs of this package have these three
        self.obstacles, self.taxels = self.resources.obstacles(), self.resources.taxels()
        if running:
            self._instantiate(self.interface, self._folder, library, self._name)

    def _unpack(self, path: Path) -> str | None:
        """Unpacks and reads an FMU. Returns the path of its library if this is not where FMI 2.0 puts it: the path of the installed
        library if the FMU has the same one."""
        self._name = str(path)
        try:
            library = unpack(path, self._folder)
            description = self.description
            three = description.fmiVersion.startswith("3.") and self.resources.lattice
            if not three and (description.coSimulation is None or description.fmiVersion != "2.0"):
                raise FmuError(f"{path}: wanted an FMI 2.0 co-simulation FMU, or one of this package for FMI 3.0")
            self.interface = read_interface(description, self.resources)
            return library or library_in_tuple(Path(self._folder), self.interface.identifier, three=bool(three))
        except FmuError:
            raise
        except Exception as error:
            raise FmuError(f"{path}: cannot be opened as an FMU: {error}") from error

    def _write(self, scene: Scene) -> str:
        """Writes a scene's FMU unpacked and returns the path of the library, which stays where it is installed."""
        from softffd.fmu.package import write_folder  # imports pydantic, which opening an FMU does not need

        self.interface = write_folder(scene, Path(self._folder))
        self._name = scene.name
        return str(loaded_library()._name)

    @cached_property
    def description(self) -> Any:
        """The modelDescription.xml as fmpy reads it."""
        import fmpy

        return fmpy.read_model_description(self._folder, validate=False)

    @cached_property
    def resources(self) -> Resources:
        """The scene file in the FMU's resources; empty for an FMU of another program."""
        return Resources(Path(self._folder) / "resources")

    @cached_property
    def notes(self) -> list[str]:
        """Notes for the user on the body; none for an FMU of another program."""
        return list(read_notes(Path(self._folder) / "resources"))

    # ---- variables ----

    @property
    def by_name(self) -> dict[str, ScalarVariable]:
        """All variables by name."""
        return self.interface.variables

    def variables(self, causality: str, kind: str = "Real") -> list[ScalarVariable]:
        """Returns the variables of a causality and a kind: "Real", "Integer", "Boolean" or "String"."""
        return [v for v in self.by_name.values() if v.causality == causality and v.kind == kind]

    def numbers(self, causality: str) -> list[str]:
        """Returns the names of the variables of a causality that are numbers."""
        return [v.name for v in self.by_name.values() if v.causality == causality and v.kind != "String"]

    def variable(self, name: str) -> ScalarVariable:
        """Returns the variable of this name. Raises FmuError, with the nearest spelling, if there is none."""
        if name not in self.by_name:
            raise UnknownName(f"{name}: the FMU has no such variable{self.hint(str(name))}")
        return self.by_name[name]

    def hint(self, name: str, choices: Collection[str] | None = None) -> str:
        """Returns the hint for a name that does not exist: what the scene needs for it, else the nearest of the choices, by default of
        all names."""
        return hint_for(name, self.by_name, choices, own=self.lattice is not None)

    def block(self, names: Sequence[str]) -> Block:
        """Returns a block of the named variables. Raises FmuError, with the nearest spelling, for an unknown name."""
        return self.block_of([self.variable(name) for name in names])

    def block_of(self, variables: Sequence[ScalarVariable]) -> Block:
        """Returns a block of variables of this component."""
        return Block(self.calls, variables)

    def set_start_values(self, values: Mapping[str, Any]) -> None:
        """Sets variables by name. A value is a number, or a name if the variable's values have names."""
        for name, value in values.items():
            variable = self.variable(name)
            self.block_of([variable]).set([number_of(variable, value)])

    def initialize(self, start_values: Mapping[str, Any], *, start_time: float = 0.0) -> None:
        """Sets start values (by name) and enters initialization mode. start_time: [s]."""
        self.set_start_values(start_values)
        self.set_up(start_time=start_time)

    def close(self) -> None:
        """Frees the states, the instance and the unpacked files. A closed component answers every call with FmuError."""
        super().close()
        self._unpacked.cleanup()
