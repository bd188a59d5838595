"""The wheel with all that a station needs: package, extension, console, scenarios, licences.

maturin builds package and extension, linked by zig for an old glibc; the rest is added here. The
same sources give the same bytes.

    python -m tools.wheel               # into build/, for Linux with glibc 2.28 or newer
    python -m tools.wheel --checkout    # with the extension as this checkout has built it: at once
"""

import argparse
import subprocess
import sys
from base64 import urlsafe_b64encode
from collections.abc import Mapping
from hashlib import sha256
from importlib.metadata import Distribution, distribution
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from tools.licences import ROOT, console_sbom, notices

GLIBC = "manylinux_2_28"
MOST_BYTES = 12_000_000
EXECUTABLE = 0o100755 << 16
Files = dict[str, bytes]


def built() -> tuple[str, Files]:
    """Return the name and files of the wheel that maturin builds."""
    with TemporaryDirectory() as folder:
        words = ("--locked", "--release", "--zig", "--compatibility", GLIBC, "--out", folder)
        maturin = Path(sys.executable).with_name("maturin")
        subprocess.run([maturin, "build", "--quiet", *words], cwd=ROOT, check=True)
        (path,) = Path(folder).glob("*.whl")
        with ZipFile(path) as wheel:
            return path.name, {name: wheel.read(name) for name in wheel.namelist()}


def of_checkout() -> tuple[str, Files]:
    """Return the same of this checkout, whose extension fits this computer only."""
    package = distribution("recon-gcs")
    files = {
        f"recon/{each.relative_to(ROOT / 'src/recon')}": each.read_bytes() for each in _sources()
    }
    files |= _metadata_of(package)
    lines = (package.read_text("WHEEL") or "").splitlines()
    (tag,) = (line[5:] for line in lines if line.startswith("Tag: "))
    return f"recon_gcs-{package.version}-{tag}.whl", files


def _sources() -> list[Path]:
    found = (ROOT / "src/recon").rglob("*")
    return [each for each in found if each.is_file() and "__pycache__" not in each.parts]


def _metadata_of(package: Distribution) -> Files:
    """Return the files of its metadata that were in a wheel, and are not of this installation."""
    kept = ("METADATA", "WHEEL", "entry_points.txt", "licenses", "sboms")
    return {
        str(file): file.read_binary()
        for file in package.files or ()
        if file.parts[0].endswith(".dist-info") and file.parts[1] in kept
    }


def added(info: str) -> Files:
    """Return what maturin does not know of; `info` is the folder of the wheel's metadata."""
    files = {
        f"{info}/licenses/THIRD-PARTY-NOTICES.txt": notices().encode(),
        f"{info}/sboms/recon-console.cyclonedx.json": console_sbom().encode(),
    }
    for target, folder in (("console", ROOT / "web/dist"), ("scenarios", ROOT / "scenarios")):
        found = sorted(each for each in folder.rglob("*") if each.is_file())
        if not found:
            raise SystemExit(f"{folder}: expected files, got none: make web")
        files |= {f"recon/{target}/{f.relative_to(folder)}": f.read_bytes() for f in found}
    return files


def write_wheel(out: Path, files: Mapping[str, bytes]) -> None:
    """Write files as a wheel, with their list."""
    (info,) = {name.split("/")[0] for name in files if ".dist-info/" in name}
    record = f"{info}/RECORD"
    rest = {name: files[name] for name in sorted(files.keys() - {record})}
    lines = [f"{name},sha256={_digest(data)},{len(data)}" for name, data in rest.items()]
    with ZipFile(out, "w") as wheel:
        for name, data in (
            *rest.items(),
            (record, "\n".join([*lines, f"{record},,", ""]).encode()),
        ):
            entry = ZipInfo(name)
            entry.compress_type, entry.external_attr = ZIP_DEFLATED, EXECUTABLE
            wheel.writestr(entry, data, compresslevel=9)


def _digest(data: bytes) -> str:
    return urlsafe_b64encode(sha256(data).digest()).decode().rstrip("=")


def main() -> None:
    """Write the wheel into build/, in place of an earlier one."""
    parser = argparse.ArgumentParser(description="Write Recon's wheel into build/.")
    parser.add_argument("--checkout", action="store_true", help="Take the extension as it is here.")
    name, files = of_checkout() if parser.parse_args().checkout else built()
    (info,) = {each.split("/")[0] for each in files if ".dist-info/" in each}
    out = ROOT / "build" / name
    out.parent.mkdir(exist_ok=True)
    for earlier in out.parent.glob(f"recon_gcs-*-{name.rpartition('-')[2]}"):
        earlier.unlink()
    write_wheel(out, files | added(info))
    size = out.stat().st_size
    print(f"{out.relative_to(ROOT)}: {size / 1e6:.1f} MB")
    if size > MOST_BYTES:
        raise SystemExit(f"expected at most {MOST_BYTES / 1e6:g} MB")


if __name__ == "__main__":
    main()
