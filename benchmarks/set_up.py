"""Processor time that a fresh clone needs until it runs, beside that of an earlier commit.

    python3 benchmarks/set_up.py COMMIT [--suite]

The program clones the folder's last commit and COMMIT, and runs `python3 python/run.py info press` in both, one after the other, without
ccache; with --suite also `python3 python/run.py test`. It prints a line for each: processor time of all processes, and elapsed time.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SET_UP, SUITE = ("info", "press"), ("test", "-q")


def main() -> int:
    """Measures both commits and prints the ratio."""
    parser = argparse.ArgumentParser(prog="set_up.py", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("commit", help="The commit to compare with.")
    parser.add_argument("--suite", action="store_true", help="Run the tests too.")
    options = parser.parse_args()
    print(f"{'':34}{'processor':>12}{'elapsed':>10}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        clones = {commit: clone(commit, Path(folder) / name) for commit, name in ((options.commit, "before"), ("HEAD", "now"))}
        for command in (SET_UP, SUITE)[: 1 + options.suite]:
            taken = {}
            for commit, place in clones.items():
                taken[commit], elapsed = measured(place, command)
                print(f"{commit:12.12}{'run.py ' + ' '.join(command):22}{taken[commit]:10.0f} s{elapsed:8.0f} s", flush=True)
            print(f"{'':12}{'ratio':22}{taken['HEAD'] / taken[options.commit]:10.2f}", flush=True)
    return 0


def clone(commit: str, place: Path) -> Path:
    """Clones the sources of a commit to a folder and returns the folder."""
    subprocess.run(["git", "clone", "-q", ROOT, place], check=True)
    subprocess.run(["git", "-C", place, "checkout", "-q", "--detach", "origin/HEAD" if commit == "HEAD" else commit], check=True)
    return place


def measured(place: Path, command: tuple[str, ...]) -> tuple[float, float]:
    """Returns processor and elapsed time [s] of a command of run.py, whose output goes to a file. Ends the program if the command fails."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    log = place.with_suffix(f".{command[0]}.log")
    with log.open("w") as stream:
        environment = os.environ | {"CCACHE_DISABLE": "1"}
        status = subprocess.call(["python3", "python/run.py", *command], cwd=place, env=environment, stdout=stream, stderr=stream)
    if status:
        sys.exit(f"set_up.py: {' '.join(command)} failed in {place.name}:\n{log.read_text()[-2000:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, time.monotonic() - begin


if __name__ == "__main__":
    sys.exit(main())
