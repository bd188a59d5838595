"""The codec: what was encoded comes back to the bit, and hostile bytes are one error."""

import contextlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, make_dataclass
from enum import Enum
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typing_extensions import TypeAliasType

from recon.model.event import CommandAnswered, LinkOpened
from recon.model.units import Stamped
from recon.record.mcap.codec import MOST_SKIPPED, Codec, CodecError
from recon.record.mcap.digest import digest


class Colour(Enum):
    RED = "red"


@dataclass(frozen=True, slots=True)
class Circle:
    radius_m: float


@dataclass(frozen=True, slots=True)
class Square:
    side_m: float
    colour: Colour = Colour.RED


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    name: str
    shape: Circle | Square | int | None
    pixels: npt.NDArray[np.uint8]
    weights: npt.NDArray[np.float64] | None = None
    within: "Picture | None" = None
    ages: Mapping[tuple[int, str], Stamped[float]] = field(default_factory=dict)
    tags: frozenset[str] = frozenset()
    path: Path = Path()


def picture(**changes: object) -> Picture:
    pixels = np.arange(12, dtype=np.uint8).reshape(2, 3, 2)
    return Picture(**{"name": "a", "shape": Circle(2.5), "pixels": pixels, **changes})  # type: ignore[arg-type]


def there_and_back(value: Picture) -> Picture:
    found: Picture = Codec().decode(Codec().encode(value, Picture), Picture)
    return found


def test_spectra_are_kept() -> None:
    """A file that begins in flight has those of the forecast in its first state."""
    spectrum = np.array([[1 + 2j, -0.5j]], np.complex64)
    hint = npt.NDArray[np.complex64]
    found = Codec().decode(Codec().encode(spectrum, hint), hint)
    assert found.dtype == np.complex64
    assert (found == spectrum).all()


@pytest.mark.parametrize("shape", [None, 7, Circle(-0.0), Square(1.0), Square(5)])
def test_each_type_of_a_union_comes_back(shape: object) -> None:
    back = there_and_back(picture(shape=shape))
    assert back.shape == shape
    assert type(back.shape) is type(shape)
    assert digest(back.shape) == digest(shape)


def test_a_whole_value_comes_back() -> None:
    value = picture(
        within=picture(name="inside"),
        ages={(3, "x"): Stamped(1.5, 7), (1, "y"): Stamped()},
        tags=frozenset({"one", "two"}),
        path=Path("/a/b"),
        weights=np.array([[1.0, math.nan], [-0.0, math.inf]]),
    )
    back = there_and_back(value)
    assert digest(back) == digest(value)
    assert list(back.ages) == [(3, "x"), (1, "y")]
    assert back.within is not None


@given(st.floats(), st.integers(-(2**63), 2**63 - 1), st.text(), st.none() | st.booleans())
def test_numbers_and_text_come_back_to_the_bit(
    seconds: float, number: int, text: str, positive: bool | None
) -> None:
    assert digest(there_and_back(picture(shape=Circle(seconds)))) == digest(
        picture(shape=Circle(seconds))
    )
    event = CommandAnswered(1, number, positive)
    assert Codec().decode(Codec().encode(event, CommandAnswered), CommandAnswered) == event
    assert there_and_back(picture(name=text)).name == text


def test_the_order_of_an_arrays_memory_comes_back() -> None:
    by_column = np.asfortranarray(np.arange(6.0).reshape(2, 3))
    back = there_and_back(picture(weights=by_column)).weights
    assert back is not None
    assert back.flags.f_contiguous
    assert not back.flags.c_contiguous
    assert (back == by_column).all()
    strided = np.arange(12.0).reshape(3, 4)[:, ::2]
    back = there_and_back(picture(weights=strided)).weights
    assert back is not None
    assert (back == strided).all()


def test_an_alias_is_what_it_names() -> None:
    """As `NDArray` is one where Python and NumPy have such."""
    scalar = TypeVar("scalar", bound=np.generic)
    array = TypeAliasType("array", np.ndarray[Any, np.dtype[scalar]], type_params=(scalar,))  # type: ignore[misc]
    numbers, codec = np.array([1.5, 2.5]), Codec()
    for hint in (array[np.float64], array[np.float64] | int):  # type: ignore[misc]
        assert codec.decode(codec.encode(numbers, hint), hint).tolist() == [1.5, 2.5]
        with pytest.raises(CodecError, match="array of float64"):
            codec.decode(codec.encode(np.array([1]), array[np.int64]), array[np.float64])


def test_numpys_numbers_in_fields_become_pythons() -> None:
    back = there_and_back(picture(shape=Circle(np.float64(0.1))))  # type: ignore[arg-type]
    assert back.shape == Circle(0.1)


