"""How long an approval holds, and that all rules are asked."""

import copy
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from tests.safety.cases import (
    NOW,
    PLACE,
    STICK,
    TAKEOFF,
    WGS84,
    S,
    approved,
    command,
    mission,
    situation,
    vehicle,
    waypoint,
)

from recon.model.command import (
    Body,
    Command,
    FlyMission,
    GoTo,
    Hover,
    LandNow,
    Refusal,
    ReturnHome,
    StartCamera,
    StopCamera,
)
from recon.model.mission import Mission
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.safety import approve, rules
from recon.safety.gate import judge, judge_parts
from recon.safety.rules import RULES
from recon.safety.situation import Situation


@pytest.mark.parametrize(
    ("body", "holds_s"),
    [
        (Hover(), 1.5),
        (ReturnHome(), 1.5),
        (STICK, 1.5),
        (mission(), 2.5),
        (LandNow(), 5.0),
        (StartCamera(1.0), 5.0),
        (StopCamera(), 5.0),
    ],
)
def test_what_could_start_a_takeoff_does_not_wait_long_in_a_queue(
    body: Body, holds_s: float
) -> None:
    answer = approved(approve(command(body), situation()))
    assert answer.command.expires_at_ns == NOW + round(holds_s * S)
    assert answer.approved_at_ns == NOW


