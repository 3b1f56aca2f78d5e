"""What can be typed: examples of every command, and the nearest right word for a wrong one."""

import argparse
import re
import shlex

import pytest

from softffd.cli.command import COMMANDS, main
from softffd.cli.options import _number, parse, parser
from validation.tools import parser as tools_parser


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
        (["rnu", "press"], "got 'rnu', did you mean \"run\"?"),
        (["ifno"], "got 'ifno', did you mean \"info\"?"),
        (["run", "press", "--stp-time", "1"], '--stp-time: there is no such option, did you mean "--stop-time"?'),
        (["run", "press", "--overwirte=1"], '--overwirte: there is no such option, did you mean "--overwrite"?'),
        (["build", "press", "--fmi", "4"], "argument --fmi: wanted one of 2, 3, got 4"),
        (["build", "press", "box"], "box: one word too many"),
        (["build", "press", "--qqqq"], "--qqqq: there is no such option\n"),
        ([], "the following arguments are required: COMMAND"),
        (["fly"], "argument COMMAND: wanted one of demo, build, run, "),
        (["run"], "the following arguments are required: SCENE"),
        (["run", "press", "--step", "fast"], "argument --step: wanted a number, got 'fast'"),
        (["run", "press", "--no-input", "--input", "none.csv"], "argument --input: not allowed with argument --no-input"),
        (["sweep", "press", "--vary", "mass=1", "--scheduler", "a", "-j", "2"], "-j/--jobs: not allowed with argument --scheduler"),
        (["ssp", "press", "a.fmu"], "a.fmu: one word too many; another component goes after --with"),
    ],
)
def test_a_wrong_word_is_told_the_nearest_and_wrong_usage_what_is_wanted(arguments, said, capsys):
    assert said in wrong(capsys, *arguments)


WITHOUT_UNIT = {"tolerance": "as a fraction of", "noise": "in the unit of the output"}
"""Numbers that have no dimension, and what is said of them in the place of a unit"""


@pytest.mark.parametrize("whole", [parser(), tools_parser()], ids=["softffd", "run.py"])
def test_every_help_text_is_a_sentence_with_its_unit(whole):
    (commands,) = (action for action in whole._actions if isinstance(action, argparse._SubParsersAction))
    texts = {each.dest: each.help for each in commands._choices_actions}
    numbers = {}
    for name, command in {"": whole, **commands.choices}.items():
        options = {f"{name} {action.dest}": action for action in command._actions if action is not commands}
        texts |= {name: action.help for name, action in options.items()}
        numbers |= {name: action for name, action in options.items() if action.type is _number}
    wrong = [f"{name}: no sentence: {text}" for name, text in texts.items() if not re.fullmatch(r"[A-Z].*\.", text or "")]
    for name, action in numbers.items():
        if not re.search(WITHOUT_UNIT.get(action.dest, r"\bin (s|m|kg/m3)\b"), action.help or ""):
            wrong.append(f"{name}: no unit: {action.help}")
    assert len(texts) > 15 and not wrong, "\n".join(wrong)


def test_the_help_names_both_versions_of_the_standard():
    assert "FMI 2" in parser().format_help() and "FMI 3" in parser().format_help()
