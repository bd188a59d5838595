"""`recon tag --nodeodm` against a small NodeODM on loopback that keeps what it was sent."""

import io
import json
import re
import threading
import zipfile
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from tests.product.made_flight import ONE, flight, write_card, write_record
from typer.testing import CliRunner

from recon.cli import nodeodm
from recon.cli.commands import app
from recon.cli.nodeodm import opened_node, process
from recon.model.errors import RecordError

RUNNING, FAILED, COMPLETED = 20, 30, 40


class FakeNode(ThreadingHTTPServer):
    """The part of NodeODM's interface that a task needs."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Answers)
        self.files: dict[str, bytes] = {}
        self.states = [RUNNING, RUNNING, COMPLETED]
        self.identity = "11111111-2222"
        self.result = {"odm_orthophoto/odm_orthophoto.tif": b"mosaic", "log.json": b"{}"}
        self.url = f"http://127.0.0.1:{self.server_port}"


class Answers(BaseHTTPRequestHandler):
    server: FakeNode

    def do_GET(self) -> None:
        if self.path.startswith("/info"):
            return self._json({"version": "2.2.4", "taskQueueCount": 0, "engine": "odm"})
        if self.path.startswith(f"/task/{self.server.identity}/info"):
            states = self.server.states
            code = states.pop(0) if len(states) > 1 else states[0]
            status = {"code": code, "errorMessage": "not enough features"}
            facts = {"uuid": "", "name": "", "dateCreated": 0, "processingTime": 0, "options": []}
            return self._json(facts | {"status": status, "imagesCount": 1, "progress": 50})
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w") as written:
            for name, data in self.server.result.items():
                written.writestr(name, data)
        return self._send(archive.getvalue(), "application/zip")

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        # By its content: with a task's name of dots its path is another.
        if b"filename=" in body:
            (name,) = re.findall(rb'filename="([^"]+)"', body)
            data = body.split(b"\r\n\r\n", 1)[1].rsplit(b"\r\n--", 1)[0]
            self.server.files[name.decode()] = data
            return self._json({"success": True})
        return self._json({"uuid": self.server.identity})

    def _json(self, value: object) -> None:
        self._send(json.dumps(value).encode(), "application/json")

    def _send(self, data: bytes, kind: str) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, *_words: object) -> None:
        """Say nothing."""


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeNode]:
    monkeypatch.setattr(nodeodm, "ASK_EVERY_S", 0.0)
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    server = FakeNode()
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield server
    server.shutdown()
    thread.join()
    server.server_close()


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = tmp_path / "odm"
    (folder / "images").mkdir(parents=True)
    for name in ("a.JPG", "a_mask.JPG", "b.JPG"):
        (folder / "images" / name).write_bytes(name.encode() * 20)
    (folder / "geo.txt").write_text("EPSG:4326\n")
    return folder


def test_all_files_arrive_and_the_result_is_unpacked(node: FakeNode, project: Path) -> None:
    (project / "result").mkdir()
    (project / "result" / "older.tif").touch()
    process(opened_node(node.url), project)
    sent = {path.name: path.read_bytes() for path in (project / "images").iterdir()}
    assert node.files == sent | {"geo.txt": b"EPSG:4326\n"}
    found = sorted(
        path.relative_to(project).as_posix() for path in (project / "result").rglob("*.*")
    )
    assert found == ["result/log.json", "result/odm_orthophoto/odm_orthophoto.tif"]
    assert sorted(path.name for path in project.iterdir()) == ["geo.txt", "images", "result"]


def test_an_ended_run_waits_for_its_task_again_and_other_files_make_another(
    node: FakeNode, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ended(*_words: object, **_more: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("pyodm.Task.wait_for_completion", ended)
        with pytest.raises(KeyboardInterrupt):
            process(opened_node(node.url), project)
    assert len(node.files) == 4
    node.files.clear()
    node.states = [RUNNING, COMPLETED]
    process(opened_node(node.url), project)
    assert node.files == {}
    assert (project / "result" / "log.json").is_file()
    assert not (project / "nodeodm-task.json").exists()
    with monkeypatch.context() as patch:
        patch.setattr("pyodm.Task.wait_for_completion", ended)
        with pytest.raises(KeyboardInterrupt):
            process(opened_node(node.url), project)
    (project / "images" / "a_mask.JPG").write_bytes(b"another mask of the photo")
    node.files.clear()
    process(opened_node(node.url), project)
    assert len(node.files) == 4


def test_a_task_that_fails_says_why_and_keeps_the_older_result(
    node: FakeNode, project: Path
) -> None:
    (project / "result").mkdir()
    (project / "result" / "older.tif").touch()
    node.states = [RUNNING, FAILED]
    with pytest.raises(
        RecordError, match=r"did not finish task 11111111-2222: not enough features"
    ):
        process(opened_node(node.url), project)
    assert (project / "result" / "older.tif").is_file()


@pytest.mark.parametrize("identity", ["../../away", "", "x" * 99])
def test_a_task_whose_name_is_none_is_refused(node: FakeNode, project: Path, identity: str) -> None:
    node.identity = identity
    with pytest.raises(RecordError, match="did not take the photos"):
        process(opened_node(node.url), project)


def test_no_file_of_an_archive_lies_outside(node: FakeNode, project: Path) -> None:
    node.result = {"../../evil.txt": b"x", "/tmp/evil.txt": b"x", "good.txt": b"x"}
    process(opened_node(node.url), project)
    assert not list(project.parent.glob("evil.txt"))
    assert not (project / "evil.txt").exists()
    assert (project / "result" / "good.txt").is_file()


def test_an_archive_of_endless_size_is_refused(
    node: FakeNode, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(nodeodm, "MOST_BYTES", 3)
    with pytest.raises(RecordError, match="more than any result"):
        process(opened_node(node.url), project)
    assert not (project / "result").exists()


@pytest.mark.parametrize(
    ("url", "sentence"),
    [
        ("localhost:3000", "expected an address as http://localhost:3000"),
        ("ftp://node", "expected an address"),
        ("http://", "expected an address"),
        ("http://node:port", "expected an address"),
        ("https://node:3000", "https is possible on port 443 only"),
        ("http://node:443", "https is possible on port 443 only"),
        ("http://127.0.0.1:9?token=secret", "no answer: start one .*docker run"),
    ],
)
def test_an_address_without_a_node_is_refused_with_what_to_do(url: str, sentence: str) -> None:
    with pytest.raises(RecordError, match=sentence) as refused:
        opened_node(url)
    assert "secret" not in str(refused.value)


def test_the_command_asks_first_and_ends_with_the_result(node: FakeNode, tmp_path: Path) -> None:
    write_card(tmp_path / "card", 0.0, (ONE,), every=6)
    record = write_record(flight(), tmp_path / "flight.mcap")
    words = ["tag", str(tmp_path / "card"), "--flight", str(record), "--out", str(tmp_path / "out")]
    refused = CliRunner().invoke(app, [*words, "--nodeodm", "http://127.0.0.1:9"])
    assert "expected a NodeODM at http://127.0.0.1:9" in refused.stderr
    assert refused.exit_code == 1
    assert not (tmp_path / "out").exists()
    done = CliRunner().invoke(app, [*words, "--nodeodm", node.url])
    assert done.exit_code == 0, done.output
    assert node.files.keys() == {path.name for path in (tmp_path / "out/odm/images").iterdir()}
    assert (tmp_path / "out/odm/result/odm_orthophoto/odm_orthophoto.tif").read_bytes() == b"mosaic"
