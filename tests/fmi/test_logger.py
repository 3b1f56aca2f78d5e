"""Instantiation that is refused, and messages: when they come, in which category, and what they look like."""

from ctypes import CDLL, c_char_p, c_size_t, create_string_buffer
from pathlib import Path

import numpy as np
import pytest

from c_host import DISCARD, ERROR, OK, STEP, WARNING, Fmu, Host, doubles, uints
from scenes import MOVED, box
from straight_run import RICH, check_straight, straight

CANCELLED = b"fmi2CancelStep: steps are never pending, there is none to cancel"


REFUSED = [
    (2, {"type": 0}, "fmuType: wanted fmi2CoSimulation"),
    (2, {"guid": None}, "fmuGUID: wanted a text, got null"),
    (2, {"guid": b"{no%s#n}"}, "fmuGUID: wanted {"),
    (2, {"uri": None}, "fmuResourceLocation: wanted the URI"),
    (2, {"uri": b""}, "fmuResourceLocation: wanted the URI"),
    (2, {"uri": b"http://x/%20#y"}, "wanted a file: URI, got http://x/%%20##y"),
    (2, {"uri": b"file://host/x"}, "fmuResourceLocation: wanted a URI without a host, or with localhost, got file://host/x"),
    (2, {"uri": b"file:///tmp/%zz"}, "wanted two hexadecimal digits, not 00, after each %% of the URI, got file:///tmp/%%zz"),
    (2, {"uri": b"file:///no/such%20folder"}, "fmi2Instantiate: cannot read /no/such folder/scene.txt"),
    (2, {"name": b""}, "instanceName: wanted a text"),
    (3, {"token": b"50%of#1"}, "fmi3InstantiateCoSimulation: instantiationToken: wanted {"),
    (3, {"token": None}, "instantiationToken: wanted a text, got null"),
    (3, {"resources": None}, "resourcePath: wanted the path of the resources folder, got nothing"),
    (3, {"resources": b"file:///x"}, "resourcePath: wanted a path, without file:, got the URI file:///x"),
    (3, {"resources": b"/nowhere"}, "fmi3InstantiateCoSimulation: cannot read /nowhere/scene.txt"),
    (3, {"events": True}, "eventModeUsed: wanted fmi3False"),
    (3, {"intermediate": 2}, "nRequiredIntermediateVariables: wanted 0, got 2"),
    *[(fmi, {"name": b" \t\n "}, "instanceName: wanted a text, got nothing but blanks") for fmi in (2, 3)],
    *[(fmi, {"name": None}, "instanceName: wanted a text, got nothing") for fmi in (2, 3)],
]


@pytest.mark.parametrize("fmi, given, wanted", REFUSED)
def test_a_refused_instantiation_says_why_once(rich, rich3, fmi, given, wanted):
    host = {2: rich, 3: rich3}[fmi].host(**given)
    assert not host.component
    assert len(host.messages) == 1
    environment, instance, status, category, message = host.messages[0]
    assert (environment, instance) == (4711, given.get("name", b"host") or (b"" if fmi == 2 else None))
    assert (status, category) == (ERROR, b"logStatusError")
    assert wanted in message.decode()
    assert fmi == 3 or "%" not in message.decode().replace("%%", "")
    assert not given.get("token") or message.endswith(b", got 50%of##1")  # in FMI 3.0 # alone has a meaning


def test_a_damaged_resource_is_refused_with_the_reason(rich, tmp_path):
    scene = Path(rich.path).parents[2] / "resources" / "scene.txt"
    (tmp_path / "scene.txt").write_text(scene.read_text().replace("friction", "frictio") + "step 0.0\n")
    host = Host(rich, uri=tmp_path.as_uri().encode())
    assert not host.component and b"checksum" in host.messages[0][4]


@pytest.mark.parametrize("given", [{"guid": b"{no}\n"}, {"uri": b"http://x\n"}, {"uri": b"file:///no\xff\xfe"}, {"guid": b"\xff"}])
def test_what_a_message_repeats_of_the_host_leaves_it_one_clean_line(rich, given):
    host = Host(rich, **given)
    text = host.messages[0][4].decode("utf-8")
    assert not host.component and text == text.strip() and "\n" not in text


