"""Pages in headless Chromium, driven through its debugging pipe: no package and no port is needed."""

from __future__ import annotations

import base64
import importlib.util
import io
import json
import os
import shutil
import subprocess
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pytest
from PIL import Image

if TYPE_CHECKING:
    from numpy.typing import NDArray

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
needs_browser = pytest.mark.skipif(BROWSER is None, reason="no Chromium: apt install chromium")

SETTLED = """Promise.all(document.getAnimations().filter((one) => one instanceof CSSTransition)
  .map(({ finished }) => finished.catch(() => null))).then(() => true)"""
AXE = """axe.run(document, { resultTypes: ["violations"], iframes: false }).then((found) => found.violations
  .filter(({ impact }) => impact === "serious" || impact === "critical")
  .map(({ id, nodes }) => [id, nodes.length, nodes[0].html.slice(0, 200)]))"""
MIDDLE = """(async () => {{
  let page = document, left = 0, top = 0;
  if ({frame}) {{
    const frame = document.querySelector({frame});
    page = frame.contentDocument;
    page.querySelector({selector}).scrollIntoView({{ block: "center", behavior: "instant" }});
    ({{ left, top }} = frame.getBoundingClientRect());
  }}
  const found = page.querySelector({selector});
  if (!{frame}) found.scrollIntoView({{ block: "center", behavior: "instant" }});
  const box = found.getBoundingClientRect();
  return [left + box.x + box.width / 2, top + box.y + box.height / 2];
}})()"""


class LeftError(RuntimeError):
    """The page was left before it could answer."""


class Browser:
    """One page of one Chromium without a network; errors in the page's scripts are errors here."""

    def __init__(self, folder: Path) -> None:
        assert BROWSER is not None
        to_browser, self._input = os.pipe()
        self._output, from_browser = os.pipe()
        # Chromium reads what is asked at descriptor 3 and answers at 4.
        command = f'exec "$0" "$@" 3<&{to_browser} 4>&{from_browser}'
        flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", "--mute-audio"]
        flags += [f"--user-data-dir={folder / 'profile'}", "--no-first-run", "--disable-extensions"]
        flags += ["--disable-dev-shm-usage", "--host-resolver-rules=MAP * ~NOTFOUND"]  # no network
        flags += ["--allow-file-access-from-files"]  # of a page, what is in its frames
        flags += ["--disable-features=BackForwardCache"]  # pages that are left are not kept
        self._process = subprocess.Popen(
            ["bash", "-c", command, BROWSER, *flags, "about:blank"],
            pass_fds=(to_browser, from_browser),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_browser)
        os.close(from_browser)
        self._pending, self._number, self._session = b"", 0, ""
        self.faults: list[str] = []
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime"):
            self.ask(f"{domain}.enable")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self._session = ""
            self.ask("Browser.close")
        except (OSError, EOFError):
            pass
        os.close(self._input)
        os.close(self._output)
        self._process.wait(timeout=30)

    def ask(self, method: str, **parameters: Any) -> Any:
        """Send a command and wait for its answer; what the page has to tell meanwhile is heeded."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._input, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._number:
                if "error" in answer:
                    kind = LeftError if "navigated" in answer["error"]["message"] else RuntimeError
                    raise kind(f"{method}: {answer['error']}")
                return answer["result"]
            if answer.get("method") == "Runtime.exceptionThrown":
                details = answer["params"]["exceptionDetails"]
                self.faults.append(details.get("exception", {}).get("description", details["text"]))

    def _next(self) -> Any:
        while b"\0" not in self._pending:
            more = os.read(self._output, 1 << 16)
            if not more:
                raise EOFError("Chromium has ended")
            self._pending += more
        text, self._pending = self._pending.split(b"\0", 1)
        return json.loads(text)

    def run(self, script: str) -> Any:
        """Give the value of an expression in the page."""
        found = self.ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in found, found
        assert not self.faults, self.faults
        return found["result"].get("value")

    def wait(self, script: str) -> None:
        """Wait until an expression is true."""
        for _ in range(400):
            try:
                if self.run(script):
                    return
            except LeftError:  # the next page is asked
                pass
            time.sleep(0.025)
        raise AssertionError(f"never true: {script}")

    def screen(
        self, width: int, height: int, *, touch: bool = False, dark: bool = False, still: bool = False
    ) -> None:
        """Give the page the screen of a device, and its user's wishes."""
        self.ask(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=touch,
        )
        self.ask("Emulation.setTouchEmulationEnabled", enabled=touch)
        features = {"prefers-color-scheme": "dark" if dark else "light"}
        features["prefers-reduced-motion"] = "reduce" if still else "no-preference"
        self.ask(
            "Emulation.setEmulatedMedia", features=[{"name": k, "value": v} for k, v in features.items()]
        )

    def open(self, page: Path, hash_: str = "") -> None:
        """Show a page from its beginning."""
        self.ask("Page.navigate", url="about:blank")
        # Chromium leaves a command unanswered that comes between leaving a page and showing the next.
        self.wait("location.protocol === 'about:' && document.readyState === 'complete'")
        self.faults.clear()
        self.ask("Page.navigate", url=page.as_uri() + hash_)
        self.wait("location.protocol === 'file:' && document.readyState === 'complete'")

    def serious_faults(self) -> list[Any]:
        """What axe-core finds in the page that is serious: its rule, how often, the first place."""
        found = importlib.util.find_spec("axe_playwright_python")
        if found is None or found.origin is None:
            pytest.skip("no axe-core: pip install --no-deps axe-playwright-python")
        self.run(SETTLED)  # colours of half a transition are no fault
        self.run(Path(found.origin).with_name("axe.min.js").read_text("utf-8") + "; null")
        faults: list[Any] = self.run(AXE)
        return faults

    def picture(self) -> NDArray[np.int64]:
        """Give what is seen, shape (height, width, 3)."""
        data = self.ask("Page.captureScreenshot", format="png")["data"]
        image = Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")
        return np.asarray(image).astype(np.int64)

    def key(self, name: str, text: str = "") -> None:
        for kind in ("keyDown", "keyUp"):
            self.ask("Input.dispatchKeyEvent", type=kind, key=name, text=text if kind == "keyDown" else "")

    def click(self, selector: str, *, frame: str = "") -> None:
        """Press the mouse in the middle of what a selector finds, within a frame of the page where asked."""
        at = self.middle(selector, frame=frame)
        self._mouse("mousePressed", at)
        self._mouse("mouseReleased", at)

    def middle(self, selector: str, *, frame: str = "") -> tuple[float, float]:
        """Where on the screen the middle of what a selector finds is, after scrolling there."""
        x, y = self.run(MIDDLE.format(selector=json.dumps(selector), frame=json.dumps(frame)))
        return x, y

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        self._mouse("mousePressed", start)
        for part in (0.5, 1.0):
            self._mouse(
                "mouseMoved", (start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1]))
            )
        self._mouse("mouseReleased", end)

    def _mouse(self, kind: str, at: tuple[float, float]) -> None:
        self.ask(
            "Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], button="left", buttons=1, clickCount=1
        )

    def touch(self, kind: str, *points: tuple[float, float]) -> None:
        self.ask("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y} for x, y in points])
