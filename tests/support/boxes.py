"""A scene given as text, as an FMU."""

from pathlib import Path

from softffd import load_scene, package_fmu


def box_fmu(text: str, folder: Path) -> Path:
    """Writes box.toml and box.fmu to the folder."""
    (folder / "box.toml").write_text(text)
    return package_fmu(load_scene(folder / "box.toml"), folder / "box.fmu")
