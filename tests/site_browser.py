"""The site in a browser: a page of ours loads each page of it in a frame and posts what it measures."""

from __future__ import annotations

import http.server
import json
import queue
import shutil
import subprocess
import tempfile
import threading
from pathlib import Path
from typing import Any

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
HARNESS = """<!doctype html><meta charset="utf-8"><title>harness</title><script>
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
async function opened(url, width, height) {
  const frame = document.createElement("iframe");
  Object.assign(frame, {width, height, style: "border: 0"});
  await new Promise((done) => { frame.onload = done; frame.src = url; document.body.append(frame); });
  return frame;
}
async function run(tasks) {
  const answers = [];
  const queue = tasks.map((task, k) => [k, ...task]);
  const worker = async () => {
    while (queue.length) await one(...queue.shift());
  };
  async function one(k, url, width, height, code) {
    const frame = await opened(url, width, height);
    const page = frame.contentDocument;
    try {
      const measure = new Function("page", "view", "wait", "axe", "return (async () => {" + code + "})()");
      answers[k] = await measure(page, frame.contentWindow, wait, AXE);
    } catch (error) { answers[k] = {error: String(error)}; }
    frame.remove();
  }
  await Promise.all([worker(), worker(), worker(), worker()]);
  await fetch("/answers", {method: "POST", body: JSON.stringify(answers)});
}
const AXE = async (view) => {
  if (!view.axe) {
    const script = view.document.createElement("script");
    script.src = "/axe.min.js";
    const loaded = new Promise((done, failed) => { script.onload = done; script.onerror = failed; });
    view.document.head.append(script);
    await loaded;
  }
  return view.axe;
};
addEventListener("load", async () => run(await (await fetch("/tasks")).json()));
</script><body></body>"""

Task = tuple[str, int, int, str]
"""Address, width, height, and the body of a function of ``page``, ``view``, ``wait`` and ``axe``."""


def answers(site: Path, tasks: list[Task], axe: Path | None = None, timeout: float = 100.0) -> list[Any]:
    """What the code of each task gives for its page; nothing but the site can be reached."""
    assert CHROMIUM
    given: queue.Queue[list[Any]] = queue.Queue()

    class Handler(http.server.SimpleHTTPRequestHandler):
        def __init__(self, *arguments: Any) -> None:
            super().__init__(*arguments, directory=str(site))

        def do_GET(self) -> None:
            ours = {"/harness": HARNESS.encode(), "/tasks": json.dumps(tasks).encode()}
            if axe:
                ours["/axe.min.js"] = axe.read_bytes()
            body = ours.get(self.path)
            if body is None:
                super().do_GET()
                return
            self.send_response(200)
            kind = {"/harness": "text/html", "/tasks": "application/json"}.get(self.path, "text/javascript")
            self.send_header("Content-Type", f"{kind}; charset=utf-8")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            self.send_response(204)
            self.end_headers()
            given.put(json.loads(body))

        def log_message(self, *_: Any) -> None:
            pass

    with (
        http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server,
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile,
    ):
        threading.Thread(target=server.serve_forever, daemon=True).start()
        command = [
            CHROMIUM,
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
            "--remote-debugging-port=0",
            "--window-size=1400,1000",
            f"--user-data-dir={profile}",
            f"http://127.0.0.1:{server.server_port}/harness",
        ]
        browser = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            return given.get(timeout=timeout)
        finally:
            browser.terminate()
            browser.wait(timeout=20)
            server.shutdown()
