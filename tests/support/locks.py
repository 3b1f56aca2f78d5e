"""What the processes of a parallel run make one after the other, so that the first makes it and the others find it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: tests run in one process there
    fcntl = None


@contextmanager
def one_at_a_time(folder: Path) -> Iterator[None]:
    """Makes the folder and holds its lock, a file beside it, which ends with the process that holds it."""
    folder.mkdir(parents=True, exist_ok=True)
    with folder.with_name(f"{folder.name}.lock").open("w") as lock:
        if fcntl:
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield
