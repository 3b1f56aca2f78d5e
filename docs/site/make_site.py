"""The documentation as a site in build/docs/site: python3 python/run.py docs.

The documents stand in the site as they stand in the repository, so that their links hold there and here. Beside them come pages that are
made: the gallery from runs of the shipped scenes, the notebook with what it shows, the Python reference from the docstrings. Links and
anchors that lead nowhere end the build.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from nbconvert import MarkdownExporter
from nbconvert.preprocessors import ExecutePreprocessor

import softffd
from softffd.cli.keep import keep_run, run_scene_or_fmu

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PAGES = ROOT / "build" / "docs" / "pages"
COPIED = ("README.md", "CHANGELOG.md", "docs/*.md", "docs/pictures/*.png", "docs/tutorials/*.md", "examples/**/*", "fmu_src/*/README.md")
SHOWN = (
    *("car_drop", "car_bump", "car_ball", "press", "hanging", "incline", "stiff_bounce", "spin", "pad", "flat_pad", "beam", "bumper"),
    *("bumper_mass", "drop_weight", "isolator"),
)
"""Shipped scenes that are worth a look and take seconds"""
GALLERY = """# Gallery

Shipped scenes as `softffd run NAME` draws them; a click on a picture opens the page to turn and play.

<div class="gallery" markdown>

{}

</div>
"""
CARD = """<div markdown>
[![{title}](gallery/{name}/picture.png)](gallery/{name}/view.html)
**{title}**, `softffd run {name}`
</div>"""
API = """# Python

`import softffd` has these names; each is loaded when it is first used.
"""
BRIDGES = """
## Bridges

Soft bodies in the loops of physics engines; these names come from the modules that they are shown with.
"""
BRIDGED = (
    "softffd.bridges.mujoco.couple",
    "softffd.bridges.coupled.Bridge",
    "softffd.bridges.coupled.Part",
    "softffd.bridges.coupled.Engine",
)


def main() -> int:
    shutil.rmtree(PAGES, ignore_errors=True)
    for pattern in COPIED:
        for file in sorted(filter(Path.is_file, ROOT.glob(pattern))):
            copy(file, PAGES / file.relative_to(ROOT))
    shutil.copy(HERE / "site.css", PAGES)
    (PAGES / "gallery.md").write_text(GALLERY.format("\n\n".join(map(card, SHOWN))))
    for notebook in PAGES.glob("examples/*.ipynb"):
        run_notebook(notebook)
    places = [f"{getattr(softffd, name).__module__}.{name}" for name in softffd.__all__]
    (PAGES / "api.md").write_text("".join([API, *map(reference, places), BRIDGES, *map(reference, BRIDGED)]))
    build = [sys.executable, "-m", "mkdocs", "build", "-f", HERE / "mkdocs.yml"]
    done = subprocess.run(build, env=os.environ | {"NO_MKDOCS_2_WARNING": "1"}, stderr=subprocess.PIPE, text=True)
    print(done.stderr if done.returncode else PAGES.with_name("site") / "index.html", file=sys.stderr if done.returncode else sys.stdout)
    return done.returncode


def copy(file: Path, place: Path) -> None:
    """A document without what the tests read beside the language of a block: `sh full`, `toml ring.toml`."""
    place.parent.mkdir(parents=True, exist_ok=True)
    if file.suffix == ".md":
        place.write_text(re.sub(r"^(```\w+) .*$", r"\1", file.read_text(), flags=re.MULTILINE))
    else:
        shutil.copy(file, place)


def card(name: str) -> str:
    """Runs a scene into the gallery."""
    folder = PAGES / "gallery" / name
    result = run_scene_or_fmu(name)
    keep_run(result, folder)
    for file in folder.iterdir():
        if file.name not in ("picture.png", "view.html"):
            file.unlink()
    return CARD.format(name=name, title=result.title)


def run_notebook(file: Path) -> None:
    """A page of the notebook with what its cells show."""
    text, more = MarkdownExporter(preprocessors=[ExecutePreprocessor(timeout=300, extra_arguments=["--log-level=ERROR"])]).from_filename(
        str(file), resources={"unique_key": file.stem, "output_files_dir": f"{file.stem}_files"}
    )
    file.with_suffix(".md").write_text(text)
    for name, content in more["outputs"].items():
        (file.parent / name).parent.mkdir(exist_ok=True)
        (file.parent / name).write_bytes(content)


def reference(place: str) -> str:
    """The entry of a public name."""
    return f"\n::: {place}\n    options:\n      heading: {place if place in BRIDGED else place.rpartition('.')[2]}\n"


if __name__ == "__main__":
    sys.exit(main())
