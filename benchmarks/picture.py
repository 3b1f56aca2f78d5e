"""A picture of the cost of the parts of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rows_parts import ALONE, GROUP

from softffd.show.figure import INK, SOFT, new_figure


def draw(document: Mapping[str, Any], path: Path) -> None:
    """Draws a bar for each part. The length is the ratio to the bare scene with the widest instruction set."""
    rows = [row for row in document["rows"] if row["group"] == GROUP and row["against"] == ALONE]
    results = [next(iter(row["results"].values())) for row in rows][::-1]
    ratios = [result["ratio"]["median"] for result in results]
    words = [f"{ratio:.2f}  ({result['own']['median'] * 1e6:.1f} us)" for ratio, result in zip(ratios, results, strict=True)]
    figure = new_figure(8.5, 0.34 * len(rows) + 1.0, dpi=130)
    axes = figure.add_axes((0.38, 0.12, 0.56, 0.74))
    axes.bar_label(axes.barh([row["name"] for row in rows][::-1], ratios, color="#0072b2", height=0.6), words, padding=4, color=INK)
    axes.axvline(1.0, color=SOFT, linewidth=1, linestyle=":")
    axes.set_xlim(0, 1.25 * max(ratios))
    axes.set_xlabel("time per internal step, in those of the bare scene", color=SOFT)
    title = "What a scene uses is what it pays for: 4 x 4 x 4 control points, one core"
    axes.set_title(title, loc="left", x=-0.66, color=INK, weight="bold")
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(left=False)
    figure.savefig(path, dpi=figure.dpi)
    print(f"picture in {path}")
