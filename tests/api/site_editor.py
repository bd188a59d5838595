"""A person who edits the site's folder over the API."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from tests.api.client import Client
from tests.api.fake_station import FakeStation, application


@dataclass
class SiteEditor:
    """Reads and saves one part of the site; an undo takes back the newest change of any."""

    PART: ClassVar[str]
    """Of the path: `drawing`."""
    ITEMS: ClassVar[str]
    """What it consists of in requests: `features`."""
    folder: Path
    station: FakeStation
    client: Client = field(init=False)

    def __post_init__(self) -> None:
        self.station.edit(self.folder)
        self.client = Client(application(self.station))

    def read(self) -> dict[str, Any]:
        view: dict[str, Any] = self.client.get(f"/api/site/{self.PART}").json()
        return view

    def save(self, *items: dict[str, Any], end: str = "", revision: str = "") -> dict[str, Any]:
        body = {"revision": revision or self.read()["revision"], self.ITEMS: list(items)}
        return self._posted(f"{self.PART}{end}", body)

    def undo(self) -> dict[str, Any]:
        return self._posted("drawing/undo", {"revision": self.read()["revision"]})

    def _posted(self, end: str, body: dict[str, Any]) -> dict[str, Any]:
        answer: dict[str, Any] = self.client.post(f"/api/site/{end}", json=body).json()
        return answer
