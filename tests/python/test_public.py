"""The package as it is imported: what it shows, what it loads, and where old names lead."""

import subprocess
import sys
from pathlib import Path

import pytest

import softffd

PUBLIC = [
    *("Fit", "FmuError", "MeshError", "Result", "Scene", "SceneError", "Simulation", "SoftffdError", "Sweep"),
    *("deform", "fit", "load_mesh", "load_scene", "package_fmu", "replay", "save_mesh", "simulate", "sweep", "write_ssp"),
]


def loaded_after(program: str, folder: Path | None = None) -> set[str]:
    """The packages that a new interpreter has loaded after a program, which runs in the folder."""
    program = f"{program}\nimport sys; print(*{{name.partition('.')[0] for name in sys.modules}})"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=folder)
    return set(done.stdout.split())


def test_dir_shows_the_public_interface_and_nothing_else_and_all_of_it_can_be_called():
    assert dir(softffd) == sorted([*PUBLIC, "__version__"])
    assert [name for name in PUBLIC if not callable(getattr(softffd, name))] == []


def test_no_module_of_the_package_hides_behind_a_public_name():
    program = (
        "import pkgutil, softffd\n"
        f"assert not {{module.name for module in pkgutil.iter_modules(softffd.__path__)}} & set({PUBLIC})\n"
        "import softffd.run.simulate, softffd.embedding.deform\n"
        "assert softffd.simulate.__name__ == 'simulate' and not hasattr(softffd.deform, '__path__')\n"
        "assert callable(softffd.simulate) and callable(softffd.deform)"
    )
    assert "softffd" in loaded_after(program)


def test_a_name_that_is_not_there_is_answered_with_the_nearest_one():
    with pytest.raises(AttributeError, match='did you mean "simulate"'):
        _ = softffd.simulat
    assert not hasattr(softffd, "nobody")


HEAVY = {"numpy", "fmpy", "pydantic", "PIL", "matplotlib", "trimesh", "scipy", "pythonfmu", "http", "webbrowser"}


@pytest.mark.parametrize(
    "program, wanted",
    [
        ("import softffd; dir(softffd); softffd.__version__; softffd.FmuError", set()),
        ("import softffd; softffd.load_scene('press')", {"numpy", "pydantic"}),
        ("import softffd; softffd.deform, softffd.load_mesh", {"numpy"}),
        ("import softffd; softffd.simulate, softffd.Simulation, softffd.Result", {"numpy", "fmpy"}),
        ("import softffd; softffd.simulate, softffd.sweep, softffd.Simulation, softffd.package_fmu", {"numpy", "fmpy", "pydantic"}),
    ],
)
def test_packages_are_loaded_when_they_are_needed(program, wanted):
    assert loaded_after(program) & HEAVY <= wanted


@pytest.mark.parametrize(
    "command, wanted",
    [
        ("--help", set()),
        ("new box.toml", {"numpy"}),
        ("info press", {"numpy", "pydantic"}),
        ("build press", {"numpy", "pydantic"}),
        ("run press --no-pictures --stop-time 0.01", {"numpy", "pydantic", "fmpy"}),
    ],
)
def test_commands_load_no_package_that_they_do_without(command, wanted, tmp_path):
    program = (
        f"import sys; sys.argv = ['softffd', *{command!r}.split()]\nfrom softffd.cli.command import main\ntry: main()\nexcept SystemExit: 0"
    )
    assert loaded_after(program, tmp_path) & HEAVY == wanted


def test_the_package_says_that_it_is_typed():
    from importlib.resources import files

    assert files("softffd").joinpath("py.typed").is_file()
