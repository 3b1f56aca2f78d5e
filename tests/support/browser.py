"""Pages in headless Chromium that is driven by its debugging pipe: messages in JSON, each ended by a zero byte.

A process of tests starts one Chromium and shows one page after the other in it: that takes half the time of a Chromium for each.
"""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars", "--disable-dev-shm-usage", "--disable-extensions", "--disable-breakpad", "--mute-audio",
)  # fmt: skip
PATIENCE = 60.0
"""s to wait for an answer"""
TO_START, STARTS = 20.0, 3
"""s in which Chromium has an empty page, and how often it may try: on a busy machine it hangs there now and then."""


def require_browser() -> None:
    """In one place, so that pytest says it in one line."""
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine to look at the page with")


class Chromium:
    """The program, with a profile of its own, and the page in it that is shown."""

    def __init__(self, *more: str):
        self.heard: list[dict] = []
        self._profile = tempfile.TemporaryDirectory(prefix="chromium-", ignore_cleanup_errors=True)
        self._session, self._buffer, self._number = None, b"", 0
        here, there = os.pipe(), os.pipe()
        self._to, self._from = here[1], there[0]
        command = [CHROMIUM, *FLAGS, *more, "--remote-debugging-pipe", f"--user-data-dir={self._profile.name}", "about:blank"]
        self._process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{here[0]} 4>&{there[1]}', "bash", *command],
            pass_fds=(here[0], there[1]),
            stderr=subprocess.DEVNULL,
        )
        os.close(here[0])
        os.close(there[1])

    def answer(self) -> None:
        """It has a page that runs scripts."""
        if self._session is None:
            target = next(each for each in self("Target.getTargets", TO_START)["targetInfos"] if each["type"] == "page")
            self._session = self("Target.attachToTarget", TO_START, targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Runtime", "Page"):
            self(f"{domain}.enable", TO_START)
        self("Runtime.evaluate", TO_START, expression="0")

    def __call__(self, method: str, seconds: float = PATIENCE, /, **params):
        """A command of the Chrome DevTools Protocol, and its result. TimeoutError where there is none in time, EOFError where the program
        has ended; other messages are put in `heard`."""
        self._number += 1
        session = {"sessionId": self._session} if self._session else {}
        os.write(self._to, json.dumps({"id": self._number, "method": method, "params": params} | session).encode() + b"\0")
        end = time.monotonic() + seconds
        while (told := self._message(method, end)).get("id") != self._number:
            self.heard.append(told)
        assert "error" not in told, told["error"]
        return told["result"]

    def _message(self, method: str, end: float) -> dict:
        while b"\0" not in self._buffer:
            if not select.select([self._from], [], [], max(0.0, end - time.monotonic()))[0]:
                raise TimeoutError(f"the browser does not answer to {method}")
            if not (read := os.read(self._from, 1 << 20)):
                raise EOFError("the browser has ended")
            self._buffer += read
        message, self._buffer = self._buffer.split(b"\0", 1)
        return json.loads(message)

    def end(self) -> None:
        os.close(self._to)
        os.close(self._from)
        self._process.terminate()
        try:
            self._process.wait(5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._profile.cleanup()


_running: dict[tuple[str, ...], Chromium] = {}


GONE = (TimeoutError, OSError, EOFError)
"""How a browser that has ended, or hangs, shows it"""


def chromium(*more: str) -> Chromium:
    """That of this process with these further flags; another one where that has ended or hangs."""
    for left in reversed(range(STARTS)):
        if more not in _running:
            _running[more] = Chromium(*more)
        try:
            _running[more].answer()
            break
        except GONE:
            _running.pop(more).end()
            if not left:
                raise
    return _running[more]


def end_all() -> None:
    while _running:
        _running.popitem()[1].end()


class Browser:
    """One page, until the next one is shown. Errors of its scripts are in `errors`."""

    def __init__(
        self, page: Path, *flags: str, width: int = 900, height: int = 600, mobile: bool = False, dark: bool = False, hash: str = ""
    ):
        self._flags, self._chromium, self.errors = flags, chromium(*flags), []
        self("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)
        self("Emulation.setTouchEmulationEnabled", enabled=mobile, **({"maxTouchPoints": 2} if mobile else {}))
        self("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self("Page.navigate", url=f"file://{page}{hash}")

    def __call__(self, method: str, **params):
        """A command of the Chrome DevTools Protocol, and its result. After one that is not answered the next page has a new browser."""
        try:
            result = self._chromium(method, **params)
        except GONE:
            _running.pop(self._flags).end()
            raise
        for told in self._chromium.heard:
            if told.get("method") == "Runtime.exceptionThrown":
                details = told["params"]["exceptionDetails"]
                self.errors.append(details.get("exception", {}).get("description") or details["text"])
        self._chromium.heard.clear()
        return result

    def ask(self, expression: str):
        """The value of an expression in the page, JSON; of a promise, what it comes to."""
        done = self("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in done, done["exceptionDetails"]
        return done["result"].get("value")

    def wait_for(self, expression: str, seconds: float = 60.0):
        """The value of an expression, once it is true."""
        end = time.monotonic() + seconds
        while not (value := self.ask(expression)):
            assert time.monotonic() < end, f"{expression} did not come true in {seconds} s; {self.errors}"
            time.sleep(0.05)
        return value

    def mouse(self, kind: str, x: float, y: float, **more) -> None:
        """kind: "mousePressed", "mouseMoved" or "mouseReleased", of the left button."""
        held = {"button": "left", "buttons": int(kind != "mouseReleased"), "clickCount": 1}
        self("Input.dispatchMouseEvent", type=kind, x=x, y=y, **(held | more))

    def drag(self, start, end, steps: int = 5) -> None:
        """The left button goes down at one place (x, y) and moves to another, where it stays down."""
        self.mouse("mousePressed", *start)
        for n in range(1, steps + 1):
            self.mouse("mouseMoved", *(a + (b - a) * n / steps for a, b in zip(start, end, strict=True)))

    def touch(self, kind: str, *places) -> None:
        """kind: "touchStart", "touchMove" or "touchEnd"; places (x, y) of the fingers."""
        self("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": n} for n, (x, y) in enumerate(places)])

    def key(self, key: str, *, shift: bool = False) -> None:
        for kind in ("keyDown", "keyUp"):
            self(
                "Input.dispatchKeyEvent",
                type=kind,
                key=key,
                modifiers=8 * shift,
                **({"text": key} if kind == "keyDown" and len(key) == 1 else {}),
            )

    def shot(self, path: Path) -> None:
        """The page as a picture (PNG)."""
        path.write_bytes(base64.b64decode(self("Page.captureScreenshot")["data"]))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if _running.get(self._flags) is self._chromium:
            self("Page.navigate", url="about:blank")


RUN_SHOWN = "typeof shown !== 'undefined' && shown !== null"
LIVE = "typeof source === 'object' && !!now.outputs"
"""What is true as soon as the page of a run is drawn, or a live page runs"""


@contextmanager
def showing(page: Path, *flags: str, ready: str = RUN_SHOWN, **window) -> Iterator[Browser]:
    """A page once it is ready; in the end its scripts have had no error."""
    require_browser()
    with Browser(page, *flags, **window) as browser:
        browser.wait_for(ready)
        yield browser
        assert not browser.errors
