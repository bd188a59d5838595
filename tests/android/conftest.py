"""The JVM companion against the real station: `make test-android` builds its jar first."""

from pathlib import Path

import pytest
from tests.android.field import write_site
from tests.android.processes import JAR


@pytest.fixture(autouse=True)
def built_jar() -> None:
    """Skip where the jar was not built."""
    if not Path(JAR).is_file():
        pytest.skip("the companion's jar is needed: make test-android")


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """The folder of a site for eight companions."""
    folder = tmp_path / "site"
    folder.mkdir()
    return write_site(folder)
