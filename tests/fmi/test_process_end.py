"""A process that ran Python FMUs ends as it should, whoever was the host.

The library of pythonfmu 0.7 counts down in freed memory when the process ends (softffd/drivers/softffd_pythonfmu.py, which makes it good).
Left to chance it is seen once in many runs; here the heap is laid out so that it is seen nearly always, and looked through last of all.
"""

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import fmpy
import pytest

from softffd import load_scene

pytest.importorskip("pythonfmu", reason="the driver FMUs are made with pythonfmu")
from softffd.drivers import build_drivers
from validation.twin import build_twin

COMPILER = shutil.which("cc")
pytestmark = pytest.mark.skipif(sys.platform != "linux" or not COMPILER, reason="wants Linux and a C compiler named cc")
NAMES = {"plate": "Plate", "actuator": "Actuator", "twin": "softffd_twin"}

LAST = """
#include <stdlib.h>
__attribute__((destructor)) static void walk(void) {
  for (int i = 0; i < 200; ++i) *(volatile char*)malloc(130) = 1;
  *(volatile char*)malloc(100000) = 1;
}
"""
PYTHON_HOST = """
import ctypes, sys
import fmpy
libc = ctypes.CDLL(None)
libc.malloc.restype, libc.free.argtypes = ctypes.c_void_p, [ctypes.c_void_p]
blocks = [libc.malloc(136) for _ in range(4000)]
for block in blocks[::2]:  # holes between blocks that stay: what is freed there is not joined with its neighbours
    libc.free(block)
for _ in range(3):
    fmpy.simulate_fmu(sys.argv[1], stop_time=0.02)
ctypes.CDLL(sys.argv[2])  # loaded last, destroyed last
print("done", flush=True)
"""
C_HOST = """
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static void note(void* e, const char* name, int status, const char* category, const char* message, ...) { puts(message); }
int main(int count, char** given) {  /* unpacked FMU, model identifier, ...; the last says whether instances are freed */
  const int frees = !strcmp(given[count - 1], "free");
  for (int i = 1; i + 1 < count; i += 2) {
    char resources[1000], path[1000];
    snprintf(resources, sizeof resources, "file://%s/resources", given[i]);
    snprintf(path, sizeof path, "%s/binaries/linux64/%s.so", given[i], given[i + 1]);
    void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) return puts(dlerror()), 1;
    void* (*instantiate)(const char*, int, const char*, const char*, const void*, int, int) = dlsym(library, "fmi2Instantiate");
    void (*release)(void*) = dlsym(library, "fmi2FreeInstance");
    const void* callbacks[] = {note, calloc, free, 0, 0};
    for (int n = 0; n < 5; ++n) {
      void* instance = instantiate("x", 1, "g", resources, callbacks, 0, 0);
      if (!instance) return 2;
      if (frees) release(instance);
    }
    if (frees) dlclose(library);
  }
  puts("done");
  return 0;
}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("ends")
    build_drivers(folder)
    build_twin(load_scene("free_vibration"), folder / "twin.fmu")
    return folder


def compiled(folder: Path, text: str, *options: str) -> Path:
    source = folder / "source.c"
    source.write_text(text)
    subprocess.run([COMPILER, "-O0", "-o", folder / "made", source, *options], check=True)
    return folder / "made"


@pytest.mark.short("plate-0")
@pytest.mark.parametrize("kept", [0, 7])
@pytest.mark.parametrize("name", NAMES)
def test_a_host_in_python_ends_cleanly(folder, tmp_path, name, kept):
    """`kept`: freed blocks of a size that the C library keeps aside; the others join the list that is looked through."""
    last = compiled(tmp_path, LAST, "-shared", "-fPIC")
    environment = os.environ | {"GLIBC_TUNABLES": f"glibc.malloc.tcache_count={kept}"}
    for _ in range(3):
        command = [sys.executable, "-c", PYTHON_HOST, folder / f"{name}.fmu", last]
        done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120)
        assert (done.returncode, done.stdout) == (0, "done\n"), done.stderr


@pytest.mark.short("free")
@pytest.mark.parametrize("instances", ["free", "keep"])
def test_a_host_in_c_that_gets_python_from_a_library_ends_cleanly(folder, tmp_path, instances):
    """Without the remedy it aborts where instances are kept, and now and then where they are freed."""
    python = Path(sysconfig.get_config_var("LIBDIR"), sysconfig.get_config_var("LDLIBRARY"))
    if python.suffix == ".a" or not python.is_file():
        pytest.skip("this Python has no shared library")
    host = compiled(tmp_path, C_HOST, "-ldl")
    arguments = []
    for name, identifier in NAMES.items():
        arguments += [fmpy.extract(str(folder / f"{name}.fmu"), unzipdir=str(tmp_path / name)), identifier]
    environment = os.environ | {"LD_PRELOAD": str(python), "PYTHONHOME": sys.base_prefix, "PYTHONPATH": sysconfig.get_path("purelib")}
    for _ in range(3):
        done = subprocess.run([host, *arguments, instances], capture_output=True, text=True, env=environment, timeout=120)
        assert (done.returncode, done.stdout) == (0, "done\n"), done.stderr
