"""Scenarios by path or name; extras that are not installed are named."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from recon.cli.nodeodm import opened_node
from recon.cli.own_files import scenario_file, scenarios_folder
from recon.fields.shape import FieldFileError
from recon.fields.tables import read_tables
from recon.light.tables import READERS
from recon.model.errors import RecordError


@pytest.mark.parametrize("named", ["cumulus-40", "cumulus-40.toml", "scenarios/cumulus-40.toml"])
def test_a_scenario_is_named_with_or_without_its_folder(
    named: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert scenario_file(named) == scenarios_folder() / "cumulus-40.toml"
    own = tmp_path / named
    own.parent.mkdir(exist_ok=True)
    own.touch()
    assert scenario_file(named) == Path(named), "a file at that path comes first"
    assert scenario_file("none.toml") == Path("none.toml")


@pytest.mark.parametrize(
    ("package", "extra", "problem", "use"),
    [
        ("pyogrio", "imports", FieldFileError, lambda: read_tables("x.shp", 1)),
        ("netCDF4", "netcdf", RecordError, lambda: READERS[".nc"](Path("x.nc"))),
        ("pyodm", "nodeodm", RecordError, lambda: opened_node("http://127.0.0.1:1")),
    ],
)
def test_an_extra_that_is_missing_is_named(
    package: str,
    extra: str,
    problem: type[Exception],
    use: Callable[[], object],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(problem, match=rf"needs the package {package}.*recon-gcs\[{extra}\]"):
        use()
