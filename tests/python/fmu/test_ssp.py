"""Systems of coupled FMUs: what is refused in words, and what is written."""

import shutil
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv

from scenes import box
from softffd import SoftffdError, package_fmu, write_ssp
from softffd.cli.command import main
from softffd.fmu.interface import Interface, ScalarVariable
from softffd.fmu.ssp import SPACES, START
from softffd.fmu.wiring import Element, Wiring
from softffd.names import ByName

LID = {"name": "lid", "point": [0, 0, 1.5], "normal": [0, 0, -1], "motion": "input"}
FALL = {"gravity": [0, 0, -9.81]}
PARTS = {"a": box(plane=[LID], environment=FALL), "b": box(plane=[LID], environment=FALL, load=[{"name": "push", "points": "x+"}])}
"""Each can move the other's lid by its probe's place or take its reaction as a load."""

ENDS = "connection: wanted two ends and, if any, a factor and an offset, got "
# fmt: off
REFUSED = {
    "unknown component": (("c.mass", "a.mass"), r"c\.mass: wanted COMPONENT\.VARIABLE of a, b"),
    "unknown variable": (("a.plane.lid.reactoin", "b.load.push"), r'a has no such variable, did you mean "a\.plane\.lid\.reaction"\?'),
    "variable of another scene": (
        ("a.energy.kinetic", "b.load.push.x"), r"a\.energy\.kinetic: a has no such variable: its scene needs \[outputs\] energy = true"),
    "two outputs": (("a.plane.lid.reaction.x", "b.plane.lid.reaction.x"), "wanted an output and an input, got an output and an output"),
    "two inputs, with what fits": (
        ("a.plane.lid.point.x", "b.load.push.x"),
        r"wanted an output and an input, got an input and an input; outputs of b in m: position\[i,j,k\], plane\.lid\.centre; "
        r"outputs of a in N: plane\.lid\.reaction$"),
    "a parameter": (("a.plane.lid.reaction.x", "b.damping"), "got an output and a tunable parameter"),
    "type": (("a.plane.lid.contacts", "b.load.push.x"),
             r"a\.plane\.lid\.contacts to b\.load\.push\.x: wanted one type, got Integer and Real"),
    "unit, with what fits": (
        ("a.position[0,0,0]", "b.load.push"),
        r"position\[0,0,0\]\.x to b\.load\.push\.x: wanted one unit or a factor .*, got m and N; "
        r"outputs of a in N: plane\.lid\.reaction; inputs of b in m: plane\.lid\.point\n"),
    "a vector and a number": (
        ("a.plane.lid.reaction", "b.load.push.x"), r"got a\.plane\.lid\.reaction \(\.x, \.y, \.z\) and b\.load\.push\.x \(a n"),
    "no factor": (("a.position[0,0,0].x", "b.load.push.x", 0.0), "wanted a finite factor that is not 0 .*, got 0 and 0"),
    "a word for a factor": (("a.position[0,0,0].x", "b.load.push.x", "half"), ENDS),
    "too many numbers": (("a.position[0,0,0].x", "b.load.push.x", 1, 2, 3), ENDS),
    "a name alone": ("ab", f"{ENDS}'ab'"),
    "one end": (("a.mass",), rf"{ENDS}\('a\.mass',\)"),
}
# fmt: on


@pytest.fixture(scope="module")
def packed(tmp_path_factory) -> dict[str, Path]:
    """The FMUs of PARTS."""
    folder = tmp_path_factory.mktemp("packed")
    return {name: package_fmu(scene, folder / f"{name}.fmu") for name, scene in PARTS.items()}


@pytest.mark.parametrize("connection, words", REFUSED.values(), ids=REFUSED)
def test_a_connection_that_does_not_fit_is_refused(packed, connection, words, tmp_path):
    with pytest.raises(SoftffdError, match=words):
        write_ssp(tmp_path / "x.ssp", packed, [connection])
    assert not list(tmp_path.iterdir())


def test_all_problems_are_told_at_once_an_input_connected_twice_among_them(tmp_path):
    forces = [("a.plane.lid.reaction", "b.load.push"), ("b.load.push.y", "b.plane.lid.reaction.y"), ("a.nobody", "b.load.push.y")]
    with pytest.raises(SoftffdError, match="5 problems") as caught:
        write_ssp(tmp_path / "x.ssp", PARTS, forces, start_values={"a.mas": 1, "a.gravity": (1, 2), "a.position[0,0,0].x": 1})
    twice = r"b.load.push.y: wanted one connection to an input, got a.plane.lid.reaction.y and b.plane.lid.reaction.y"
    start = ('a.mass"', "a.gravity: wanted 3 numbers", "wanted an input or a parameter to start from, got an output")
    for words in (twice, "a.nobody: a has", *start):
        assert words in str(caught.value)


