"""Headless Chromium without a GPU, driven over its DevTools protocol.

Not by Playwright: that has Chromium repeat every WebSocket message to it, which takes as much of
the machine as what is measured.
"""

import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
PATIENCE_S = 120.0
ARGUMENTS = (
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-extensions",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--window-size=1440,900",
    "--remote-debugging-port=0",
)


def find_chromium() -> str | None:
    """Return the program: the one named by RECON_CHROMIUM, the system's, or Playwright's."""
    named = os.environ.get("RECON_CHROMIUM")
    cache = Path.home() / ".cache" / "ms-playwright"
    found = [named, *map(shutil.which, NAMES), *map(str, cache.glob("chromium-*/chrome-*/chrome"))]
    return next((path for path in found if path is not None and Path(path).is_file()), None)


class Page:
    """One tab with a profile of its own."""

    def __init__(self, browser: "Browser", context: str, session: str) -> None:
        self._browser = browser
        self._context = context
        self._session = session

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        """Send a command to the tab; return its result."""
        return self._browser.call(method, self._session, **params)

    def evaluate(self, expression: str) -> Any:
        """Return an expression's value, waiting for a promise."""
        asked = {"expression": expression, "returnByValue": True, "awaitPromise": True}
        result = self.call("Runtime.evaluate", **asked)
        if "exceptionDetails" in result:
            raise RuntimeError(f"expected a value of {expression}, got {result}")
        return result["result"].get("value")

    def wait_for(self, expression: str) -> Any:
        """Wait until an expression is true; return its value."""
        end_s = time.monotonic() + PATIENCE_S
        while not (value := self.evaluate(expression)):
            if time.monotonic() > end_s:
                raise RuntimeError(f"expected {expression} within {PATIENCE_S:g} s")
            time.sleep(0.2)
        return value

    def metrics(self) -> dict[str, float]:
        """Return the tab's counters: seconds in tasks, in scripts, in layout."""
        told = self.call("Performance.getMetrics")["metrics"]
        return {one["name"]: one["value"] for one in told}

    def heap_bytes(self) -> int:
        """Return the used heap after a collection."""
        self.call("HeapProfiler.collectGarbage")
        return int(self.call("Runtime.getHeapUsage")["usedSize"])

    def close(self) -> None:
        """Close the tab, and forget its profile."""
        self._browser.call("Target.disposeBrowserContext", browserContextId=self._context)


class Browser:
    """A running browser."""

    def __init__(self, connection: ClientConnection) -> None:
        self._connection = connection
        self._number = 0

    def call(self, method: str, session: str | None = None, **params: Any) -> dict[str, Any]:
        """Send a command; return its result. Events are dropped."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": params}
        self._connection.send(json.dumps(message | ({"sessionId": session} if session else {})))
        while (answer := json.loads(self._connection.recv(PATIENCE_S))).get("id") != self._number:
            pass
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']}")
        return dict(answer["result"])

    def open(self, url: str, probe: str) -> Page:
        """Open a page in a new profile, with a script that runs before its own."""
        context = self.call("Target.createBrowserContext")["browserContextId"]
        asked = {"url": "about:blank", "browserContextId": context}
        target = self.call("Target.createTarget", **asked)["targetId"]
        attached = self.call("Target.attachToTarget", targetId=target, flatten=True)
        page = Page(self, context, attached["sessionId"])
        for domain in ("Page", "Performance"):
            page.call(f"{domain}.enable")
        page.call("Page.addScriptToEvaluateOnNewDocument", source=probe)
        page.call("Page.navigate", url=url)
        return page


@contextmanager
def running_browser(program: str) -> Iterator[Browser]:
    """Run a browser with an empty profile."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        process = subprocess.Popen(
            [program, *ARGUMENTS, f"--user-data-dir={folder}", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            # Where the program is a script, the browser is its child: both are ended.
            start_new_session=True,
        )
        try:
            address = _address(Path(folder) / "DevToolsActivePort", process)
            with connect(address, max_size=None, compression=None) as connection:
                yield Browser(connection)
        finally:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait(PATIENCE_S)


def _address(file: Path, process: subprocess.Popen[bytes]) -> str:
    end_s = time.monotonic() + PATIENCE_S
    while not file.exists() or file.read_text().count("\n") < 1:
        if process.poll() is not None or time.monotonic() > end_s:
            raise RuntimeError(f"expected a browser, got exit code {process.returncode}")
        time.sleep(0.05)
    port, path = file.read_text().split("\n")
    return f"ws://127.0.0.1:{port}{path}"