def test_no_approval_outlives_the_order() -> None:
    for body in (Hover(), mission(), LandNow()):
        order = command(body, expires_at_ns=NOW + S // 2)
        assert approved(approve(order, situation())).command.expires_at_ns == NOW + S // 2


def test_the_vehicles_own_profile_goes_with_it() -> None:
    """Its packet gap is the link's business."""
    state = vehicle()
    assert approved(approve(command(LandNow()), situation(state))).profile is state.profile


def test_a_steered_order_is_judged_and_never_approved_for_the_wire() -> None:
    order = command(GoTo(PLACE, 30.0, 5.0))
    assert judge(order, situation()) is None
    answer = approve(order, situation())
    assert answer == Refusal("not_for_the_wire", "goto is steered by the station with sticks")


class TestARuleThatFails:
    """A fault in a rule's code: nothing that moves goes out unjudged, and every stop goes out."""

    @pytest.fixture(autouse=True)
    def _failing(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def broken(_command: Command, _situation: Situation) -> Refusal | None:
            raise ZeroDivisionError("division by zero")

        monkeypatch.setattr("recon.safety.gate.RULES", (broken,))

    @pytest.mark.parametrize("body", [STICK, mission(), GoTo(PLACE, 30.0, 5.0)])
    def test_it_refuses_what_moves(self, body: Body) -> None:
        answer = judge(command(body), situation())
        assert answer == Refusal(
            "rule_fault",
            "the rule broken could not be worked out, a fault in the station's own code "
            "(ZeroDivisionError: division by zero): nothing that moves a vehicle is sent "
            "unjudged; fly it by its controller, and start the station again",
        )

    def test_one_without_a_name_too(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("recon.safety.gate.RULES", (partial(divmod, 1, 0),))
        answer = judge(command(STICK), situation())
        assert answer is not None
        assert answer.reason.startswith("the rule ? could not be worked out")

    def test_a_mission_in_parts_too(self) -> None:
        whole = mission().mission
        answer = judge_parts(command(FlyMission(whole)), (whole,), situation())
        assert answer is not None
        assert answer.rule == "rule_fault"

    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_it_holds_no_stop_back(self, body: Body) -> None:
        assert approved(approve(command(body), situation())).command.body == body

    def test_a_takeoff_is_no_stop(self) -> None:
        answer = approve(command(Hover(), takeoff=True), situation())
        assert isinstance(answer, Refusal)
        assert answer.rule == "rule_fault"


def test_every_rule_has_one_file_named_after_it() -> None:
    for rule in RULES:
        assert rule.__module__ == f"recon.safety.rules.{rule.__name__}"
    files = {path.stem for path in Path(rules.__file__).parent.glob("*.py")} - {"__init__"}
    assert sorted(rule.__name__ for rule in RULES) == sorted(files)


class TestNobodyElseMakesAnApproval:
    """The refusals word for word; that no other way leads round them is tested of the whole tree"""

    def test_a_wrong_key_makes_none(self) -> None:
        with pytest.raises(TypeError) as caught:
            replace(approved(approve(command(LandNow()), situation())), key=None)
        assert str(caught.value) == "only recon.safety.approve makes an ApprovedCommand"

    def test_none_is_copied(self) -> None:
        with pytest.raises(TypeError) as caught:
            copy.copy(approved(approve(command(LandNow()), situation())))
        assert str(caught.value) == (
            "an ApprovedCommand is not copied or pickled: ask recon.safety.approve"
        )

    def test_none_is_restored(self) -> None:
        with pytest.raises(TypeError) as caught:
            approved(approve(command(LandNow()), situation())).__setstate__([])
        assert str(caught.value) == "an ApprovedCommand is not restored: ask recon.safety.approve"


class TestAMissionInParts:
    """Where it leads is asked of the whole; what DJI takes of each part."""

    PARTS = (
        Mission((waypoint(0.0), waypoint(50.0))),
        Mission((waypoint(50.0, speed_mps=7.0), waypoint(90.0))),
    )
    WHOLE = Mission((waypoint(0.0), waypoint(50.0, speed_mps=7.0), waypoint(90.0)))

    def asked(
        self, monkeypatch: pytest.MonkeyPatch, refused: Mission | None = None
    ) -> tuple[list[tuple[str, Command, Situation]], Refusal | None]:
        """What the two kinds of rules are asked, until one refuses this mission; the answer."""
        asked: list[tuple[str, Command, Situation]] = []

        def answer(rule: str, command: Command, situation: Situation) -> Refusal | None:
            asked.append((rule, command, situation))
            return Refusal(rule, "no") if command.body == FlyMission(refused) else None

        def any_rule(command: Command, situation: Situation) -> Refusal | None:
            return answer("any_rule", command, situation)

        def limits(command: Command, situation: Situation) -> Refusal | None:
            return answer("limits", command, situation)

        monkeypatch.setattr("recon.safety.gate.RULES", (any_rule, limits))
        monkeypatch.setattr("recon.safety.gate.dji_limits", limits)
        return asked, judge_parts(command(FlyMission(self.WHOLE)), self.PARTS, situation())

    def test_who_is_asked_what(self, monkeypatch: pytest.MonkeyPatch) -> None:
        asked, answer = self.asked(monkeypatch)
        first, second = self.PARTS
        assert answer is None
        assert asked == [
            ("any_rule", command(FlyMission(self.WHOLE)), situation()),
            ("limits", command(FlyMission(first)), situation()),
            ("limits", command(FlyMission(second)), situation()),
        ]

    def test_the_whole_is_made_of_the_parts(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """And not taken from the command, whose body may be as it was before the repair."""
        monkeypatch.setattr(
            "recon.safety.gate.RULES", (lambda command, _: Refusal("seen", repr(command.body)),)
        )
        answer = judge_parts(command(mission()), self.PARTS, situation())
        assert answer == Refusal("seen", repr(FlyMission(self.WHOLE)))

    @pytest.mark.parametrize(
        ("refused", "rule", "count"), [(WHOLE, "any_rule", 1), (PARTS[1], "limits", 3)]
    )
    def test_the_first_refusal_is_the_answer(
        self, monkeypatch: pytest.MonkeyPatch, refused: Mission, rule: str, count: int
    ) -> None:
        asked, answer = self.asked(monkeypatch, refused)
        assert answer == Refusal(rule, "no")
        assert len(asked) == count


class TestTheOffsetOfTheHeights:
    """A mission alone, and for an app that reads heights above the ellipsoid, is raised by it."""

    def test_a_mission_for_such_an_app(self) -> None:
        answer = approved(approve(command(mission()), situation(vehicle(WGS84))))
        assert answer.altitude_offset_m == 260.0

    @pytest.mark.parametrize("body", [Hover(), STICK])
    def test_another_order_is_not_raised(self, body: Body) -> None:
        answer = approved(approve(command(body), situation(vehicle(WGS84))))
        assert answer.altitude_offset_m is None

    def test_nor_a_mission_for_an_app_that_counts_from_takeoff(self) -> None:
        answer = approved(approve(command(mission()), situation(vehicle(TAKEOFF))))
        assert answer.altitude_offset_m is None

    @pytest.mark.parametrize("state", [None, vehicle(None)])
    def test_nor_one_for_an_unknown_app(
        self, monkeypatch: pytest.MonkeyPatch, state: VehicleState | None
    ) -> None:
        """The rules refuse it; here none is asked."""
        monkeypatch.setattr("recon.safety.gate.RULES", ())
        answer = approved(approve(command(mission()), replace(situation(), vehicle=state)))
        assert answer.altitude_offset_m is None
        assert answer.profile is None

    @pytest.mark.parametrize("offset_age_s", [0.1, 2.0])
    def test_no_approval_outlives_it(self, offset_age_s: float) -> None:
        """It may be 2 s old; the order is void in the nanosecond after that."""
        offset = Stamped(260.0, NOW - round(offset_age_s * S))
        now = situation(vehicle(WGS84, altitude_offset_m=offset))
        ends_ns = approved(approve(command(mission()), now)).command.expires_at_ns
        assert ends_ns == NOW + round((2.0 - offset_age_s) * S) + 1

    def test_one_of_no_age_ends_nothing(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("recon.safety.gate.RULES", ())
        now = situation(vehicle(WGS84, altitude_offset_m=Stamped(None, None)))
        ends_ns = approved(approve(command(mission()), now)).command.expires_at_ns
        assert ends_ns == NOW + round(2.5 * S)


class TestTheLinks:
    """Hover and return spare a link that reports being on the ground; other orders do not."""

    @pytest.mark.parametrize(
        ("body", "takeoff", "links"),
        [
            (Hover(), False, (1, 3)),
            (ReturnHome(), False, (1, 3)),
            (Hover(), True, (1, 2, 3)),
            (LandNow(), False, (1, 2, 3)),
            (mission(), False, (1, 2, 3)),
        ],
    )
    def test_where_it_goes(
        self, monkeypatch: pytest.MonkeyPatch, body: Body, takeoff: bool, links: tuple[int, ...]
    ) -> None:
        monkeypatch.setattr("recon.safety.gate.RULES", ())
        now = situation(vehicle(), Stamped(False, NOW), Stamped(None, None))
        assert approved(approve(command(body, takeoff=takeoff), now)).link_ids == links
