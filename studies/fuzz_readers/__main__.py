"""Fuzzes the readers of other people's files and bytes.

    python -m studies.fuzz_readers                         # all, 100,000 inputs each
    python -m studies.fuzz_readers photo --runs 1000000
    python -m studies.fuzz_readers photo --input FILE      # one input, with its traceback

Each reader may raise the error that it documents and nothing else, in a minute and 2 GiB. Another
error is printed once for each place and kept with its input in build/fuzz/READER/found/; the search
goes on. Inputs that reach new code are kept in build/fuzz/READER/inputs/, for the next run. Needs
the group `fuzz` (`make fuzz-readers`).
"""

import argparse
import os
import re
import subprocess
import sys
import time
import traceback
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
MOST_S, MOST_MEMORY_MB = 60, 2_048
GUIDED_BY = ["recon", "mcap", "numpy.lib", "PIL", "pmtiles", "zipfile"]
"""Packages whose coverage guides the search: ours, and what parses in Python for us."""
MEMORY = Path("/dev/shm")
"""Files of single inputs are written there, not to a disk."""


def main() -> int:
    """Fuzz the chosen readers, each in a process of its own; return 1 if anything was found."""
    parser = argparse.ArgumentParser()
    parser.add_argument("readers", nargs="*")
    parser.add_argument("--runs", type=int, default=100_000)
    parser.add_argument("--input", type=Path)
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.here:
        fuzz(given.readers[0], given.runs)
        return 0
    from studies.fuzz_readers.readers import READERS

    unknown = set(given.readers) - READERS.keys()
    if unknown:
        parser.error(f"expected {', '.join(READERS)}, got {', '.join(sorted(unknown))}")
    if given.input is not None:
        read_one(given.readers[0], given.input)
        return 0
    return max(run(name, given.runs) for name in given.readers or READERS)


def run(name: str, runs: int) -> int:
    """Fuzz a reader in a process of its own; print its rate, and return 1 if anything was found."""
    folder = ROOT / "build" / "fuzz" / name
    found = folder / "found"
    found.mkdir(parents=True, exist_ok=True)
    began_s = time.monotonic()
    words = (sys.executable, "-m", "studies.fuzz_readers", name, "--runs", str(runs), "--here")
    with (folder / "log").open("wb") as log:
        done = subprocess.run(words, cwd=ROOT, stderr=log, check=False)
    took_s = time.monotonic() - began_s
    inputs = len(list((folder / "inputs").glob("*")))
    counted = re.findall(rb"^#(\d+)\t", (folder / "log").read_bytes(), re.MULTILINE)
    read = int(counted[-1]) if counted else 0
    problems = sorted(found.glob("*.txt"))
    print(
        f"{name:16} {read:>9,} inputs in {took_s:6.0f} s ({read / took_s:6.0f} a second), "
        f"{inputs} kept, {len(problems)} problems"
        + (f", ended with {done.returncode}: see {folder / 'log'}" if done.returncode else ""),
        flush=True,
    )
    return int(bool(problems) or done.returncode != 0)


def fuzz(name: str, runs: int) -> None:
    """Fuzz a reader in this process, which ends with it."""
    import atheris

    folder = ROOT / "build" / "fuzz" / name
    for inner in ("seeds", "inputs"):
        (folder / inner).mkdir(parents=True, exist_ok=True)
    with atheris.instrument_imports(include=GUIDED_BY), TemporaryDirectory() as made:
        from studies.fuzz_readers.readers import READERS

        reader = READERS[name]

        def one(data: bytes) -> None:
            try:
                with TemporaryDirectory(dir=MEMORY if MEMORY.is_dir() else None) as inner:
                    reader.read(data, Path(inner))
            except reader.errors:
                pass
            except Exception as problem:
                keep(folder / "found", data, problem)

        # Libraries that are imported by the first call are no part of an input's time.
        for number, data in enumerate(reader.seeds(Path(made))):
            (folder / "seeds" / str(number)).write_bytes(data)
            one(data)
    options = (f"-runs={runs}", f"-max_len={reader.longest_bytes}", f"-timeout={MOST_S}")
    more = (f"-rss_limit_mb={MOST_MEMORY_MB}", "-print_final_stats=1")
    places = (f"-artifact_prefix={folder / 'found'}{os.sep}", folder / "inputs", folder / "seeds")
    atheris.Setup(["fuzz_readers", *options, *more, *map(str, places)], one)
    atheris.Fuzz()


def keep(folder: Path, data: bytes, problem: Exception) -> None:
    """Keep an input with its error, unless another one has raised the same at the same place."""
    places = [
        f"{Path(each.filename).name}:{each.lineno}"
        for each in traceback.extract_tb(problem.__traceback__)
        if "recon" in Path(each.filename).parts
    ]
    text = f"{type(problem).__name__} at {places[-1] if places else 'nowhere'}"
    path = folder / sha256(text.encode()).hexdigest()[:12]
    if not path.exists():
        path.write_bytes(data)
        path.with_suffix(".txt").write_text(f"{text}: {problem}\n"[:2_000])
        print(f"{text}: {problem!s:.200} ({path})", flush=True)


def read_one(name: str, path: Path) -> None:
    """Read one input; an error that the reader does not document ends with its traceback."""
    from studies.fuzz_readers.readers import READERS

    with TemporaryDirectory() as folder:
        try:
            READERS[name].read(path.read_bytes(), Path(folder))
            print("read")
        except READERS[name].errors as problem:
            print(f"refused: {problem}")


if __name__ == "__main__":
    sys.exit(main())
