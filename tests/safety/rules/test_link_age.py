"""Motion needs to know where the vehicle is now; a stop goes on older telemetry."""

from dataclasses import replace

import pytest
from tests.safety.cases import MOVES, NOW, STICK, ZERO, S, command, mission, situation, vehicle

from recon.model.command import Body, Hover, Refusal, StartCamera
from recon.safety.rules.link_age import link_age

ONE_WAY = [replace(STICK, velocity_x_mps=0.0), replace(STICK, velocity_y_mps=0.0)]


def judged(body: Body, core_s: float | None, extended_s: float | None) -> Refusal | None:
    state = replace(
        vehicle(),
        core_received_at_ns=None if core_s is None else NOW - round(core_s * S),
        extended_received_at_ns=None if extended_s is None else NOW - round(extended_s * S),
    )
    return link_age(command(body), situation(state))


@pytest.mark.parametrize("body", [*MOVES, *ONE_WAY])
class TestMotion:
    @pytest.mark.parametrize(
        ("core_s", "extended_s", "word"),
        [
            (1.0, 3.0, None),
            (1.000000001, 0.1, "core"),
            (0.1, 3.000000001, "extended"),
            (5.0, 5.0, "core"),
            (None, 0.1, "core"),
            (0.1, None, "extended"),
        ],
    )
    def test_both_kinds_of_telemetry_must_be_young(
        self, body: Body, core_s: float | None, extended_s: float | None, word: str | None
    ) -> None:
        answer = judged(body, core_s, extended_s)
        assert (answer is None) is (word is None)
        assert answer is None or (answer.rule, f"{word} telemetry" in answer.reason) == (
            "link_age",
            True,
        )


class TestZeroStick:
    @pytest.mark.parametrize(
        ("core_s", "extended_s", "goes"),
        [
            (3.0, 0.1, True),
            (3.0, 60.0, True),
            (3.0, None, True),
            (3.000000001, 0.1, False),
            (None, 0.1, False),
        ],
    )
    def test_it_stops_the_vehicle_on_telemetry_up_to_3_s_old(
        self, core_s: float | None, extended_s: float | None, goes: bool
    ) -> None:
        assert (judged(ZERO, core_s, extended_s) is None) is goes


@pytest.mark.parametrize("body", [Hover(), StartCamera(1.0)])
def test_what_moves_nothing_needs_no_young_telemetry(body: Body) -> None:
    assert judged(body, None, None) is None


def test_a_refusal_states_the_age_and_what_is_needed() -> None:
    assert judged(mission(), 1.25, 0.1) == Refusal(
        "link_age",
        "A: core telemetry must be at most 1 s old for motion; got 1.2 s; wait for the link, or "
        "order hold, land or return",
    )
    assert judged(mission(), None, 0.1) == Refusal(
        "link_age", "A: core telemetry not received yet; check its companion app"
    )


def test_a_missing_vehicle_is_another_rules_matter() -> None:
    assert link_age(command(mission()), replace(situation(), vehicle=None)) is None