def test_a_field_that_is_missing_takes_its_default() -> None:
    assert Codec().from_builtins({"side_m": 2.0}, Square) == Square(2.0)


def test_a_field_of_another_version_is_noted_and_skipped() -> None:
    codec = Codec()
    assert codec.from_builtins({"side_m": 2.0, "__class__": 1}, Square) == Square(2.0)
    assert codec.skipped == {"Square.__class__"}
    codec.from_builtins({"side_m": 2.0} | {f"{n}" * 99: n for n in range(999)}, Square)
    assert len(codec.skipped) == MOST_SKIPPED


@pytest.mark.parametrize(
    ("value", "what"),
    [
        ({}, "Square.side_m is missing"),
        ({"side_m": "1"}, "expected a number, got str"),
        ({"side_m": 1.0, "colour": "blue"}, "expected a Colour"),
        (["side_m"], "expected dict, got list"),
    ],
)
def test_what_is_no_square_is_refused(value: object, what: str) -> None:
    with pytest.raises(CodecError, match=what):
        Codec().from_builtins(value, Square)


@pytest.mark.parametrize(
    "array",
    [
        {"dtype": "|O", "shape": [1], "data": b"12345678"},
        {"dtype": "<f8", "shape": [2**31, 2**31], "data": b""},
        {"dtype": "<f8", "shape": [-1], "data": b"12345678"},
        {"dtype": "<f8", "shape": [2], "data": b"12345678"},
        {"dtype": "|u1", "shape": [1] * 9, "data": b"1"},
        {"dtype": "nonsense", "shape": [1], "data": b"1"},
        {"dtype": "<f8", "shape": [1], "data": b"12345678", "order": 3},
    ],
)
def test_what_is_no_picture_is_refused(array: dict[str, object]) -> None:
    value = {"name": "a", "shape": None, "pixels": array}
    with pytest.raises(CodecError):
        Codec().from_builtins(value, Picture)


def test_only_the_types_of_a_hint_are_made() -> None:
    for name in ("Path", "Popen", "eval", "Square", ""):
        with pytest.raises(CodecError, match="expected one of"):
            Codec().from_builtins({"_": name, "radius_m": 1.0}, CommandAnswered | LinkOpened)


@given(st.binary(max_size=300))
def test_any_bytes_are_a_value_or_one_error(data: bytes) -> None:
    with contextlib.suppress(CodecError):
        assert isinstance(Codec().decode(data, Picture), Picture)


@given(st.data())
def test_damaged_bytes_are_a_value_or_one_error(data: st.DataObject) -> None:
    whole = bytearray(Codec().encode(picture(within=picture()), Picture))
    whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    with contextlib.suppress(CodecError):
        Codec().decode(bytes(whole), Picture)


def test_deep_nesting_is_one_error() -> None:
    deep: dict[str, object] = {}
    for _ in range(600):
        deep = {"within": deep}
    with pytest.raises(CodecError):
        Codec().decode(msgspec.msgpack.encode(deep), Picture)


def test_a_digest_tells_values_apart() -> None:
    values = [
        picture(),
        picture(name="b"),
        picture(shape=Circle(0.0)),
        picture(shape=Circle(-0.0)),
        picture(shape=0),
        picture(pixels=np.arange(12, dtype=np.uint8).reshape(3, 2, 2)),
        picture(weights=np.zeros(3)),
        picture(weights=np.zeros(3, np.float32)),
    ]
    assert len({digest(value) for value in values}) == len(values)
    assert digest(picture()) == digest(picture())


def _square(*later: tuple[str, type, object]) -> Any:
    return make_dataclass("Square", [("side_m", float), *later], frozen=True)


def test_a_type_that_gains_a_field_keeps_its_digests() -> None:
    before = _square()
    after = _square(
        ("angle_deg", float, 0.0),
        ("names", tuple[str, ...], ()),
        ("sides", tuple[float, ...], (1.0, 2.0)),
        ("inside", Circle, Circle(1.0)),
        ("weights", npt.NDArray[np.float64], field(default_factory=lambda: np.zeros(2))),
    )
    old = digest(before(2.0))
    assert digest(after(2.0)) == old
    assert digest(after(2.0, np.float64(0.0), [], [1.0, 2.0], Circle(np.float64(1.0)))) == old
    for changed in (-0.0, 0, 1.0):
        assert digest(after(2.0, changed)) != old
    assert digest(after(2.0, names=("a",))) != old
    assert digest(after(2.0, sides=(1.0, 3.0))) != old
    assert digest(after(2.0, inside=Circle(-1.0))) != old
    assert digest(after(2.0, weights=np.ones(2))) != old
    assert digest(after(2.0, weights=np.zeros(2, np.float32))) != old
