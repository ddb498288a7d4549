"""A headless browser that tests drive, over two pipes in the words of its DevTools protocol."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any, Self

import pytest

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
TRIES = 5
"""Clicks beside what moves away, as when a field that was typed into comes into view."""

PATIENCE = 240.0  # s; a busy machine takes several times as long as an idle one


def found_browser() -> str | None:
    """Return the browser of this machine; None: there is none that these tests can drive."""
    return next((path for path in map(shutil.which, NAMES) if path is not None), None)


def evaluated(script: str, folder: Path) -> Any:
    """Return what a script returns in an empty page; skip the test where there is no browser.

    Args:
        script: the body of a function.
        folder: for the profile of the browser.
    """
    program = found_browser()
    if program is None:
        pytest.skip("needs chromium on this machine: it runs the scripts")
    with Browser(program, folder / "profile") as browser:
        return browser.value(f"(() => {{\n{script}\n}})()")


class Browser:
    """One page in a headless browser.

    Args:
        program: the browser.
        folder: of its profile.
        width: of its window.
        height: of its window.
        phone: whether it shows pages as a telephone does.
    """

    def __init__(
        self,
        program: str,
        folder: Path,
        width: int = 1280,
        height: int = 900,
        phone: bool = False,
    ) -> None:
        ours, (self._in, theirs) = os.pipe(), os.pipe()
        self._out = ours[1]
        preparation = f'exec 3<&{ours[0]} 4>&{theirs}; exec "$@"'
        arguments = [
            program, "--headless", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run",
            "--disable-dev-shm-usage", "--enable-unsafe-swiftshader", "--use-angle=swiftshader",
            f"--user-data-dir={folder}", f"--window-size={width},{height}",
        ]  # fmt: skip
        self._process = subprocess.Popen(
            ["bash", "-c", preparation, "bash", *arguments], pass_fds=(ours[0], theirs),
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(ours[0])
        os.close(theirs)
        self._rest, self._number, self._page, self._phone = b"", 0, None, phone
        self.errors: list[str] = []
        target = self._call("Target.createTarget", url="about:blank")["targetId"]
        attached = self._call("Target.attachToTarget", targetId=target, flatten=True)
        self._page = attached["sessionId"]
        self._call("Runtime.enable")
        self._call("Log.enable")
        self._call("Page.enable")
        self.resize(width, height)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._process.kill()
        self._process.wait()
        os.close(self._in)
        os.close(self._out)

    def _call(self, method: str, **parameters: Any) -> Any:
        self._number += 1
        asked: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if self._page is not None:
            asked["sessionId"] = self._page
        os.write(self._out, json.dumps(asked).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._number:
                assert "error" not in answer, answer["error"]
                return answer["result"]
            if answer.get("method") == "Runtime.exceptionThrown":
                self.errors.append(json.dumps(answer["params"]["exceptionDetails"])[:1000])
            if answer.get("method") == "Log.entryAdded":
                self.errors.append(json.dumps(answer["params"]["entry"])[:1000])

    def _next(self) -> Any:
        while b"\0" not in self._rest:
            read = os.read(self._in, 1 << 20)
            assert read, "the browser has died"
            self._rest += read
        line, _, self._rest = self._rest.partition(b"\0")
        return json.loads(line)

    def open(self, address: str) -> None:
        self._call("Page.navigate", url=address)

    def resize(self, width: int, height: int) -> None:
        self._call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
            mobile=self._phone,
        )  # fmt: skip

    def value(self, script: str) -> Any:
        """Return the value of an expression in the page."""
        found = self._call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def wait_for(self, script: str) -> Any:
        """Wait until an expression is true, and return it."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            found = self.value(script)
            if found:
                return found
            time.sleep(0.05)
        text = self.value("document.body.innerText")
        raise AssertionError(f"{script} was never true; {self.errors}\n{text}")

    def click(self, x: float, y: float) -> None:
        """Press and release the mouse at a place of the window."""
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self._call(
                "Input.dispatchMouseEvent", type=kind, x=x, y=y, clickCount=1,
                button="none" if kind == "mouseMoved" else "left",
            )  # fmt: skip

    def press(self, element: str) -> None:
        """Click the middle of an element that is seen, by its CSS selector, as a hand would.

        Args:
            element: its selector; it must not be covered, and a button must not be off.
        """
        found = f"document.querySelector({json.dumps(element)})"
        self.wait_for(f"{found} && !{found}.disabled && {found}.getBoundingClientRect().width > 0")
        for _ in range(TRIES):
            x, y, seen = self.value(
                f"(() => {{ const e = {found}; e.scrollIntoView({{ block: 'center' }});"
                "const b = e.getBoundingClientRect();"
                "const [x, y] = [b.left + b.width / 2, b.top + b.height / 2];"
                "window.pressed = false;"
                "e.addEventListener('mousedown', () => { window.pressed = true; }, { once: true });"
                "return [x, y, e.contains(document.elementFromPoint(x, y))]; })()"
            )
            assert seen, f"{element} is covered"
            self.click(x, y)
            if self.value("window.pressed"):
                return
        raise AssertionError(f"{element} moved away under the mouse {TRIES} times")

    def enter(self, element: str, text: str) -> None:
        """Type a text into a field in place of what stands there, and leave it by the tab key."""
        self.press(element)
        self._key("a", "KeyA", 65, modifiers=2, commands=["selectAll"])
        self._call("Input.insertText", text=text)
        self._key("Tab", "Tab", 9)

    def write(self, element: str, text: str) -> None:
        """Type a text behind all that stands in a field of many lines."""
        self.press(element)
        self._key("End", "End", 35, modifiers=2, commands=["moveToEndOfDocument"])
        self._call("Input.insertText", text=text)

    def choose(self, element: str, value: str) -> None:
        """Choose one of the values of a list, as its keys do; its drop-down is no part of pages."""
        self.press(element)
        # in one go: between two of them the page may set the list back
        chosen = self.value(
            f"(() => {{ const e = document.querySelector({json.dumps(element)});"
            f"e.value = {json.dumps(value)}; const chosen = e.value;"
            "e.dispatchEvent(new Event('change')); return chosen; })()"
        )
        assert chosen == value, f"{element} has no {value}"

    def _key(self, key: str, code: str, number: int, **more: Any) -> None:
        pressed = {"key": key, "code": code, "windowsVirtualKeyCode": number}
        self._call("Input.dispatchKeyEvent", type="rawKeyDown", **pressed, **more)
        self._call("Input.dispatchKeyEvent", type="keyUp", **pressed)

    def picture(self, path: Path, whole: bool = True) -> None:
        """Write what is seen into a file, .png."""
        data = self._call("Page.captureScreenshot", captureBeyondViewport=whole)["data"]
        path.write_bytes(base64.b64decode(data))

    def picture_of(self, path: Path, element: str, height: float | None = None) -> None:
        """Write what an element shows into a file, .png.

        Args:
            path: of the file.
            element: CSS selector.
            height: of what is taken from its top [pixels]; None: all of it.
        """
        found = f"document.querySelector({json.dumps(element)}).getBoundingClientRect()"
        box = self.value(f"(b => [b.x + scrollX, b.y + scrollY, b.width, b.height])({found})")
        x, y, width, whole = box
        clip = {"x": x, "y": y, "width": width, "height": height or whole, "scale": 1}
        shot = self._call("Page.captureScreenshot", clip=clip, captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(shot["data"]))
