"""What can be typed: examples of every command, and the nearest right word for a wrong one."""

import re
import shlex

import pytest

from softffd.cli.command import COMMANDS, main
from softffd.cli.options import parse


def wrong(capsys, *arguments: str) -> str:
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    assert stopped.value.code == 2
    return capsys.readouterr().err


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_an_example_that_can_be_typed(name, capsys):
    with pytest.raises(SystemExit):
        parse([name, "--help"])
    text = " ".join(capsys.readouterr().out.split())
    example = re.search(r"example: (softffd [^:>]+)", text)[1]
    assert parse(shlex.split(example)[1:]).command == name


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["rnu", "press"], 'got rnu, did you mean "run"?'),
        (["ifno"], 'got ifno, did you mean "info"?'),
        (["run", "press", "--stp-time", "1"], '--stp-time: there is no such option, did you mean "--stop-time"?'),
        (["run", "press", "--overwirte=1"], '--overwirte: there is no such option, did you mean "--overwrite"?'),
        (["build", "press", "--fmi", "4"], "argument --fmi: wanted one of 2, 3, got 4"),
        (["build", "press", "box"], "box: one word too many"),
        (["build", "press", "--qqqq"], "--qqqq: there is no such option\n"),
    ],
)
def test_a_wrong_word_is_told_the_nearest(arguments, said, capsys):
    assert said in wrong(capsys, *arguments)