def test_no_callbacks_and_no_logger_are_survived(rich):
    assert not rich.library.fmi2Instantiate(b"x", 1, rich.guid, rich.uri, None, 0, 1)
    host = Host(rich, logger=False, logging=True)
    host.begin()
    assert host.step(0) == OK
    assert host.step(0) == ERROR
    assert host.set({"mass": -1.0}) == ERROR
    host.must("Reset")
    host.free()
    assert not Host(rich, logger=False, guid=b"{no}").component


def test_a_message_is_the_format_that_a_host_prints(rich):
    """Printed as a format, doubled percent signs come out single and nothing is expanded."""
    host = Host(rich, uri=b"http://x/%d%s%n#25")
    message = host.messages[0][4]
    buffer = create_string_buffer(1000)
    library = CDLL(None)
    library.snprintf(buffer, c_size_t(1000), message)
    assert buffer.value.endswith(b"got http://x/%d%s%n##25")


def talkative(host: Host) -> None:
    """A run with solver messages, a warning and a discarded step."""
    host.begin(lambda h: h.set({"solver.step": 0.5}))
    host.must("DoStep", 0.0, STEP, 1)
    host.must("SetReal", uints([host.fmu.names["stiffness.edge"]]), 1, doubles([4e4]))
    host.must("DoStep", STEP, STEP, 1)
    assert host.set({"stiffness.edge": 1e19}) == OK
    assert host("DoStep", 2 * STEP, 1.0, 1) == DISCARD


def test_messages_come_only_where_they_were_asked_for_and_in_declared_categories(rich):
    quiet, loud = Host(rich), Host(rich, logging=True)
    for host in (quiet, loud):
        talkative(host)
    assert quiet.messages == []
    assert {message[3] for message in loud.messages} >= {b"logStatusWarning"}
    for environment, instance, _, category, message in loud.messages:
        assert (environment, instance) == (4711, b"host")
        assert category in rich.categories
        assert message and message == message.strip()
    assert quiet("DoStep", 9.0, STEP, 1) == ERROR
    assert len(quiet.messages) == 1
    for host in (quiet, loud):
        host.free()


def test_there_is_no_step_to_cancel_and_the_run_goes_on(rich):
    expected = straight(rich, 3)
    host = Host(rich)

    def cancel() -> None:
        status, message = host("CancelStep"), host.messages.pop()
        assert status == message[2] == WARNING and message[3:] == (b"logStatusWarning", CANCELLED) and not host.messages

    cancel()
    assert host.enter() == OK
    cancel()
    host.must("ExitInitializationMode")
    check_straight(host, expected, cancel)
    host.must("Terminate")
    cancel()
    host.free()


def test_a_run_that_was_not_set_up_is_warned_of_once_and_is_that_of_the_defaults(rich):
    told = b"fmi2SetupExperiment was not called: the run starts at time 0 s, has no stop time"
    expected, host = straight(rich, 3), Host(rich, logging=True)
    for runs in (1, 2):
        host.must("EnterInitializationMode")
        host.must("ExitInitializationMode")
        check_straight(host, expected)
        said = [message[2:4] for message in host.messages if told in message[4]]
        assert said == [(WARNING, b"logStatusWarning")] * runs
        host.must("Reset")
    host.begin()
    assert sum(told in message[4] for message in host.messages) == 2
    host.free()


@pytest.mark.parametrize(
    "parameter, given, used", [(1e-6, "default", 1e-6), (1e-6, 1e-3, 1e-3), (None, 1e-3, 1e-3), (1e-6, None, 1e-6), (1e-6, 1e-6, 1e-6)]
)
def test_where_parameter_and_host_give_other_tolerances_the_one_used_is_told(rich_of_each, parameter, given, used):
    """That of DefaultExperiment is passed on by hosts that nobody asked for a tolerance."""
    given = RICH.solver.tolerance if given == "default" else given
    host = rich_of_each.host(logging=True)
    assert parameter is None or host.set({"solver.tolerance": parameter}) == OK
    assert host.enter(tolerance=given) == OK
    assert np.float64(used).tobytes() in host.settings()
    told = [message[2:] for message in host.messages if b"tolerance" in message[4]]
    assert len(told) == (None not in (parameter, given) and parameter != given)
    for status, category, text in told:
        assert (status, category) == (WARNING, b"logStatusWarning")
        assert text.startswith(b"solver.tolerance was set to 1e-06, and the host gave the run the tolerance 0.00")
        assert text.endswith(f": {used:.9g} is used".encode())
    host.free()


