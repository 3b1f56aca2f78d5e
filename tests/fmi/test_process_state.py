"""The host's floating-point environment and locale: they change no result, and no call changes them."""

import os
import re
import struct
import subprocess
import sys
from ctypes import CDLL, create_string_buffer

import pytest

from c_host import STEP, STEPS, TIMES, Host
from straight_run import apply, straight

LINUX = sys.platform == "linux"


class Environment:
    """glibc's floating-point environment on x86-64: control words that can be looked at and changed."""

    def __init__(self):
        self.libm = CDLL("libm.so.6")

    def words(self) -> tuple[int, int]:
        """x87 control word and MXCSR without its flags of past exceptions."""
        buffer = create_string_buffer(32)
        self.libm.fegetenv(buffer)
        return struct.unpack_from("<H", buffer.raw, 0)[0], struct.unpack_from("<I", buffer.raw, 28)[0] & ~0x3F

    def raw(self):
        buffer = create_string_buffer(32)
        self.libm.fegetenv(buffer)
        return buffer

    def change(self, mxcsr_bits: int, rounding: int, traps: int) -> None:
        self.libm.fesetround(rounding)
        buffer = self.raw()
        struct.pack_into("<I", buffer, 28, struct.unpack_from("<I", buffer.raw, 28)[0] | mxcsr_bits)
        self.libm.fesetenv(buffer)
        if traps:
            self.libm.feenableexcept(traps)


@pytest.mark.skipif(not LINUX or os.uname().machine != "x86_64", reason="control words of x86-64 with glibc")
@pytest.mark.parametrize(
    "mxcsr, rounding, traps",
    [(0, 0x400, 0), (0, 0x800, 0), (0, 0xC00, 0), (0x8000, 0, 0), (0x8040, 0, 0), (0, 0, 0x1D), (0x8040, 0xC00, 0x0D)],
    ids=["down", "up", "to zero", "flush to zero", "denormals are zero too", "traps", "all of it"],
)
def test_the_hosts_floating_point_environment_neither_matters_nor_changes(fmus, mxcsr, rounding, traps):
    environment = Environment()
    for fmu in fmus:
        expected, collected, seen = straight(fmu), [], []
        own = environment.raw()
        environment.change(mxcsr, rounding, traps)
        try:
            wanted = environment.words()
            host = Host(fmu, logging=True)
            host.begin()
            collected.append(host.outputs())
            for n in range(STEPS):
                apply(host, n)
                host.must("DoStep", TIMES[n], STEP, 1)
                seen.append(environment.words())
                collected.append(host.outputs())
            host.must("SetFMUstate", host.received(host.serialized(host.save())))
            host("DoStep", 99.0, STEP, 1)
            host.must("Reset")
            host.free()
            seen.append(environment.words())
        finally:
            environment.libm.fesetenv(own)
        assert wanted != (0x37F, 0x1F80) and set(seen) == {wanted}
        assert collected == expected


LOCALE_SCRIPT = """
import locale, sys
from pathlib import Path
import c_host as c
import straight_run as t
fmu = c.Fmu(t.RICH, Path(sys.argv[1]))
expected = t.straight(fmu)
locale.setlocale(locale.LC_ALL, sys.argv[2])
point = locale.localeconv()["decimal_point"]
assert point != ".", point
assert t.straight(fmu) == expected
host = c.Host(fmu)
host.begin()
assert host("DoStep", 0.125, 0.01, 1) == c.ERROR
sys.stdout.buffer.write(host.messages[0][4] + b"\\n")
assert locale.localeconv()["decimal_point"] == point
"""


@pytest.mark.skipif(not LINUX, reason="localedef of glibc")
@pytest.mark.short("ps_AF")
@pytest.mark.parametrize("name", ["de_DE", "ps_AF"])
def test_the_hosts_locale_neither_matters_nor_changes(tmp_path, name):
    """A comma and a decimal point of two bytes."""
    target = tmp_path / f"{name}.UTF-8"
    try:
        done = subprocess.run(["localedef", "-i", name, "-f", "UTF-8", str(target)], capture_output=True)
    except FileNotFoundError:
        pytest.skip("no localedef")
    if not target.is_dir():
        pytest.skip(f"localedef has no {name}: {done.stderr.decode(errors='replace')[:200]}")
    arguments = [sys.executable, "-c", LOCALE_SCRIPT, str(tmp_path / "fmu"), f"{name}.UTF-8"]
    environment = os.environ | {"LOCPATH": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(arguments, capture_output=True, env=environment)
    if b"unsupported locale setting" in done.stderr:
        pytest.skip(f"localedef could not make {name} here: the sources of locales are not on this machine")
    assert done.returncode == 0, done.stderr.decode()
    text = done.stdout.decode("utf-8").strip()
    assert re.search(r"wanted 0 s, got 0\.125, 0\.125 s off$", text), text