def test_the_system_holds_its_components_connections_units_and_start_values(packed, tmp_path):
    fmu = packed["b"]
    asked = [("b.load.push", "a.plane.lid.reaction"), ("a.position[1,1,1].z", "b.plane.lid.point.z", 2, -1)]
    path = write_ssp(tmp_path / "new" / "two.ssp", {"a": PARTS["a"], "b": fmu}, asked, start_values={"a.mass": 3, "b.gravity": (0, 0, -1)})
    system = read_ssd(str(path)).system  # which checks it against the schema
    kinds = {(part.name, each.name): each.kind for part in system.elements for each in part.connectors}
    assert kinds["a", "plane.lid.reaction.y"] == "output" and kinds["b", "load.push.y"] == "input" and len(kinds) == 8
    ends = [(each.startElement, each.startConnector, each.endElement, each.endConnector) for each in system.connections]
    assert ("a", "plane.lid.reaction.x", "b", "load.push.x") in ends and len(ends) == 4
    with zipfile.ZipFile(path) as archive:
        assert archive.read("resources/b.fmu") == fmu.read_bytes()
        text = archive.read("SystemStructure.ssd").decode()
    assert '<ssc:LinearTransformation factor="2.0" offset="-1.0"' in text
    assert '<ssc:Unit name="N">\n      <ssc:BaseUnit kg="1" m="1" s="-2"' in text and SPACES["ssv"] in text
    given = {each.name: float(each.value) for each in read_ssv(str(path), START).parameters}
    assert given == {"a.mass": 3, "b.gravity.x": 0, "b.gravity.y": 0, "b.gravity.z": -1}


def test_names_that_hosts_would_mix_up_are_refused(tmp_path):
    with pytest.raises(SoftffdError, match="components a and ab: wanted names of which none begins with another"):
        write_ssp(tmp_path / "x.ssp", {"a": PARTS["a"], "ab": PARTS["a"]}, [], start_values={"ab.mass": 1})


# fmt: off
NO_SYSTEM = [
    ("x.ssp", {"a.b": PARTS["a"]}, r'wanted a name of letters, digits, "_" and "-", got "a\.b"; NAME=FILE'),
    ("x.ssp", {"a": "nobody.fmu"}, "there is no such FMU"),
    ("x.ssp", {"a": "empty.fmu"}, "cannot be read as an FMU"),
    ("x.ssp", {"a": "pres"}, '"press"'),
    ("x.ssp", {"a": "three.fmu"}, r"wanted an FMI 2\.0 co-simulation FMU, got FMI 3\.0"),
    ("d.ssp", {"a": "press"}, r'd\.ssp: wanted a file name ending in \.ssp, got a folder, did you mean ".*d.ssp.NAME\.ssp"'),
    ("x.zip", PARTS, r'wanted a file name ending in \.ssp, did you mean ".*x\.zip\.ssp"'),
]
# fmt: on


