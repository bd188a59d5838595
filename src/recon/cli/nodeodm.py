"""Handing a tagged project to a NodeODM that the user runs, and fetching its result.

The node may be anybody's server: what it sends is bounded, and its archive is unpacked into a new
folder that takes the place of an earlier result when it is complete. pyodm is imported on use:
other commands need no HTTP client of its kind.
"""

import json
import re
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from rich.console import Console
from rich.progress import Progress

from recon.cli.output import printable
from recon.model.errors import RecordError
from recon.model.extras import from_extra
from recon.product.linked_folder import put_in_place
from recon.product.odm import GEO
from recon.product.write import write_text

if TYPE_CHECKING:
    from pyodm import Node, Task
    from pyodm.types import TaskInfo

RESULT, TASK = "result", "nodeodm-task.json"
MOST_FILES, MOST_BYTES = 500_000, 1 << 40
"""Of an unpacked result: an orthophoto of a large field has some gigabytes."""
ASK_EVERY_S = 3.0
START_ONE = "docker run -p 3000:3000 opendronemap/nodeodm"


def opened_node(url: str) -> "Node":
    """Return a NodeODM that answers; raises `RecordError` with what to do."""
    with from_extra("nodeodm", "--nodeodm"):
        from pyodm import Node

    place = _place(url)
    node = Node.from_url(url)
    with _said(f"expected a NodeODM at {place}, got no answer: start one ({START_ONE})"):
        node.info()
    return node


def _place(url: str) -> str:
    """Return where a node is, without its token; raises `RecordError` for what is no address."""
    expected = "--nodeodm: expected an address as http://localhost:3000"
    try:
        parts = urlsplit(url)
        port = parts.port
    except ValueError as problem:
        raise RecordError(f"{expected}, got {printable(url)!r:.80}") from problem
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise RecordError(f"{expected}, got {printable(url)!r:.80}")
    if (parts.scheme == "https") != (port == 443 or (port is None and parts.scheme == "https")):
        # pyodm takes the scheme from the port: it would send photos and token unencrypted.
        raise RecordError("--nodeodm: https is possible on port 443 only, and http on others")
    return f"{parts.scheme}://{parts.hostname}" + (f":{port}" if port else "")


class NodeError(RecordError):
    """A NodeODM that does not answer, or not as its interface has it."""

    is_failure = True


def process(node: "Node", project: Path) -> None:
    """Send a project's photos and masks, wait for the result and fetch it; raises `RecordError`.

    A task of an earlier run with the same files is waited for instead, as long as the node has it.
    """
    files = sorted((project / "images").iterdir())
    files += [path for path in [project / GEO] if path.is_file()]
    key = _key(node, files)
    with Progress(
        console=Console(stderr=True), disable=not Console(stderr=True).is_terminal
    ) as bar:
        task = _earlier(node, project, key)
        if task is None:
            task = _sent(node, files, bar)
            print(f"NodeODM: {len(files)} files sent, task {task.uuid}")
            kept = json.dumps({"key": key, "task": task.uuid})
            write_text(project / TASK, kept)
        else:
            print(f"NodeODM: task {task.uuid} of an earlier run goes on")
        _wait(task, bar)
        with _said("the NodeODM's result could not be fetched"):
            _fetch(task, project / RESULT, bar)
    (project / TASK).unlink(missing_ok=True)
    print(f"NodeODM: result in {project / RESULT}")


def _sent(node: "Node", files: Sequence[Path], bar: Progress) -> "Task":
    sending = bar.add_task("sending", total=100.0)
    with _said("the NodeODM did not take the photos"):
        task = node.create_task(
            [str(path) for path in files],
            name="Recon",
            progress_callback=lambda done: bar.update(sending, completed=done),
        )
        _check_identity(task)
    return task


def _key(node: "Node", files: Sequence[Path]) -> str:
    """Return what a task is known by: the node, and the files by name and size, small ones
    whole."""
    digest = sha256(f"{node.host}:{node.port}".encode())
    for path in files:
        is_small = path.name == GEO or path.stem.endswith("_mask")
        facts = path.read_bytes() if is_small else str(path.stat().st_size).encode()
        digest.update(path.name.encode() + b"\0" + sha256(facts).digest())
    return digest.hexdigest()


def _earlier(node: "Node", project: Path, key: str) -> "Task | None":
    """Return the task that an earlier run has sent, if the node still has it and it did not
    fail."""
    from pyodm.exceptions import OdmError
    from pyodm.types import TaskStatus

    try:
        kept = json.loads((project / TASK).read_text(encoding="utf-8"))
        if kept["key"] != key:
            return None
        task = node.get_task(kept["task"])
        _check_identity(task)
        is_good = task.info().status not in (TaskStatus.FAILED, TaskStatus.CANCELED)
    except (OdmError, OSError, ValueError, KeyError, TypeError):
        return None
    return task if is_good else None


def _check_identity(task: "Task") -> None:
    if not re.fullmatch(r"[\w-]{1,64}", str(task.uuid)):
        raise ValueError("its task has a name that is none")


def _wait(task: "Task", bar: Progress) -> None:
    running = bar.add_task("processing", total=100.0)
    last = ""

    def show(info: "TaskInfo") -> None:
        nonlocal last
        bar.update(running, completed=float(info.progress))
        last = printable(str(info.last_error))[:200]

    with _said(f"the NodeODM did not finish task {task.uuid}", lambda: last):
        try:
            task.wait_for_completion(show, interval=ASK_EVERY_S)
        except KeyboardInterrupt:
            print(f"NodeODM: task {task.uuid} goes on; the same command waits for it again")
            raise


def _fetch(task: "Task", result: Path, bar: Progress) -> None:
    fetching = bar.add_task("fetching", total=100.0)
    with TemporaryDirectory(dir=result.parent, prefix=".result-") as name:
        path = task.download_zip(
            name, progress_callback=lambda done: bar.update(fetching, completed=done)
        )
        coming = Path(name) / "all"
        with zipfile.ZipFile(path) as archive:
            _refuse_excess(archive)
            archive.extractall(coming)
        put_in_place(coming, result)


def _refuse_excess(archive: zipfile.ZipFile) -> None:
    files = archive.infolist()
    size = sum(each.file_size for each in files)
    if len(files) > MOST_FILES or size > MOST_BYTES:
        raise ValueError(
            f"its archive has {len(files)} files of {size} bytes, more than any result"
        )


@contextmanager
def _said(sentence: str, reason: Callable[[], str] = str) -> Iterator[None]:
    """Raise `RecordError` with a sentence, and with the reason, for whatever a node may do."""
    from pyodm.exceptions import OdmError
    from requests import RequestException

    try:
        yield
    except (OdmError, RequestException, zipfile.BadZipFile, OSError) as problem:
        raise NodeError(f"{sentence}: {_text(reason() or problem)}") from problem
    except (ValueError, KeyError, TypeError, AttributeError) as problem:
        # What pyodm raises where an answer is not as the interface has it.
        raise NodeError(f"{sentence}: unexpected answer ({_text(problem)})") from problem


def _text(problem: object) -> str:
    """Return a problem in a few words, without the token that its address may have."""
    words = re.sub(r"token=[^&\s]*", "token=...", printable(str(problem)))
    return words[:200] or type(problem).__name__
