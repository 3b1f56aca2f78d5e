"""The result of a fit: parameters with standard errors and correlations, parameters that the data do not show, curves; and its files."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from softffd.files import finite, json_text, table_text, write_text
from softffd.fitting.curve import Curve, draw


@dataclass(frozen=True, eq=False, repr=False)
class Fit:
    """Parameters from measured curves. Printed, it is a table."""

    values: dict[str, float]
    """Fitted values, by the parameters' names"""
    errors: dict[str, float]
    """Standard errors, for independent noise of one size; infinite for parameters that the data do not show"""
    correlations: np.ndarray
    """Correlations (n, n) of the estimates; NaN where there is no standard error"""
    undetermined: tuple[tuple[str, ...], ...]
    """Parameters that these data cannot distinguish, those of each such direction together; a parameter without effect stands alone"""
    deviation: float
    """Standard deviation of the residuals, in the unit of the matched variable"""
    warnings: tuple[str, ...]
    """What a user should know before using the numbers"""
    curves: tuple[Curve, ...]
    """Measured and fitted curve of each test"""
    units: dict[str, str]
    """Units of the parameters, by name"""
    starts: dict[str, float]
    """Start values of the parameters, by name"""
    runs: int
    """Number of runs"""
    noise: float
    """Noise that the solver causes in a run's curve, in the unit of the matched variable"""

    def __repr__(self) -> str:
        width = max(map(len, self.values))
        rows = [
            f"  {name:{width}}  {_with_error(value, self.errors[name])} {self._unit(name)}".rstrip() for name, value in self.values.items()
        ]
        names = list(self.values)
        pairs = [
            f"{names[i]} and {names[j]} {self.correlations[i, j]:.2f}"
            for i in range(len(names))
            for j in range(i)
            if math.isfinite(self.correlations[i, j])
        ]
        curve = self.curves[0]
        spread = f"{self.deviation:.3g} {curve.units[curve.match]}".rstrip()
        residuals = f"  residuals of {curve.match}: standard deviation {spread} over {self.rows} rows"
        tests = f" of {len(self.curves)} tests" if len(self.curves) > 1 else ""
        head = f"Fit of {len(names)} parameter{'s' * (len(names) > 1)} to {curve.match}{tests}, {self.runs} runs; with standard errors:"
        correlated = [f"  correlations: {', '.join(pairs)}"] if pairs else []
        return "\n".join([head, *rows, residuals, *correlated, *(f"  warning: {words}" for words in self.warnings)])

    def _unit(self, name: str) -> str:
        return self.units[name] if self.units[name] != "1" else ""

    @property
    def rows(self) -> int:
        """Number of rows of all data."""
        return sum(len(curve.measured) for curve in self.curves)

    def plot(self, file: str | Path | None = None) -> Any:
        """Returns a matplotlib Figure of data, fit and residuals, a column for each test; written to `file` if given (.png, .svg,
        .pdf)."""
        words = (f"{name} = {_with_error(value, self.errors[name])} {self._unit(name)}".rstrip() for name, value in self.values.items())
        return draw("\n".join(words), self.curves, file)

    def save(self, folder: str | Path) -> list[Path]:
        """Writes fit.json (parameters), fit.csv (data and curves) and fit.png to a folder, each whole or not at all. Returns the
        paths."""
        files = [Path(folder) / name for name in FILES]
        write_text(files[0], json_text(self._as_json()))
        write_text(files[1], self._as_csv())
        self.plot(files[2])
        return files

    def _as_json(self) -> dict[str, Any]:
        parameters = {
            name: {"value": value, "standard_error": self.errors[name], "unit": self.units[name], "start": self.starts[name]}
            for name, value in self.values.items()
        }
        curve = self.curves[0]
        return finite({
            "parameters": parameters, "correlations": self.correlations.tolist(), "undetermined": self.undetermined, "match": curve.match,
            "unit": curve.units[curve.match], "deviation": self.deviation, "rows": self.rows, "runs": self.runs, "warnings": self.warnings,
        })  # fmt: skip

    def _as_csv(self) -> str:
        rows = (
            [n, *(f"{each:.17g}" for each in (at, measured, fitted, measured - fitted))]
            for n, curve in enumerate(self.curves, 1)
            for at, measured, fitted in zip(curve.at, curve.measured, curve.fitted, strict=True)
        )
        return table_text(["test", self.curves[0].against, "measured", "fitted", "residual"], rows)


FILES = ("fit.json", "fit.csv", "fit.png")  # files that Fit.save writes


def _with_error(value: float, error: float) -> str:
    """Returns value and error as text, with the digits that are significant beside the error."""
    if not math.isfinite(error):
        return f"{value:.4g} ± ?"
    digits = 6 if error <= 0 or value == 0 else min(12, max(2, 2 + math.floor(math.log10(abs(value) / error)))) if abs(value) > error else 2
    return f"{value:#.{digits}g} ± {error:.2g}"
