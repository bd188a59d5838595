"""Files of light sensors that are damaged, or that claim more than they hold: one kind of error."""

import io
import subprocess
import sys
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest

from recon.light import tables
from recon.light.files import read_points
from recon.light.netcdf_process import variables
from recon.model.errors import RecordError

WHOLE: Mapping[str, Any] = {
    "time": 1_777_000_000.0 + np.arange(4.0),
    "light": np.arange(12.0).reshape(4, 3) + 100.0,
    "lat": np.array([41.9, 41.901, 41.902]),
    "lon": np.array([-93.6, -93.601, -93.602]),
}


def arrays(save: Callable[..., None] = np.savez, **changed: Any) -> bytes:
    data = io.BytesIO()
    save(data, **{**WHOLE, **changed})
    return data.getvalue()


def changed(data: bytes, at: int, new: bytes) -> bytes:
    return data[:at] + new + data[at + len(new) :]


def claiming(shape: str) -> bytes:
    """An archive whose one array claims another shape than it has."""
    packed, array = io.BytesIO(), io.BytesIO()
    np.save(array, np.zeros(4))
    text = array.getvalue().replace(b"(4,), }", f"({shape},), }}".encode())
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("time.npy", text)
    return packed.getvalue()


def packed_by(method: int) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", method) as archive:
        archive.writestr("time.npy", single())
    return packed.getvalue()


def single() -> bytes:
    data = io.BytesIO()
    np.save(data, np.zeros(4))
    return data.getvalue()


DIRECTORY = arrays().rfind(b"PK\x01\x02")
DAMAGED: Mapping[str, bytes] = {
    "nothing": b"",
    "another kind of file": b"\x7fELF" + bytes(100),
    "cut off": arrays()[:-30],
    "a wrong checksum": arrays().replace(WHOLE["lat"].tobytes(), WHOLE["lon"].tobytes()),
    "damaged packing": changed(arrays(np.savez_compressed), 60, b"\xff" * 20),
    "a packing that nobody has": changed(arrays(), DIRECTORY + 10, b"\x63"),
    "a version that nobody has": changed(arrays(), DIRECTORY + 6, b"\x7a"),
    "an encrypted file": changed(arrays(), DIRECTORY + 8, b"\x01"),
    "one array": single(),
    "an array of terabytes": claiming("4000000000000"),
    "an array of more than can be counted": claiming("9" * 30),
    "times as text": arrays(time=np.array(list("abcd"))),
    "light as text": arrays(light=np.array([list("abc")] * 4)),
    "places as text": arrays(lat=np.array(list("abc"))),
    "one name": arrays(sensor=np.array("a")),
    "objects": arrays(time=np.array([object()] * 4)),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_arrays_are_refused(name: str, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(DAMAGED[name])
    with pytest.raises(RecordError, match=r"a\.npz: expected"):
        read_points(path)


@pytest.mark.parametrize("method", [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2])
def test_packings_without_a_limit_of_size_are_refused(method: int, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(packed_by(method))
    with pytest.raises(RecordError, match="stored or deflated"):
        read_points(path)


def test_packed_arrays_have_a_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(arrays(np.savez_compressed, other=np.zeros(100_000)))
    assert path.stat().st_size < 10_000
    monkeypatch.setattr(tables, "MOST_UNPACKED_BYTES", 100_000)
    with pytest.raises(RecordError, match="expected arrays of at most"):
        read_points(path)


def test_a_variable_that_was_never_written_is_not_made(tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w") as file:
        for name in ("time", "sensor"):
            file.createDimension(name, 1_000_000)
        file.createVariable("light", "f8", ("time", "sensor"), chunksizes=(100, 100))
    assert path.stat().st_size < 100_000
    with pytest.raises(ValueError, match="more than 16000000 values"):
        list(variables(str(path)))


def test_texts_in_netcdf_are_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("sensor", 3)
        names = file.createVariable("names", str, ("sensor",))
        names[:] = np.array(["a", "b", "c"], dtype=object)
    assert list(variables(str(path))) == []


def test_damaged_netcdf_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", 4_000)
        file.createVariable("light", "f8", ("time",), zlib=True)[:] = np.arange(4_000.0)
    data = path.read_bytes()
    half = len(data) // 2
    path.write_bytes(changed(data, half, b"\xff" * (half - 100)))
    with pytest.raises(RecordError, match=r"a\.nc: expected"):
        read_points(path)


READ_AND_PRINT_PEAKS = """
import resource, sys
from pathlib import Path
from recon.light.files import read_points
from recon.model.errors import RecordError

try:
    read_points(Path(sys.argv[1]))
except RecordError as problem:
    print(problem)
peak = next(line for line in open("/proc/self/status") if line.startswith("VmHWM"))
print(peak.split()[1])
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""
"""Of a process's own `ru_maxrss` the memory of the one that started it is a part."""


def test_a_text_of_two_gigabytes_that_is_not_there_takes_no_memory(tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w", format="NETCDF3_CLASSIC") as file:
        file.createDimension("time", 4)
        file.createVariable("time", "f8", ("time",))[:] = 1.0
        file["time"].units = "seconds"
    data = path.read_bytes()
    # Behind an attribute's name, to four bytes, are its type and its length.
    length = data.index(b"units\0\0\0") + 8 + 4
    path.write_bytes(changed(data, length, b"\x7a\x00\x00\x20"))
    # This process and its other children may have been larger before.
    done = subprocess.run(
        [sys.executable, "-c", READ_AND_PRINT_PEAKS, path],
        capture_output=True,
        text=True,
        check=True,
    )
    said, *peaks_kb = done.stdout.splitlines()
    assert "a.nc: expected" in said
    assert all(0 < int(each) < 2**20 for each in peaks_kb)


def test_what_ends_the_process_that_reads_is_a_damaged_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.nc"
    path.write_bytes(b"CDF")
    monkeypatch.setattr(sys, "executable", "false")
    with pytest.raises(RecordError, match="expected a NetCDF file, got: a damaged one"):
        read_points(path)
