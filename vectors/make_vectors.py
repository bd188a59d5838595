"""Writes the golden packets of this folder from the document (docs/icd.md), with `struct` alone.

It knows nothing of the encoder, so that both can be checked against each other:

    python vectors/make_vectors.py [FOLDER]      # default: the folder of this file

`<packet>/<case>.bin` is one frame and `<case>.json` its fields: integers as they are, floats as the
hex of their bits, text as hex, files and pixels as SHA-256. `bad/<case>.bin` is a damaged stream;
its `.json` says how decoding it as one frame fails (`decode`), which frames a deframer must still
find (`frames`, as hex) and which counters it must show once the stream has ended.
"""

import json
import sys
from pathlib import Path

from bad import Bad, bad_frames, bad_streams
from document import frame
from golden import golden


def expectation(bad: Bad) -> dict[str, object]:
    """The JSON of a damaged stream."""
    skipped = len(bad.stream) - sum(map(len, bad.frames))
    counters = {"bytes_skipped": skipped} | bad.counters
    return {"decode": bad.decode, "frames": [f.hex() for f in bad.frames], "counters": counters}


def write(folder: Path, name: str, data: bytes, description: dict[str, object]) -> None:
    """Writes one vector: its bytes and its description."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.bin").write_bytes(data)
    text = json.dumps(description, indent=1, sort_keys=True)
    (folder / f"{name}.json").write_text(text + "\n", encoding="ascii")


def main(root: Path) -> None:
    """Writes every vector below `root`."""
    for folder, name, pid, payload, fields in golden():
        write(root / folder, name, frame(pid, payload), {"pid": pid, "fields": fields})
    for cases in (bad_frames, bad_streams):
        for name, case in cases():
            write(root / "bad", name, case.stream, expectation(case))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
