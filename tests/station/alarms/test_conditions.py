"""Conditions, derived from the station's state alone."""

import pytest
from tests.fleet.reports import core, extended
from tests.station.commanded import CommandedStation

from recon.model.event import LinkLimitReached
from recon.model.report import MessageReport, MessageSeverity
from recon.model.vehicle import BatteryWarning
from recon.station.state.alarm_book import Severity


def severities(scene: CommandedStation, rule: str) -> list[Severity]:
    every = scene.station.alarms.alarms.values()
    return [a.condition.severity for a in every if a.is_active and a.condition.rule == rule]


class TestSilence:
    @pytest.mark.parametrize(
        ("flying", "severity"),
        [(True, Severity.CRITICAL), (None, Severity.CRITICAL), (False, Severity.WARNING)],
    )
    def test_a_lost_vehicle_is_an_alarm_from_3_s_on(
        self, flying: bool | None, severity: Severity
    ) -> None:
        scene = CommandedStation().opens(1, core(flying=flying), extended()).passes(2.9)
        assert "link_lost" not in scene.alarms()
        scene.passes(0.1)
        assert severities(scene, "link_lost") == [severity]
        scene.receives(1, core()).passes(0.1)
        assert "link_lost" not in scene.alarms()

    def test_it_stays_when_the_link_closes(self) -> None:
        scene = CommandedStation().opens(1, core(), extended()).closes(1).passes(600.0)
        assert severities(scene, "link_lost") == [Severity.CRITICAL]

    def test_a_vehicle_known_by_its_serial_alone_is_an_alarm(self) -> None:
        scene = CommandedStation().opens(1, extended()).passes(2.9)
        assert scene.alarms() == set()
        scene.passes(0.3)
        assert scene.alarms() == {"no_telemetry"}
        assert scene.receives(1, core()).passes(0.1).alarms() == set()


class TestBattery:
    @pytest.mark.parametrize(
        ("battery", "warning", "severity"),
        [
            (0.8, BatteryWarning.NONE, None),
            (0.8, BatteryWarning.LOW, Severity.WARNING),
            (0.8, BatteryWarning.SERIOUS, Severity.CRITICAL),
            (0.26, BatteryWarning.NONE, None),
            (0.25, BatteryWarning.NONE, Severity.WARNING),
            (0.10, BatteryWarning.NONE, Severity.CRITICAL),
            (0.10, BatteryWarning.LOW, Severity.CRITICAL),
            (None, None, None),
            (None, BatteryWarning.SERIOUS, Severity.CRITICAL),
            (0.2, None, Severity.WARNING),
        ],
    )
    def test_the_level_and_the_warning_both_count(
        self, battery: float | None, warning: BatteryWarning | None, severity: Severity | None
    ) -> None:
        scene = (
            CommandedStation()
            .opens(1, core(), extended(battery=battery, warning=warning))
            .passes(0.1)
        )
        assert severities(scene, "battery") == ([] if severity is None else [severity])

    def test_an_empty_one_on_the_ground_is_no_alarm(self) -> None:
        scene = CommandedStation().opens(1, core(flying=False), extended(battery=0.05)).passes(0.1)
        assert scene.alarms() == set()


class TestIdentity:
    def test_a_flying_vehicle_without_a_serial_is_an_alarm(self) -> None:
        scene = CommandedStation().opens(1, core(), extended(None)).passes(1.9)
        assert "unidentified" not in scene.alarms()
        assert "unidentified" in scene.passes(0.3).alarms()
        assert "unidentified" not in scene.receives(1, extended()).passes(0.1).alarms()

    def test_a_conflict_is_an_alarm_until_it_ends(self) -> None:
        scene = CommandedStation().opens(1, core(), extended()).opens(2, extended()).passes(0.5)
        assert "serial_conflict" not in scene.alarms()
        assert "serial_conflict" in scene.receives(1, core()).passes(0.1).alarms()
        assert "serial_conflict" not in scene.closes(2).passes(0.1).alarms()


class TestMessages:
    def test_an_apps_warnings_and_errors_stay_until_seen(self) -> None:
        scene = CommandedStation().opens(1, core(), extended())
        for severity in MessageSeverity:
            scene.receives(1, MessageReport(severity, f"level {severity.name}"))
        texts = {a.condition.text for a in scene.station.alarms.alarms.values()}
        assert texts == {
            "A: message from its app: level WARNING",
            "A: message from its app: level ERROR",
        }


class TestLinkLimits:
    def test_a_limit_of_the_link_server_is_an_alarm_while_it_is_reached(self) -> None:
        scene = CommandedStation().happens(LinkLimitReached("places", "256 apps are connected"))
        scene.happens(LinkLimitReached("memory", "link 7 closed")).passes(0.1)
        assert severities(scene, "link_limit") == [Severity.ERROR] * 2
        scene.happens(LinkLimitReached("places", None)).passes(0.1)
        active = [a for a in scene.station.alarms.alarms.values() if a.is_active]
        assert [a.condition.text for a in active] == ["link 7 closed"]
        scene.happens(LinkLimitReached("memory", None)).passes(0.1)
        assert severities(scene, "link_limit") == []
