"""Films of a run, drawn as softffd draws pictures: GIF through Pillow, MP4 through ffmpeg if ffmpeg is on the PATH."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from softffd.errors import SoftffdError
from softffd.export.take import Take
from softffd.show.panel import Panels
from softffd.show.touch import touch_of

SHORTEST, LONGEST = 2.0, 20.0
"""Least and largest duration of a film [s]; a run that takes less or more is shown slower or faster"""
SIZES = {".gif": (640, 420, 20), ".mp4": (960, 640, 30)}
"""By ending: width and height in pixels, pictures per second"""
INK = (27, 36, 48)


def write(take: Take, path: Path) -> None:
    """Writes the film in the format that the path's ending names."""
    (_write_gif if path.suffix.lower() == ".gif" else _write_mp4)(take, path)


def _write_gif(take: Take, path: Path) -> None:
    rate = SIZES[".gif"][2]
    first, *others = (image.quantize(dither=Image.Dither.NONE) for image in _images(take, *SIZES[".gif"]))
    first.save(path, "GIF", save_all=True, append_images=others, duration=1000 // rate, loop=0)


def _write_mp4(take: Take, path: Path) -> None:
    width, height, rate = SIZES[".mp4"]
    program = shutil.which("ffmpeg")
    if program is None:
        raise SoftffdError("export to mp4 needs the program ffmpeg, which is not on the PATH; install it, or take gif, which needs nothing")
    raw = f"-f rawvideo -pix_fmt rgb24 -s {width}x{height} -r {rate} -i -".split()
    made = ["-an", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
    command = [program, "-v", "error", "-y", *raw, *made, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        assert running.stdin and running.stderr
        try:
            for image in _images(take, width, height, rate):
                running.stdin.write(image.tobytes())
            running.stdin.close()
        except BrokenPipeError:
            pass  # ffmpeg has ended, and reports why on stderr
        except BaseException:
            running.kill()
            raise
        said = running.stderr.read().decode(errors="replace").strip()
    if running.returncode or not path.is_file():
        raise SoftffdError(f"ffmpeg made no film: {said[-300:] or f'it ended with status {running.returncode}'}")


def _images(take: Take, width: int, height: int, rate: int) -> Iterator[Image.Image]:
    """Yields the pictures in the order of time, each of the row that is nearest to the picture's time."""
    span = float(take.time[-1] - take.time[0])
    lasts = min(max(span, SHORTEST), LONGEST)
    if span > 0 and lasts != span:
        take.say(f"{max(lasts / span, span / lasts):.3g} times {'slower' if lasts > span else 'faster'} than real time: {lasts:g} s")
    moments = np.linspace(take.time[0], take.time[-1], round(lasts * rate) + 1)
    nearest = np.searchsorted((take.time[1:] + take.time[:-1]) / 2, moments)
    stage, rows = take.stage, take.rows[np.unique(nearest)].tolist()
    lattice = stage.is_cage if take.shows_lattice is None else take.shows_lattice
    panels = Panels(stage, rows, width, height, touch=touch_of(take.result, stage), lattice=lattice)
    shown, image = -1, Image.new("RGB", (width, height))
    for number, each in enumerate(nearest.tolist()):
        take.note(f"picture {number + 1} of {len(nearest)}")
        if each != shown:
            shown, image = each, _image(take, panels, each)
        yield image


def _image(take: Take, panels: Panels, number: int) -> Image.Image:
    image = Image.fromarray((255 * panels.image(int(take.rows[number])) + 0.5).astype(np.uint8))
    size = image.height / 24
    digits = max(0, 3 - int(np.ceil(np.log10(np.ptp(take.time) or 1.0))))
    words = f"t = {take.time[number]:.{digits}f} s"
    ImageDraw.Draw(image).text((size / 2, size / 2), words, INK, font=ImageFont.load_default(size))
    return image
