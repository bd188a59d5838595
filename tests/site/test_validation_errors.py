"""Whatever a site's files say, the house's words tell which key was meant how."""

import re
from typing import Any

import msgspec
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from msgspec import inspect

from recon.model.errors import SiteError
from recon.site.elevation import ElevationTable
from recon.site.geojson import Polygons, Rings
from recon.site.layers import _Named, _PadProperties, _ZoneProperties
from recon.site.reading import convert, in_words, shown_value
from recon.site.schema import (
    GroundImageTable,
    ImagerTable,
    LayersTable,
    LimitsTable,
    OriginTable,
    SiteTable,
    VehicleTable,
)

TABLES: list[Any] = [
    *(
        SiteTable,
        OriginTable,
        LimitsTable,
        ImagerTable,
        GroundImageTable,
        LayersTable,
        VehicleTable,
    ),
    *(ElevationTable, _Named, _ZoneProperties, _PadProperties),
]
MSGSPECS_OWN = re.compile(r"Expected|Object|Invalid|`|\$|msgspec|float|str\b|int\b|regex|null")


def fields() -> list[tuple[Any, str, inspect.Type]]:
    """Return every key of every table, those of tables in tables too."""
    found = []
    for table in TABLES:
        for field in msgspec.inspect.type_info(table).fields:  # type: ignore[attr-defined]
            found.append((table, field.encode_name, field.type))
    return found


scalars = st.one_of(
    st.booleans(),
    st.integers(-(10**400), 10**400),
    st.floats(allow_nan=False, allow_infinity=False),
    st.text(max_size=90),
    st.dates(),
)
anything = st.recursive(
    scalars,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.text(max_size=12), inner, max_size=3)
    ),
    max_leaves=8,
)


def error_text(data: object, kind: Any, key: str) -> str | None:
    try:
        convert("site.toml", data, kind, key)
    except SiteError as problem:
        return str(problem)
    return None


@given(st.sampled_from(fields()), anything)
@example((SiteTable, "name", msgspec.inspect.type_info(str)), "a`b\u001b")
def test_a_wrong_value_of_any_key_names_the_key_what_was_meant_and_what_came(
    field: tuple[Any, str, inspect.Type], value: object
) -> None:
    table, key, kind = field
    others = {f.encode_name for f in msgspec.inspect.type_info(table).fields if f.required} - {key}  # type: ignore[attr-defined]
    text = error_text({key: value} | dict.fromkeys(others), table, "t")
    if text is None or f"t.{key}" not in text:
        return  # It was right, or another key's fault was found first.
    assert text.isprintable()
    assert text.startswith(f"site.toml: t.{key}")
    place, _, rest = text.partition(": expected ")
    words, _, got = rest.rpartition(", got ")
    assert not MSGSPECS_OWN.search(place + words)
    if place == f"site.toml: t.{key}" and words == in_words(kind):
        assert got.startswith(shown_value(value)[:20])


@pytest.mark.parametrize("field", fields(), ids=lambda field: f"{field[0].__name__}.{field[1]}")
def test_an_invalid_value_of_every_key_has_a_description(
    field: tuple[Any, str, inspect.Type],
) -> None:
    table, key, kind = field
    text = error_text({key: True}, table, "")
    words = in_words(kind)
    assert text == f"site.toml: {key}: expected {words}, got true"
    assert not MSGSPECS_OWN.search(words)


@pytest.mark.parametrize("table", TABLES)
@given(unknown=st.text(max_size=100))
@example(unknown="x` - at `$.name")
@example(unknown="x - at `$[0][...]")
@example(unknown="\u001b[2J")
def test_an_unknown_key_lists_the_known_ones(table: Any, unknown: str) -> None:
    known = [field.encode_name for field in msgspec.inspect.type_info(table).fields]  # type: ignore[attr-defined]
    if unknown in known:
        return
    text = error_text({unknown: 1}, table, "t")
    assert text is not None
    assert text.isprintable()
    lead = f"site.toml: t: expected only the keys {', '.join(known)}, got {shown_value(unknown)}"
    assert text.startswith(lead)


@given(st.sampled_from([Rings, Polygons]), anything)
def test_coordinates_are_described_as_positions_and_rings(kind: Any, value: object) -> None:
    text = error_text(value, kind, "coordinates")
    if text is not None:
        assert re.match(r"site\.toml: coordinates(\[\d+\])*: expected a", text)
        assert text.isprintable()


@pytest.mark.parametrize(
    ("latitude", "longitude", "is_hinted"),
    [(-93.6, 41.9, True), (-93.6, 100.0, False), (181.0, 41.9, False), (-93.6, "41", False)],
)
def test_swapped_degrees_get_a_hint(latitude: float, longitude: object, is_hinted: bool) -> None:
    pad = {"latitude_deg": latitude, "longitude_deg": longitude, "altitude_m": 1.0}
    text = error_text({"serial": "A", "pad": pad}, VehicleTable, "vehicles (entry 1)")
    assert text is not None
    assert text.startswith("site.toml: vehicles (entry 1).pad.latitude_deg: expected a number of")
    assert text.endswith("; latitude and longitude look swapped") == is_hinted
