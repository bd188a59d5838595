"""Orders go to vehicles that are who they say; emergency orders go further."""

from dataclasses import replace

import pytest
from tests.safety.cases import (
    NOW,
    STICK,
    approved,
    command,
    mission,
    refused_by,
    situation,
    vehicle,
)

from recon.model.command import Body, Hover, LandNow, Refusal, ReturnHome, StartCamera, StopCamera
from recon.model.units import Stamped
from recon.safety import ClaimingLink, Situation, approve

OTHERS = [mission(), STICK, StartCamera(1.0), StopCamera()]
EMERGENCIES = [Hover(), LandNow(), ReturnHome()]


def unidentified() -> Situation:
    state = replace(vehicle(), serial=None, profile=None)
    return Situation(NOW, state, (ClaimingLink(1, state.is_flying),))


@pytest.mark.parametrize("body", OTHERS)
def test_a_link_without_identity_gets_nothing_else(body: Body) -> None:
    order = replace(command(body), serial=None, link_id=1)
    assert approve(order, unidentified()) == Refusal(
        "identified",
        "Link 1 has not reported its serial: only emergency orders without takeoff are accepted",
    )


@pytest.mark.parametrize("body", EMERGENCIES)
def test_a_link_without_identity_gets_emergency_orders(body: Body) -> None:
    order = replace(command(body), serial=None, link_id=1)
    assert approved(approve(order, unidentified())).link_ids == (1,)


@pytest.mark.parametrize("body", OTHERS)
def test_a_vehicle_with_rivals_gets_nothing_else(body: Body) -> None:
    now = situation(vehicle(), Stamped(True, NOW))
    assert approve(command(body), now) == Refusal(
        "identified",
        "A: links 1 and 2 claim this serial; only hold, land and return without takeoff are sent "
        "until one of them closes or becomes silent",
    )


@pytest.mark.parametrize("body", EMERGENCIES)
def test_a_vehicle_with_rivals_gets_emergency_orders_on_every_link(body: Body) -> None:
    now = situation(vehicle(), Stamped(True, NOW))
    assert approved(approve(command(body), now)).link_ids == (1, 2)


@pytest.mark.parametrize("body", EMERGENCIES)
def test_takeoff_is_for_one_known_aircraft(body: Body) -> None:
    """One order must not start two aircraft, nor an unknown one."""
    unknown = replace(command(body, takeoff=True), serial=None, link_id=1)
    assert refused_by(approve(unknown, unidentified())) == "identified"
    rivals = situation(vehicle(flying=False), Stamped(False, NOW))
    contended = replace(rivals, vehicle=replace(vehicle(), rival_link_ids=(2,)))
    assert refused_by(approve(command(body, takeoff=True), contended)) == "identified"


def test_return_spares_what_is_on_the_ground_whatever_it_reports() -> None:
    order = command(ReturnHome(), takeoff=True)
    judged = approve(order, situation(vehicle(flying=False)))
    assert refused_by(judged) == "flying"
