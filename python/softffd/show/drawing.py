"""Drawing of sheets in a process beside, which loads the library for it while the run is under way.

The library takes as long to load as a picture to draw, and a run of a small scene no longer than either. A sheet goes to the process as a
file, its images, which are made here meanwhile, as another, and its picture comes back as one.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
from collections.abc import Callable
from contextlib import contextmanager, suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from softffd.files import write_bytes

if TYPE_CHECKING:
    from softffd.show.sheet import Sheet

Draw = Callable[["Sheet", Path], None]
"""Draws a sheet to a path (PNG)."""

LIBRARY = "softffd.show.figure"
"""The module that loads it."""


@contextmanager
def drawing():
    """A function that draws a Sheet to a path (PNG), where it is at the latest when the block ends; an interrupt leaves no file.

    It draws in this process where the library is loaded already, or there is one processor, or the one beside fails.
    """
    if LIBRARY in sys.modules or os.cpu_count() == 1 or not sys.executable:
        yield _draw
        return
    with TemporaryDirectory(prefix="softffd-") as name, _process(Path(name)) as process:
        given = []

        def hand_over(part, path):
            path.write_bytes(pickle.dumps(part))
            with suppress(OSError):  # it has ended: what it leaves undone is drawn below
                process.stdin.write(f"{path}\n".encode())

        def draw(sheet, path):
            drawn = Path(name) / f"{len(given)}.png"
            hand_over(replace(sheet, images=tuple), drawn.with_suffix(".sheet"))
            images = sheet.images()
            hand_over(images, drawn.with_suffix(".images"))
            given.append((replace(sheet, images=lambda: images), path, drawn))

        yield draw
        for sheet, path, drawn in given:
            if process.stdout.readline():
                write_bytes(path, drawn.read_bytes())
            else:
                _draw(sheet, path)


@contextmanager
def _process(folder):
    """Runs `_serve`; what goes wrong there is said to nobody, for it is done again where it is heard."""
    with Popen([sys.executable, "-P", "-m", __name__], bufsize=0, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, cwd=folder) as process:
        try:
            yield process
        finally:
            process.kill()


def _draw(sheet, path):
    from softffd.show.figure import figure_of, save_figure

    save_figure(figure_of(sheet), path)


def _serve():
    """Draws the sheets that the lines of the standard input name, with the images that the line after each names, and says a line then."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends this process
    figure = import_module(LIBRARY)  # before it is needed

    def handed_over(line):
        path = Path(line.rstrip("\n"))
        return path, pickle.loads(path.read_bytes())

    for line in sys.stdin:
        path, sheet = handed_over(line)
        begun = figure.drawn(sheet)
        _, images = handed_over(sys.stdin.readline())
        path.with_suffix(".png").write_bytes(figure.finished(begun, images))
        print("drawn", flush=True)


if __name__ == "__main__":
    _serve()
