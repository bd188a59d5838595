"""Data lines of small, hand-edited, untrusted text files."""

from dataclasses import dataclass
from pathlib import Path

from recon.camera.errors import CameraError

LARGEST_FILE_BYTES = 64 * 1024
"""Real files have under 2 KiB; anything much larger is a wrong file."""

SHOWN_CHARACTERS = 60


@dataclass(frozen=True, slots=True)
class DataLine:
    """A line that is neither empty nor a comment; `number` counts from 1."""

    number: int
    text: str


def read_small_text(path: Path, error: type[CameraError]) -> str:
    """Return the text of a UTF-8 file; raises `error` when it cannot be one."""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE_BYTES + 1)
    except OSError as problem:
        raise error(
            f"{path}: expected a readable file, got: {problem.strerror or problem}; check the name "
            "in site.toml"
        ) from problem
    if len(data) > LARGEST_FILE_BYTES:
        raise error(
            f"{path}: expected at most {LARGEST_FILE_BYTES} bytes, got more; is it the right file?"
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = data[: problem.start].count(b"\n") + 1
        raise error(
            f"{path}, line {line}: expected UTF-8 text, got byte 0x{data[problem.start]:02x}; "
            "save the file as plain text"
        ) from problem


def data_lines(text: str) -> list[DataLine]:
    """Return the lines that carry data; a comment starts with # and fills its line."""
    # str.splitlines also splits at form feeds and the like: line numbers would differ from an
    # editor's.
    numbered = enumerate(text.split("\n"), start=1)
    stripped = (DataLine(number, line.strip()) for number, line in numbered)
    return [line for line in stripped if line.text and not line.text.startswith("#")]


def shown(text: str) -> str:
    """Return the text quoted, shortened and without control characters, for a message."""
    short = text if len(text) <= SHOWN_CHARACTERS else text[:SHOWN_CHARACTERS] + "..."
    return ascii(short)
