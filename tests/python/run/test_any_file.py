"""Files that nobody foresaw: whatever is in a CSV file of inputs or in an edited file of a result or a sweep, it is used or refused in
words, and nothing else comes out."""

import json
import zipfile
from contextlib import suppress
from functools import partial
from io import BytesIO

import numpy as np
import pytest
from hypothesis import strategies as st

from any_example import require_of_all
from scenes import LED, box, table_and_press
from softffd import Result, SoftffdError, Sweep, package_fmu, simulate, sweep

few_and_many = pytest.mark.parametrize("examples", [pytest.param(count, id=f"{count} files") for count in (15, 2000)])
few = pytest.mark.short("*15 files")


class Bytes(bytes):
    """Of a file, which a failure does not print."""

    def __repr__(self):
        return f"<{len(self)} bytes>"


# ---- inputs ----

INPUTS = st.sampled_from(
    ["load.push.x", "load.push.y", "plane.press.point.z", "plane.press.velocity.z", "plane.press.normal.x", "pin.hand.position.x",
     *(f"pin.hand.orientation.{c}" for c in "wxyz"), "force[0,0,0].x", "force_1_1_1.z"]
)  # fmt: skip
NAMES = st.one_of(
    INPUTS, st.sampled_from(["time", "mass", "position[0,0,0].x", "force_0_0_0.x", "", " time", "Time", "#time", '"time"', '"', "n\0n"])
)
WORDS = st.one_of(
    st.sampled_from(["", "0", "1", "-1", "0.01", "1e-3", "1e308", "-1e400", "nan", "inf", "1_0", "0x1", "1,5", "١", "-0.0", "5e-324", "#"]),
    st.floats().map(str), st.integers(-10, 10).map(str), st.text(max_size=5),
)  # fmt: skip
LIKELY = st.one_of(st.floats(-2, 2).map(str), st.sampled_from(["0", "0.5", "1e3", "-1e9"]))


@st.composite
def tables(draw) -> bytes:
    """Lines that are nearly, or wholly, a header of inputs and numbers below it."""
    sane = draw(st.sampled_from([True, True, False]))
    names = ["time", *draw(st.lists(INPUTS, min_size=1, max_size=5, unique=True))] if sane else draw(st.lists(NAMES, max_size=5))
    count = draw(st.integers(1, 5))
    rows = [[draw(LIKELY if sane else WORDS) for _ in names] for _ in range(count)]
    for row, time in zip(rows, sorted(draw(st.lists(st.floats(-0.01, 0.05), min_size=count, max_size=count))), strict=True):
        row[:1] = [str(time)]
    separator = "," if sane else draw(st.sampled_from([",", ", ", ";", "\t"]))
    ends = draw(st.sampled_from(["\n", "\r\n", "\n\n"] if sane else ["\n", "\r", "\n#"]))
    return ends.join(separator.join(row) for row in [names, *rows]).encode()


@st.composite
def spoilt(draw, whole) -> bytes:
    """Bytes of which some are other ones, missing or there twice."""
    data = draw(whole)
    for _ in range(draw(st.integers(0, 3))):
        first, last = sorted(draw(st.tuples(*[st.integers(0, len(data))] * 2)))
        data = data[:first] + draw(st.one_of(st.binary(max_size=8), st.just(data[first:last] * 2), st.just(b""))) + data[last:]
    return data


@pytest.fixture(scope="module")
def led(tmp_path_factory):
    scene = box(
        points=[2, 2, 2], plane=table_and_press(), pin=[{"name": "hand", "points": "x-", **LED}], load=[{"name": "push", "points": "x+"}],
        forces="all", stop_time=0.02, communication_step=0.01,
    )  # fmt: skip
    return package_fmu(scene, tmp_path_factory.mktemp("led") / "led.fmu")


@few
@few_and_many
def test_any_file_of_inputs_drives_a_run_or_is_refused(led, tmp_path, examples):
    file, outcomes = tmp_path / "inputs.csv", {"run": 0, "refused": 0}

    def check(example):
        data, interpolation = example
        file.write_bytes(data)
        try:
            result = simulate(led, inputs=file, interpolation=interpolation)
            assert len(result.time) == 3 and len(result.inputs["load.push.x"]) == 3
            outcomes["run"] += 1
        except SoftffdError as error:
            assert str(error).strip()
            outcomes["refused"] += 1

    files = st.one_of(tables(), tables(), spoilt(tables()), st.text().map(str.encode) | st.binary())
    require_of_all(st.tuples(files, st.sampled_from(["held", "linear", "cubic"])), examples, check)
    assert all(outcomes.values()), outcomes  # there are both


# ---- results and sweeps ----

