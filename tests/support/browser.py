"""A page in headless Chromium that is driven by its debugging pipe: messages in JSON, each ended by a zero byte."""

import base64
import json
import os
import shutil
import subprocess
import time
from pathlib import Path

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars",
]  # fmt: skip


def require_browser() -> None:
    """In one place, so that pytest says it in one line."""
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine to look at the page with")


class Browser:
    """One page. Errors of its scripts are in `errors`."""

    def __init__(
        self, page: Path, folder: Path, *, width: int = 900, height: int = 600, mobile: bool = False, dark: bool = False, hash: str = ""
    ):
        here, there = os.pipe(), os.pipe()
        self._to, self._from, self._buffer, self._number, self.errors = here[1], there[0], b"", 0, []
        command = [CHROMIUM, *FLAGS, "--remote-debugging-pipe", f"--user-data-dir={folder / 'profile'}", "about:blank"]
        self._process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{here[0]} 4>&{there[1]}', "bash", *command],
            pass_fds=(here[0], there[1]),
            stderr=subprocess.DEVNULL,
        )
        os.close(here[0])
        os.close(there[1])
        self._session = None
        target = next(each for each in self("Target.getTargets")["targetInfos"] if each["type"] == "page")
        self._session = self("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        self("Runtime.enable")
        self("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)
        if mobile:
            self("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        self("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self("Page.enable")
        self("Page.navigate", url=f"file://{page}{hash}")

    def __call__(self, method: str, **params):
        """A command of the Chrome DevTools Protocol, and its result."""
        self._number += 1
        session = {"sessionId": self._session} if self._session else {}
        os.write(self._to, json.dumps({"id": self._number, "method": method, "params": params} | session).encode() + b"\0")
        while True:
            while b"\0" not in self._buffer:
                read = os.read(self._from, 1 << 20)
                assert read, "the browser has ended"
                self._buffer += read
            message, self._buffer = self._buffer.split(b"\0", 1)
            told = json.loads(message)
            if told.get("method") == "Runtime.exceptionThrown":
                details = told["params"]["exceptionDetails"]
                self.errors.append(details.get("exception", {}).get("description") or details["text"])
            if told.get("id") == self._number:
                assert "error" not in told, told["error"]
                return told["result"]

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

    def close(self) -> None:
        os.close(self._to)
        os.close(self._from)
        self._process.terminate()
        self._process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
