"""The scripted operator over HTTP, at a station that does not always answer in time."""

import asyncio
from dataclasses import dataclass, field
from types import SimpleNamespace, TracebackType

import pytest
from tests.score.scenes import SMALL

from recon.cli import scripted_operator
from recon.client import ClientError, SurveyStatus
from recon.client.errors import MaybeSentError, StationUnreachableError
from recon.score import Scenario
from recon.score.scenario_file import load_scenario

SERIALS = ("SIM-1", "SIM-2")


@dataclass(slots=True)
class FakeStation:
    """Answers as a station's client does, at some calls with an error instead."""

    errors: list[tuple[str, ClientError]]
    """Of each named request the next error, in order."""
    all_surveys: list[SimpleNamespace] = field(default_factory=list)
    calls: list[str] = field(default_factory=list)

    @property
    def surveys(self) -> "FakeStation":
        return self

    async def __aenter__(self) -> "FakeStation":
        return self

    async def __aexit__(
        self, _kind: type | None, _problem: BaseException | None, _trace: TracebackType | None
    ) -> None:
        return None

    async def vehicle(self, _serial: str, _timeout_s: float) -> None:
        return None

    def vehicles(self) -> list[SimpleNamespace]:
        is_flying = SimpleNamespace(value=False)
        charge = SimpleNamespace(value=1.0)
        return [
            SimpleNamespace(serial=each, is_live=True, is_flying=is_flying, battery_fraction=charge)
            for each in SERIALS
        ]

    def known(self, _serial: str) -> "FakeStation":
        return self

    async def preflight(self) -> SimpleNamespace:
        return SimpleNamespace(is_passed=True)

    async def list(self) -> list[SimpleNamespace]:
        self._may_fail("list")
        return self.all_surveys[::-1]

    async def create(self, **request: object) -> SurveyStatus:
        self.calls.append("create")
        number = len(self.all_surveys) + 1
        self.all_surveys.append(
            SimpleNamespace(
                id=number, name=request["name"], phase="created", reason="", vehicles=()
            )
        )
        self._may_fail("create")
        return _status(number)

    async def start(self, number: int, _serials: tuple[str, ...], *, takeoff: bool) -> SurveyStatus:
        assert takeoff
        self.calls.append(f"start {number}")
        self._may_fail("start")
        self.all_surveys[number - 1].phase = "aborted"  # ends the operator
        return _status(number)

    def _may_fail(self, request: str) -> None:
        if self.errors and self.errors[0][0] == request:
            raise self.errors.pop(0)[1]


def _status(number: int) -> SurveyStatus:
    return SurveyStatus(
        *(number, "small", "created", "", "", "hover", False, False, False, None, None, 40.0, None),
        *("", None, 0, 0, 0.0, 1, (), None),
    )


@pytest.fixture
def scenario(tmp_path: object) -> Scenario:
    path = tmp_path / "small.toml"  # type: ignore[operator]
    path.write_text(SMALL, encoding="utf-8")
    return load_scenario(path)


LATE = "nothing within 5 s"


@pytest.mark.parametrize(
    ("errors", "calls"),
    [
        ([], ["create", "start 1"]),
        ([("list", StationUnreachableError(LATE))], ["create", "start 1"]),
        ([("create", MaybeSentError(LATE))], ["create", "start 1"]),
        ([("start", MaybeSentError(LATE))], ["create", "start 1", "start 1"]),
    ],
)
def test_a_late_answer_does_not_end_the_flight(
    errors: list[tuple[str, ClientError]],
    calls: list[str],
    scenario: Scenario,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    station, lines = FakeStation(list(errors)), list[str]()
    monkeypatch.setattr(scripted_operator, "Station", lambda _url: station)
    monkeypatch.setattr(scripted_operator, "TRY_AGAIN_S", 0.0)
    monkeypatch.setattr(scripted_operator, "LOOK_EVERY_S", 0.0)
    monkeypatch.setattr("recon.score.scripted_operator.SETTLED_S", 0.0)
    asyncio.run(asyncio.wait_for(scripted_operator.fly_surveys("", scenario, lines.append), 60.0))
    assert station.calls == calls
    assert not station.errors
    assert any("tries again" in line for line in lines) is bool(errors)
