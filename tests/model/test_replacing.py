"""Values that are copied with every packet: the same as by the standard library, only sooner."""

import dataclasses
from dataclasses import FrozenInstanceError, dataclass, field
from functools import cached_property
from typing import Any

import pytest

from recon.fleet.state import Fleet, LinkRecord
from recon.model.replacing import replace
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.station.state.station import Station
from recon.station.state.vehicle_control import Tracking

COPIED_OFTEN = (
    VehicleState("SIM-1", 3),
    LinkRecord(1, "here", 0, VehicleState(None, 1)),
    Fleet(),
    Tracking(),
    Station(),
)
copied_often = pytest.mark.parametrize("value", COPIED_OFTEN, ids=lambda one: type(one).__name__)


@dataclass(frozen=True)
class Checked:
    number: int = 0

    def __post_init__(self) -> None:
        if self.number < 0:
            raise ValueError("expected no negative number")


@dataclass(frozen=True)
class Remembering:
    number: int = 0

    @cached_property
    def double(self) -> int:
        return 2 * self.number


@dataclass(frozen=True)
class Counting:
    number: int = 0
    twice: int = field(init=False, default=0)


@dataclass(frozen=True, slots=True)
class Slotted:
    number: int = 0


@copied_often
def test_it_does_what_the_standard_librarys_does(value: Any) -> None:
    name = dataclasses.fields(value)[0].name
    ours = replace(value, **{name: 7})
    assert ours == dataclasses.replace(value, **{name: 7})
    assert type(ours) is type(value)
    assert getattr(value, name) != 7
    assert vars(ours).keys() == vars(value).keys()


@copied_often
def test_a_field_that_there_is_none_of_is_refused(value: Any) -> None:
    with pytest.raises(TypeError, match="no field altitude_ft"):
        replace(value, altitude_ft=1)


def test_the_copy_is_as_frozen_as_the_original() -> None:
    vehicle = replace(VehicleState("SIM-1", 3), is_flying=Stamped(True, 5))
    with pytest.raises(FrozenInstanceError):
        vehicle.serial = "SIM-2"  # type: ignore[misc]


def test_what_a_value_checks_when_it_is_made_is_checked() -> None:
    with pytest.raises(ValueError, match="negative"):
        replace(Checked(1), number=-1)


def test_what_a_value_remembers_is_not_taken_over() -> None:
    value = Remembering(2)
    assert value.double == 4
    assert replace(value, number=3).double == 6


def test_a_field_that_is_not_to_be_given_is_refused() -> None:
    with pytest.raises(ValueError, match="init=False"):
        replace(Counting(), twice=4)


def test_any_other_frozen_value_can_be_replaced() -> None:
    assert replace(Slotted(1), number=2) == Slotted(2)
