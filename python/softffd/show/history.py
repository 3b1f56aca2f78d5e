"""The numbers of a run that are worth a curve: reactions of planes and pins, energies, and the lattice's height."""

import re

import numpy as np

ENERGIES = ("kinetic", "elastic", "gravity", "dissipated", "work")


def reactions(result):
    """Forces of the object on its obstacles and fixtures: name, as "plane.ground" or "pin.base", -> (T, 3) [N]."""
    names = [m[1] for m in (re.fullmatch(r"((?:plane|pin)\.[^.]+)\.reaction\.x", name) for name in result.outputs) if m]
    return {name: np.stack([result.outputs[f"{name}.reaction.{a}"] for a in "xyz"], axis=1) for name in names}


def energies(result):
    """The recorded energies: "kinetic", "elastic", ... -> (T,) [J]."""
    return {kind: result.outputs[f"energy.{kind}"] for kind in ENERGIES if f"energy.{kind}" in result.outputs}


def heights(result, up):
    """The lattice's highest and lowest place along `up` (3,): words -> (T,) [m]."""
    along = result.positions @ np.asarray(up)
    return {"highest point": along.max(axis=(1, 2, 3)), "lowest point": along.min(axis=(1, 2, 3))}
