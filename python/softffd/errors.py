"""The errors that a user sees: each one's text is a clear paragraph, printed without a traceback."""

from typing import Any


class SoftffdError(Exception):
    """Base of every error that comes from the user's input or surroundings rather than from a fault of the program."""


class SceneError(SoftffdError):
    """A scene file that cannot be used; `problems` lists every fault found, each with its path in the file."""

    def __init__(self, where: str, problems: list[str]):
        self.where, self.problems = where, problems
        super().__init__("\n".join([f"{where}: {len(problems)} problem{'s' * (len(problems) > 1)}", *(f"  {p}" for p in problems)]))

    def __reduce__(self) -> tuple[type["SceneError"], tuple[str, list[str]]]:
        return type(self), (self.where, self.problems)  # so that the error comes whole from another process


class MeshError(SoftffdError):
    """A mesh file that cannot be read or does not fit its use."""


class FmuError(SoftffdError):
    """An FMU, one of its variables or one of its steps that cannot be used as asked."""


class Interrupted(KeyboardInterrupt):
    """An interrupt (Ctrl-C) of work that is done in part. `result` is the part that is done; for a run, the Result up to the interrupt."""

    def __init__(self, result: Any):
        self.result = result
        super().__init__()


class UnknownName(FmuError, KeyError):
    """A name that does not exist. The error is also a KeyError, as mappings require it."""

    __str__ = Exception.__str__
