"""Vehicles that hover, or stand, beside a field; and a station that surveys it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from tests.station.returning_world import ReturningWorld, returning_world

from recon.guidance.survey import CoverageFigures, SurveyState, figures
from recon.model.airspace import Region
from recon.model.command import FlyMission
from recon.model.control import AuthorityHolder
from recon.model.event import SurveyRequested, SurveyStarted, SurveyStopped
from recon.model.survey import Survey, SurveyPhase
from recon.station.state.orders import OrderRecord
from recon.station.state.survey_record import SurveyRecord

PADS = ((0.0, -40.0), (40.0, -40.0), (80.0, -40.0))
HEIGHT_M = 40.0
SURVEY_ID = 500


def field(
    east_m: float = 120.0, north_m: float = 60.0, *, west_m: float = 0.0, south_m: float = 0.0
) -> Region:
    corners = [(0.0, 0.0), (east_m, 0.0), (east_m, north_m), (0.0, north_m)]
    return Region(np.array(corners) + np.array([west_m, south_m]))


def asked(region: Region | None = None, **changes: object) -> Survey:
    what: dict[str, object] = {
        "id": SURVEY_ID,
        "name": "field",
        "region": region or field(),
        "height_above_takeoff_m": HEIGHT_M,
        "front_overlap": 0.5,
        "side_overlap": 0.4,
        "speed_mps": 8.0,
        **changes,
    }
    return Survey(**what)  # type: ignore[arg-type]


@dataclass(slots=True)
class SurveyedWorld:
    """A survey in a simulated world: operator commands, and the survey's state."""

    fleet: ReturningWorld

    @property
    def driver(self):  # type: ignore[no-untyped-def]
        return self.fleet.world.driver

    def record(self, number: int = SURVEY_ID) -> SurveyRecord:
        record: SurveyRecord = self.driver.station.surveys.records[number]
        return record

    def state(self, number: int = SURVEY_ID) -> SurveyState:
        state = self.record(number).state
        assert state is not None
        return state

    def phase(self, number: int = SURVEY_ID) -> SurveyPhase:
        return self.state(number).phase

    def figures(self) -> CoverageFigures:
        return figures(self.state())

    def asks(self, survey: Survey | None = None) -> None:
        self.driver.handle(SurveyRequested(survey or asked(), "ann"))
        self.runs(0.5)

    def starts(self, *serials: str, takeoff: bool = False, number: int = SURVEY_ID) -> None:
        self.driver.handle(SurveyStarted(number, serials, "ann", takeoff))

    def pauses(self) -> None:
        self.driver.handle(SurveyStopped(SURVEY_ID, "bob", is_aborted=False))

    def aborts(self) -> None:
        self.driver.handle(SurveyStopped(SURVEY_ID, "bob", is_aborted=True))

    def runs(self, seconds: float) -> None:
        self.fleet.runs(seconds)

    def runs_until(self, phase: SurveyPhase, at_most_s: float) -> bool:
        for _ in range(round(at_most_s)):
            if self.phase() is phase:
                return True
            self.runs(1.0)
        return self.phase() is phase

    def missions(self, serial: str | None = None) -> list[OrderRecord]:
        return [
            each
            for each in self.driver.station.orders.records.values()
            if isinstance(each.command.body, FlyMission) and serial in (None, each.command.serial)
        ]

    def holder(self, serial: str) -> AuthorityHolder:
        return self.driver.station.control(serial).authority.holder


def surveyed_world(
    count: int = 1,
    *,
    height_m: float = HEIGHT_M,
    pads: Sequence[tuple[float, float]] = PADS,
    **options: object,
) -> SurveyedWorld:
    """Return vehicles SIM-1 ... that hover above their pads south of the field; 0 m: they stand."""
    at = [(east_m, north_m, height_m) for east_m, north_m in pads[:count]]
    return SurveyedWorld(returning_world(at, pads[:count], **options))  # type: ignore[arg-type]