STANDARD = [
    *(b"logEvents", b"logSingularLinearSystems", b"logNonlinearSystems", b"logDynamicStateSelection", b"logStatusWarning"),
    *(b"logStatusDiscard", b"logStatusError", b"logStatusFatal", b"logStatusPending", b"logAll"),
]


def switch(host: Host, on: bool, *names: bytes | None) -> int:
    return host("SetDebugLogging", on, len(names), (c_char_p * len(names))(*names))


def heard(host: Host) -> set[bytes]:
    """Categories of what new runs say, one with a method that the component chooses."""
    host.messages.clear()
    host.must("Reset")
    host.begin()
    host.must("DoStep", 0.0, STEP, 1)
    host.must("Reset")
    talkative(host)
    return {message[3] for message in host.messages}


def test_the_standards_categories_and_the_solvers_are_declared_and_taken(rich):
    assert rich.categories == {*STANDARD, b"solver"}
    host = Host(rich)
    assert switch(host, True, *STANDARD) == switch(host, False, *STANDARD) == OK
    assert not host.messages
    host.free()


def test_each_category_switches_its_own_messages_and_log_all_switches_every_one(rich):
    host = Host(rich)
    everything = {b"logStatusWarning", b"logStatusDiscard", b"solver"}
    for name in rich.categories:
        assert switch(host, True, name) == OK
        assert heard(host) == (everything if name == b"logAll" else everything & {name})
        assert switch(host, False, name) == OK
        assert heard(host) == set()
    assert switch(host, True, b"logAll") == switch(host, False, b"logStatusWarning") == OK
    assert heard(host) == everything - {b"logStatusWarning"}
    assert switch(host, False, b"logAll") == OK
    assert heard(host) == set()
    host.free()


@pytest.mark.parametrize("begun", [False, True])
def test_unknown_categories_are_named_in_one_warning_and_passed_over(rich, begun):
    host = Host(rich)
    if begun:
        host.begin()
    assert switch(host, True, b"logSome%", b"logStatusDiscard", None) == WARNING
    environment, instance, status, category, message = host.messages.pop()
    assert (environment, instance, status, category) == (4711, b"host", WARNING, b"logStatusWarning")
    assert not host.messages and b"logStatusDiscard" in message and message.endswith(b"passed over logSome%%, (null)")
    assert heard(host) == {b"logStatusDiscard"}
    assert switch(host, False, b"nothing known") == WARNING
    assert heard(host) == {b"logStatusDiscard"}
    host.free()


@pytest.fixture(scope="module")
def sunk(rich, tmp_path_factory) -> Fmu:
    """A box of four layers, one of its points pinned, on a plane that can be put anywhere."""
    floor = {"name": "floor", "normal": [0.0, 0.0, 2.0], **MOVED}
    wall = {"name": "wall", "point": [-1.0, 0.0, 0.0], "normal": [1.0, 0.0, 0.0]}
    scene = box(plane=[floor, wall], pin=[{"name": "nail", "points": [[0, 0, 3]]}])
    return Fmu(scene, tmp_path_factory.mktemp("sunk") / "fmu", rich.library)


@pytest.mark.parametrize(
    "values, warning",
    [
        ({"plane.floor.point.z": 0.0}, None),
        ({"plane.floor.point.z": 1e-10}, None),
        (
            {"plane.floor.point.z": 0.2},
            "16 control points start behind plane floor, by up to 0.2 m, and are moved out at the start; to start",
        ),
        ({"plane.floor.point.z": 0.5, "solver.step": 1e-4}, "springs have zero length, because 32 control points"),
    ],
)
def test_points_that_start_behind_a_plane_are_warned_of_once(sunk, values, warning):
    host = Host(sunk, logging=True)
    host.begin(lambda h: h.set(values))
    for n in range(3):
        host.step(n)
    said = [message[4].decode() for message in host.messages if message[2] == WARNING and b"behind plane" in message[4]]
    assert len(said) == (warning is not None) and all(warning in text for text in said)
    assert all("solver.step" not in text for text in said)
    host.free()


def test_layers_that_a_plane_lays_together_are_refused_with_the_plane(sunk):
    host = Host(sunk)
    assert host.enter() == host.set({"plane.floor.point.z": 0.5}) == OK
    assert host("ExitInitializationMode") == ERROR
    message = host.messages[0][4].decode()
    assert "springs have zero length, because 32 control points start behind plane floor, by up to 0.5 m" in message
    assert "initial.stretch" not in message and "solver.step" not in message
    host.free()