JSON = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5), st.sampled_from([10**400, -1, 2, "time", "mass"])),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=5), inner, max_size=3)),
    max_leaves=5,
)  # fmt: skip


def places(value, here=()):
    """The paths of all parts of a value of JSON."""
    yield here
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from places(inner, (*here, key))


def edited(value, path, new):
    """The value with another part at a path; without it where `new` is ..."""
    if not path:
        return None if new is ... else new
    items = dict(value) if isinstance(value, dict) else dict(enumerate(value))
    if len(path) == 1 and new is ...:
        del items[path[0]]
    else:
        items[path[0]] = edited(items[path[0]], path[1:], new)
    return items if isinstance(value, dict) else list(items.values())


ARRAYS = st.one_of(
    st.just(...), st.sampled_from(["cut", "flat", "turned", "empty", "one"]),
    st.sampled_from(["f4", "i8", "?", "S3", "U3", "c16", "M8[s]", "f8,i4", "O", ">f8"]), st.floats(), st.binary(max_size=20),
)  # fmt: skip


def changed(array, how):
    """An array of another shape, of another type, or with another number in it."""
    if isinstance(how, float):
        array = array.astype(float) if array.dtype.kind in "fiub" else array
        with suppress(ValueError):
            array.reshape(-1)[:1] = how
        return array
    shapes = {"cut": array[1:] if array.ndim else array, "flat": array.reshape(-1), "turned": array.T, "empty": array.reshape(-1)[:0]}
    if how in (*shapes, "one"):
        return shapes.get(how, np.array(1.0))
    try:
        return array.astype(how)
    except (TypeError, ValueError):
        return np.zeros(array.shape, how)


@st.composite
def archives(draw, arrays, header):
    """The file of some arrays, of which some are other ones, and parts of its JSON header too; with what is other."""
    arrays, said = dict(arrays), json.loads(str(arrays[header]))
    edits = []
    for _ in range(draw(st.integers(0, 3))):
        edits.append((draw(st.sampled_from(list(places(said)))), draw(st.one_of(st.just(...), JSON))))
        said = edited(said, *edits[-1])
    arrays[header] = np.array(json.dumps(said))
    stream = BytesIO()
    raw = {name: draw(ARRAYS) for name in draw(st.lists(st.sampled_from(sorted(arrays)), max_size=2))}
    with zipfile.ZipFile(stream, "w") as archive:
        for name, array in arrays.items():
            if (how := raw.get(name)) is ...:
                continue
            with archive.open(f"{name}.npy", "w") as entry:
                if isinstance(how, bytes):
                    entry.write(how)
                else:
                    np.lib.format.write_array(entry, array if how is None else changed(array, how), allow_pickle=True)
    return edits, raw, Bytes(stream.getvalue())


def use_result(file):
    result = Result.load(file)
    repr(result)
    result.save(file.with_name("again.npz"))
    view = partial(result.view, file.with_name("view.html"), browser=False)
    planes = [partial(result.plane, name) for name in result.plane_names()]
    for read in (result.deformation, result.strain, result.stress, result.to_dataframe, result.to_xarray, view, *planes):
        with suppress(SoftffdError):
            read()


def use_sweep(file):
    table = Sweep.load(file)
    repr(table)
    table.save(file.with_name("again.npz"))
    table.to_csv(file.with_name("again.csv"))


def a_result():
    return simulate(box(points=[2, 2, 2], plane=table_and_press(), energy=True, stop_time=0.02))


def a_sweep():
    return sweep(box(points=[2, 2, 2], stop_time=0.01), {"mass": [1, 2], "solver.method": ["leapfrog"]}, outputs=["position[0,0,0].z"])


@few
@few_and_many
@pytest.mark.parametrize(
    "make, header, use", [(a_result, "header", use_result), (a_sweep, "sweep.about", use_sweep)], ids=["result", "sweep"]
)
def test_any_edited_file_is_used_or_refused(make, header, use, tmp_path, examples):
    file, outcomes = tmp_path / "kept.npz", {"used": 0, "refused": 0}
    make().save(file)
    whole = file.read_bytes()
    with np.load(file) as kept:
        arrays = dict(kept)

    def check(example):
        file.write_bytes(example[-1])
        try:
            use(file)
            outcomes["used"] += 1
        except SoftffdError as error:
            assert "kept.npz: " in str(error)
            outcomes["refused"] += 1

    kinds = st.one_of(archives(arrays, header), archives(arrays, header), spoilt(st.just(whole)).map(lambda data: ("spoilt", Bytes(data))))
    require_of_all(kinds, examples, check)
    assert all(outcomes.values()), outcomes  # there are both
