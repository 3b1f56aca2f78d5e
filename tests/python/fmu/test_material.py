"""A material's parameters in the FMU: which there are, what tuning them does, and that the component has the springs of the numpy model."""

import numpy as np
import pytest

from scenes import box
from softffd.errors import SoftffdError
from softffd.fmu.package import package_fmu, scene_masses
from softffd.fmu.records import scene_records
from softffd.fmu.variables import variables
from softffd.run.simulation import Simulation
from validation.mechanics import Body
from validation.resolved import resolved
from validation.stability.drive import Drive
from validation.twin import build_twin

SOLID = {"points": [4, 3, 5], "size": [0.3, 0.22, 0.36]}
REGIONS = [{"points": {"k": [0, 2]}, "youngs_modulus": 8e5}, {"points": {"i": [0, 1], "j": [0, 1]}, "youngs_modulus": 3e4}]
STRETCHED = {"stretch": [1.1, 0.95, 1.02]}


def solid(*, material=None, **keys):
    return box(lattice=SOLID, material={"youngs_modulus": 2e5, **(material or {})}, mass={"density": 1100.0}, **keys)


def parameters(scene):
    families = [variable.family for variable in variables(scene, scene_masses(scene).mass)]
    return {family["name"]: family.get("unit") for family in families if family.get("material")}


def test_a_modulus_takes_the_place_of_stiffness_and_only_what_is_there_has_a_variable():
    assert parameters(solid()) == {"mass": "kg", "youngs_modulus": "Pa"}
    assert parameters(solid(material={"internal_damping": 1e-3})) == {"mass": "kg", "youngs_modulus": "Pa", "internal_damping": "s"}
    springs = {"mass": "kg", **dict.fromkeys(("stiffness.edge", "stiffness.face", "stiffness.body"), "N/m"), "damping": "N.s/m"}
    assert parameters(box()) == springs
    damped = box(region=[{"points": "z-", "internal_damping": 1e-3}])
    assert parameters(damped) == springs | {"internal_damping": "s"}
    assert parameters(box(region=[{"points": "z-", "internal_damping": 0.0}])) == springs


def test_records_hold_what_the_scene_says_of_its_material_and_no_more():
    scene = solid(material={"internal_damping": 1e-3}, region=[*REGIONS, {"points": "all", "internal_damping": 0.0}])
    lines = [line.split()[:2] for line in scene_records(scene, scene_masses(scene)).splitlines()]
    kept = ("youngs_modulus", "stiffness", "damping", "internal_damping", "region")
    assert [line for line in lines if line[0].startswith(kept)] == [
        *(["youngs_modulus", "200000.0"], ["internal_damping", "0.001"]),
        *(["region_youngs_modulus", "800000.0"], ["region_youngs_modulus", "30000.0"], ["region_internal_damping", "0.0"]),
    ]


@pytest.mark.parametrize("regions", [[], REGIONS], ids=["one modulus", "regions"])
def test_the_components_springs_are_those_of_the_numpy_model(regions):
    document = solid(region=regions, initial=STRETCHED, energy=True)
    with Drive(document) as drive:
        assert drive.simulation.number("energy.elastic") == pytest.approx(drive.body.elastic_energy(drive.x), rel=1e-13)
        v, x = drive.v, drive.x
        drive.simulation.step(1e-7)
        force = drive.mass[:, None] * (drive.v - v) / 1e-7
        assert force == pytest.approx(drive.body.spring_force(x), abs=1e-4 * np.abs(force).max())  # the mean over the step


@pytest.mark.parametrize("method", ["leapfrog", "auto"])
def test_a_modulus_that_is_tuned_acts_from_the_next_step_on_and_regions_keep_theirs(method):
    document = solid(region=REGIONS[:1], initial=STRETCHED, energy=True, method=method)
    with Drive(document) as drive:
        drive.simulation.step(1e-3)
        x = drive.x
        drive.simulation["youngs_modulus"] = 5e5
        assert (drive.x == x).all()
        drive.simulation.step(1e-9)
        changed = Body.of(resolved(document), youngs_modulus=5e5)
        assert drive.simulation.number("energy.elastic") == pytest.approx(changed.elastic_energy(drive.x), rel=1e-9)
        assert changed.elastic_energy(drive.x) > 1.2 * Body.of(resolved(document)).elastic_energy(drive.x)


def test_a_modulus_is_above_zero():
    with Simulation(solid()) as simulation, pytest.raises(Exception, match="youngs_modulus: wanted > 0 Pa, got 0"):
        simulation.initialize()
        simulation["youngs_modulus"] = 0.0


def test_a_state_that_is_restored_keeps_the_modulus_of_its_moment():
    with Simulation(solid(initial=STRETCHED, energy=True)) as simulation:
        simulation.initialize()
        simulation["youngs_modulus"] = 5e5
        simulation.step(1e-3)
        kept, stored = simulation.save(), simulation.number("energy.elastic")
        simulation["youngs_modulus"] = 1e5
        simulation.step(1e-3)
        simulation.restore(kept)
        assert simulation.number("youngs_modulus") == 5e5 and simulation.number("energy.elastic") == stored


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_fmu_of_a_modulus_is_valid(tmp_path, fmi):
    from fmpy.validation import validate_fmu

    scene = solid(material={"internal_damping": 1e-3}, energy=True, outputs={"solver": True})
    assert validate_fmu(str(package_fmu(scene, tmp_path / "solid.fmu", fmi=fmi))) == []


@pytest.mark.parametrize("material", [{"youngs_modulus": 2e5}, {"stiffness": 1e3, "damping": 0.0}], ids=["modulus", "stiffness"])
def test_internal_damping_that_is_tuned_acts_from_the_next_step_on_and_regions_keep_theirs(material):
    region = {"points": {"k": [0, 1]}, "internal_damping": 1e-4}
    document = box(
        lattice=SOLID, material={**material, "internal_damping": 1e-5}, region=[region], initial=STRETCHED, velocities="all", energy=True
    )
    with Drive(document) as drive:
        drive.simulation.step(1e-3)
        drive.simulation["internal_damping"] = 3e-4
        lost, x, v, h = drive.simulation.number("energy.dissipated"), drive.x, drive.v, 1e-6
        drive.simulation.step(h)
        body = Body.of(resolved(document), internal_damping=3e-4)
        power = -((body.dashpot_force(x, v) + body.dashpot_force(drive.x, drive.v)) * (v + drive.v)).sum() / 4
        assert drive.simulation.number("energy.dissipated") - lost == pytest.approx(power * h, rel=1e-3)


def test_the_twin_has_no_internal_damping_and_says_so(tmp_path):
    scene = box(region=[{"points": "z-", "internal_damping": 2e-3}])
    with pytest.raises(SoftffdError, match=r"material\.internal_damping: the twin has none, wanted 0 s in it and all regions, got 0\.002"):
        build_twin(scene, tmp_path / "twin.fmu")
