"""Frequencies of beams and strips clamped at one end, with Timoshenko's beam as a reference."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.polynomial import legendre

from validation.published.cases import Body, Row
from validation.published.runs import WALL, Course, Size, drag, scene_of, shares, slowest_bending

CLAMPED = {"first": 1.87510406871, "second": 4.69409113297, "third": 7.85475743824}
"""Wave number times length of the modes of a clamped Euler-Bernoulli beam"""
SILICONE: Size = (0.2, 0.02, 0.02)
"""Size of the silicone beam [m], which has 1 MPa and 1100 kg/m3"""
AMPLITUDE = 1e-3
"""Amplitude of the free end divided by the length"""
PERIODS, LOOKS = 10, 50
"""Number of periods over which a mode is sampled, and samples per period"""


def clamped_beam(body: Body) -> Iterator[Row]:
    references = timoshenko(SILICONE, 1e6, 1100.0, body.ratio)
    for name, reference in zip(CLAMPED, references, strict=False):
        found, spent = mode_frequency(body, SILICONE, 1e6, 1100.0, name)
        yield Row(body, f"{name} frequency [Hz]", float(reference), found, *spent)


def wide_strip(body: Body) -> Iterator[Row]:
    """Computes the period of a strip whose width gives its cells equal sides in length and width."""
    modulus, density, length = 2e6, 1000.0, 0.2
    size = (length, length * (body.points[1] - 1) / (body.points[0] - 1), 0.02)
    found, spent = mode_frequency(body, size, modulus, density, "first")
    reference = slowest_bending(size, modulus / (1 - body.ratio**2), density) / (2 * math.pi)
    yield Row(body, f"period [s], width {size[1]:g} m", 1 / reference, 1 / found, *spent)


def mode_frequency(body: Body, size: Size, modulus: float, density: float, name: str) -> tuple[float, tuple[int, float]]:
    """Returns the frequency [Hz] of a mode and the steps and time [s] spent. The beam is released from rest under forces of that shape."""
    wave, slowest = CLAMPED[name], slowest_bending(size, modulus, density)
    turning = slowest * (wave / CLAMPED["first"]) ** 2  # rad/s, approximate frequency of the mode
    scene = scene_of(
        body, size, modulus, density, material=drag(body, size, density, 2 * slowest), pin=[WALL], inputs={"forces": "all"},
        solver={"method": "leapfrog", "tolerance": 1e-6},
    )  # fmt: skip
    along, *across = (shares(n, scene.is_solid) for n in body.points)
    shape = along * mode_shape(wave, np.linspace(0.0, 1.0, body.points[0]))
    force = AMPLITUDE / 2 * size[0] * turning**2 * density * math.prod(size)
    with Course(scene) as course:
        start = course.sim.positions[..., 2]

        def of_mode() -> float:
            return float(np.einsum("i,j,k,ijk", shape, *across, course.sim.positions[..., 2] - start))

        course.sim.forces = force * np.einsum("i,j,k,c->ijkc", shape, *across, [0.0, 0.0, 1.0])
        course.rest(of_mode, 1 / slowest)
        course.sim.forces = np.zeros((*body.points, 3))
        course.sim["damping"] = 0.0
        step, values = 2 * math.pi / turning / LOOKS, [of_mode()]
        for _ in range(LOOKS * PERIODS):
            course.step(step)
            values.append(of_mode())
        return fine_frequency(np.array(values), step), (course.steps, course.seconds)


def mode_shape(wave: float, x: np.ndarray) -> np.ndarray:
    """Returns the mode shape of a clamped Euler-Bernoulli beam at places x from 0 to 1. The shape is 2 or -2 at 1."""
    ratio = (math.cosh(wave) + math.cos(wave)) / (math.sinh(wave) + math.sin(wave))
    found: np.ndarray = np.cosh(wave * x) - np.cos(wave * x) - ratio * (np.sinh(wave * x) - np.sin(wave * x))
    return found


def frequency(values: np.ndarray, step: float) -> float:
    """Returns the frequency [Hz] of a vibration sampled every `step` [s], from its first and last zero crossing."""
    before = np.flatnonzero(values[:-1] * values[1:] < 0)
    times = step * (before + values[before] / (values[before] - values[before + 1]))
    return float((len(times) - 1) / 2 / (times[-1] - times[0]))


def fine_frequency(values: np.ndarray, step: float) -> float:
    """Returns the frequency [Hz] refined by the phase between two halves of the values. Windows suppress small parts of other modes."""
    coarse, half = frequency(values, step), len(values) // 2
    window = np.hanning(half) * np.exp(-2j * math.pi * coarse * step * np.arange(half))
    phases = np.angle([window @ values[:half], window @ values[half : 2 * half]])
    between = math.remainder(phases[1] - phases[0] - 2 * math.pi * coarse * step * half, 2 * math.pi)
    return coarse + between / (2 * math.pi * half * step)


def timoshenko(size: Size, modulus: float, density: float, ratio: float, terms: int = 14) -> np.ndarray:
    """Returns the frequencies [Hz], lowest first, of a Timoshenko beam along x, clamped at one end and bent along z. Deflection and
    rotation are polynomials of `terms` terms, which gives the lowest three frequencies to 8 digits. The shear factor is Cowper's,
    10 (1 + nu) / (12 + 11 nu)."""
    length, width, height = size
    area, inertia = width * height, width * height**3 / 12
    shear = modulus / 2 / (1 + ratio) * area * 10 * (1 + ratio) / (12 + 11 * ratio)
    places, weights = legendre.leggauss(2 * terms)
    x, weights = (places + 1) / 2, weights * length / 2
    polynomials = legendre.legvander(places, terms - 1)
    values = x[:, None] * polynomials
    slopes = (polynomials + 2 * x[:, None] * legendre.legval(places, legendre.legder(np.eye(terms))).T) / length
    none = np.zeros_like(values)

    def form(rows: np.ndarray, factor: float) -> np.ndarray:
        product: np.ndarray = factor * rows.T @ (weights[:, None] * rows)
        return product

    bending, shearing = np.hstack([none, slopes]), np.hstack([slopes, -values])
    stiffness = form(bending, modulus * inertia) + form(shearing, shear)
    mass = form(np.hstack([values, none]), density * area) + form(np.hstack([none, values]), density * inertia)
    found: np.ndarray = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)) / (2 * math.pi)
    return found