@pytest.mark.parametrize("name, components, words", NO_SYSTEM, ids=[words[:30] for *_, words in NO_SYSTEM])
def test_components_and_names_of_files_that_are_none_are_refused(name, components, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("empty.fmu").write_bytes(b"")
    Path("d.ssp").mkdir()
    if "three.fmu" in components.values():
        package_fmu(PARTS["a"], "three.fmu", fmi=3)
    with pytest.raises(SoftffdError, match=words):
        write_ssp(name, components, [])


@pytest.fixture
def says(packed, capsys, tmp_path, monkeypatch):
    """What the command line says to some words after `softffd ssp`, where the FMUs a and b are."""
    monkeypatch.chdir(tmp_path)
    for file in packed.values():
        shutil.copy(file, tmp_path)

    def said(*words: str, status: int = 0) -> str:
        assert main(["ssp", *words]) == status
        told = capsys.readouterr()
        return told.err if status else told.out

    return said


def test_the_command_line_says_what_hosts_do_otherwise(says):
    connect = ("--connect", "a.plane.lid.reaction=other.load.push", "--connect", "a.position[3,3,3].z=press.plane.press.point.z:0.5:1")
    told = says("press", "--with", "a.fmu", "--with", "other=b.fmu", *connect, "--set", "a.gravity=0,0,-2", "-o", "three.ssp")
    assert told.splitlines()[0] == "three.ssp: press, a, other; 4 connections"
    assert "fmpy sets connected inputs to 0 in its first step; here they start from press.plane.press.point.z = 1" in told
    assert "fmpy passes over factors" in told and f'read_ssv("three.ssp", "{START}")' in told
    assert [each.name for each in read_ssd("three.ssp").system.elements] == ["press", "a", "other"]


PLATE = {"reaction": ("input", "N"), "force": ("input", "N"), "point": ("output", "m"), "low": ("output", "mm")}


def plate_element():
    """A partner with two inputs for forces and lengths in m and mm."""
    units = {"N": {"kg": "1", "m": "1", "s": "-2"}, "m": {"m": "1"}, "mm": {"m": "1", "factor": "0.001"}}
    names = {f"{name}.{c}": given for name, given in PLATE.items() for c in "xyz"}
    listed = {name: ScalarVariable(name, 0, "Real", kind, "continuous", None, unit, "") for name, (kind, unit) in names.items()}
    return Element("plate", Interface("plate", "", "plate", "", ByName(listed), False, None, None, False, False, False), units)


@pytest.mark.parametrize(
    "connections, doubts",
    [
        ([("body.reaction", "plate.reaction")], []),
        ([("body.reaction", "plate.force")], ['body.reaction goes to plate.force; did you mean "plate.reaction", to which nothing goes?']),
        (
            [("body.reaction", "plate.force"), ("body.point", "plate.reaction", 2.0)],
            ["body.point to plate.reaction: the factor makes N of m"],
        ),
        ([("plate.low", "body.place", 0.001)], []),
    ],
)
def test_a_connection_that_is_likely_another_is_told(connections, doubts):
    plate = plate_element()
    names = {"reaction": ("output", "N"), "point": ("output", "m"), "place": ("input", "m")}
    listed = {f"{n}.x": ScalarVariable(f"{n}.x", 0, "Real", kind, "continuous", None, unit, "") for n, (kind, unit) in names.items()}
    body = Element("body", replace(plate.interface, name="body", variables=ByName(listed)), plate.units)
    wiring = Wiring({"body": body, "plate": plate})
    wiring.connect([(f"{one}.x", f"{other}.x", *factor) for one, other, *factor in connections])
    assert not wiring.problems
    assert [each.partition("; outputs")[0] for each in wiring.doubts()] == doubts


@pytest.mark.parametrize(
    "words, told",
    [
        (("--with", "a.fmu", "--with", "a.fmu"), "there is a component a already; wanted --with NAME=a.fmu"),
        (("--connect", "a.mass"), r"--connect a.mass: wanted END=END[:FACTOR[:OFFSET]]"),
        (("--connect", "a.mass=b.mass:x"), r"--connect a.mass=b.mass:x: wanted END=END"),
        (("--set", "a.mass"), "--set a.mass: wanted COMPONENT.VARIABLE=VALUE"),
        (("--set", "press.mass=heavy"), "press.mass: wanted a number, got 'heavy'"),
        (("--record", "press.energi"), 'press.energi: press has no such output, did you mean "press.energy"?'),
        (("--record", "pres.energy"), 'pres.energy: wanted COMPONENT.VARIABLE of press, did you mean "press"?'),
        (("--record", "press.mass"), "press.mass: wanted an output to record, got a fixed parameter"),
    ],
)
def test_a_wrong_word_of_the_command_line_is_refused(says, words, told):
    assert told in says("press", *words, status=1)
    assert not Path("press.ssp").exists()


def test_a_system_that_is_there_is_kept_unless_it_may_be_written_over(says):
    says("press")
    before = Path("press.ssp").read_bytes()
    assert "press.ssp: there already; to write over what is there: --overwrite" in says("press", "--with", "a.fmu", status=1)
    assert Path("press.ssp").read_bytes() == before
    assert "press.ssp: press, a" in says("press", "--with", "a.fmu", "--overwrite")


def test_outputs_to_record_are_connectors_which_fmpy_records(tmp_path):
    parts = {"a": box(plane=[LID], environment=FALL, energy=True), "b": PARTS["b"]}
    asked = ["a.energy", "a.plane.lid.reaction", "b.position[0,0,0].z", "b.plane.lid.contacts"]
    path = write_ssp(tmp_path / "x.ssp", parts, [("a.plane.lid.reaction", "b.load.push")], record=asked)
    rows = simulate_ssp(str(path), stop_time=0.015, step_size=0.01)
    names = set(rows.dtype.names)
    assert {"a.energy.kinetic", "a.plane.lid.reaction.x", "b.position[0,0,0].z", "b.load.push.x", "b.plane.lid.contacts"} <= names
    assert rows["a.energy.kinetic"][-1] > 0 and rows["b.position[0,0,0].z"][-1] < 0
    everything = write_ssp(tmp_path / "all.ssp", {"b": PARTS["b"]}, [], record="b")
    kinds = [each.kind for each in read_ssd(str(everything)).system.elements[0].connectors]
    assert kinds and set(kinds) == {"output"}
