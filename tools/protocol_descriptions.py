"""Descriptions of the wire protocol for other tools, made of `protocol/recon-drone.toml`.

    python -m tools.protocol_descriptions

writes `recon-drone.ksy` for Kaitai Struct, and `recon.lua` for Wireshark: the table as Lua, and
`dissector.lua`, which reads it.
"""

import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

FOLDER = Path(__file__).parents[1] / "protocol"
NUMBERS = {"u8": "u1", "u16": "u2", "i8": "s1", "f32": "f4", "f64": "f8"}
"""Types of one number, by Kaitai's names, whose last letter is their size in bytes."""
AROUND_BYTES = 9
"""Bytes of a packet beside its payload."""
UNITS = {"deg": "°", "m": "m", "mps": "m/s", "s": "s", "hz": "Hz", "percent": "%"}
WARNING = "Made of recon-drone.toml by `make docs`; do not edit it here."
KAITAI_PAGE = f"""{WARNING}

The packets of one direction of a connection, or of one file of vectors/. A parser of this stops at
damage: it knows the limits of sizes, but neither the hash nor the search for the next packet.
docs/icd.md states both. Texts are bytes: what an app sends need not be UTF-8.
"""

Table = Mapping[str, Any]


def main() -> None:
    """Write both files."""
    for name, text in descriptions().items():
        (FOLDER / name).write_text(text, "utf-8")


def descriptions() -> dict[str, str]:
    """Return the texts of both files by name."""
    table = tomllib.loads((FOLDER / "recon-drone.toml").read_text("utf-8"))
    reader = (FOLDER / "dissector.lua").read_text("utf-8")
    return {"recon-drone.ksy": kaitai(table), "recon.lua": f"{lua(table)}\n\n{reader}"}


def snake(name: str) -> str:
    """Return a name of the document, or a label, as an identifier."""
    words = re.sub(r"([a-z])([A-Z])", r"\1 \2", name)
    return re.sub(r"[^a-z0-9]+", "_", words.lower())


def unit_of(field: str) -> str:
    """Return the unit that a field's name ends with; empty without one."""
    return UNITS.get(field.rsplit("_", 1)[-1], "") if "_" in field else ""


def kaitai(table: Table) -> str:
    """Return the description in Kaitai's language."""
    meta = {
        "id": table["id"],
        "title": table["title"],
        "license": "Apache-2.0",
        "ks-version": "0.10",
        "endian": "be",
    }
    packets = {snake(each["name"]): _payload(each["fields"], table) for each in table["packets"]}
    waypoint = {"seq": [_number(each) for each in table["waypoint"]["fields"]]}
    most = table["limits"]["max_unknown_bytes"]
    whole = {
        "meta": meta,
        "doc": KAITAI_PAGE,
        "seq": [{"id": "packets", "type": "packet", "repeat": "eos"}],
        "types": {
            "packet": {"seq": _frame(table)},
            **packets,
            "waypoint": waypoint,
            "unknown_packet": {"seq": [_rest("payload", most)]},
        },
        "enums": {
            "pid": {each["pid"]: snake(each["name"]) for each in table["packets"]},
            **{
                name: {int(number): snake(label) for number, label in labels.items()}
                for name, labels in table["enums"].items()
            },
        },
    }
    return yaml.dump(whole, Dumper=_Pages, sort_keys=False, allow_unicode=True, width=100)


class _Pages(yaml.SafeDumper):
    """Writes texts of several lines as they are."""


def _as_page(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    style = "|" if "\n" in text else None
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Pages.add_representer(str, _as_page)


def _frame(table: Table) -> list[Table]:
    rows, cols = (table["limits"][f"max_image_{side}"] for side in ("rows", "cols"))
    names = [snake(each["name"]) for each in table["packets"]]
    cases = {**{f"pid::{name}": name for name in names}, "_": "unknown_packet"}
    return [
        {"id": "sync", "contents": list(table["sync"].to_bytes(2))},
        {
            "id": "size",
            "type": "u4",
            "valid": {"min": AROUND_BYTES, "max": AROUND_BYTES + 8 + 3 * rows * cols},
            "doc": "Bytes of the whole packet.",
        },
        {"id": "pid", "type": "u1", "enum": "pid"},
        {
            "id": "payload",
            "size": f"size - {AROUND_BYTES}",
            "type": {"switch-on": "pid", "cases": cases},
        },
        {"id": "hash_a", "type": "u1"},
        {"id": "hash_b", "type": "u1"},
    ]


def _payload(fields: list[Table], table: Table) -> Table:
    """Return a packet's type, whose fields must fill its payload."""
    seq = [each for field in fields for each in _attributes(field, table["limits"])]
    if fields[-1]["type"] == "waypoints":
        head, each = (sum(map(_bytes, some)) for some in (fields, table["waypoint"]["fields"]))
        most = head + each * table["limits"][fields[-1]["most"]]
        seq[-2]["valid"] = {"expr": f"_io.size >= {head + each} and _io.size <= {most}"}
    else:
        seq[-1].setdefault("valid", {"expr": "_io.eof"})
    return {"seq": seq}


def _bytes(field: Table) -> int:
    return int(NUMBERS.get(field["type"], "0")[-1])


def _attributes(field: Table, limits: Table) -> Iterator[dict[str, Any]]:
    """Yield what Kaitai reads of one field."""
    name, most = field["name"], limits.get(field.get("most", ""), 0)
    match field["type"]:
        case "string":
            yield {"id": f"len_{name}", "type": "u4", "valid": {"max": most}}
            yield {"id": name, "size": f"len_{name}", **_about(field)}
        case "image":
            for side in ("rows", "cols"):
                yield {"id": side, "type": "u2", "valid": {"max": limits[f"max_image_{side}"]}}
            yield {"id": name, "size": "rows * cols * 3", **_about(field)}
        case "rest":
            yield {**_rest(name, most), **_about(field)}
        case "waypoints":
            yield {"id": name, "type": "waypoint", "repeat": "eos"}
        case _:
            yield _number(field)


def _rest(name: str, most: int) -> dict[str, Any]:
    return {"id": name, "size-eos": True, "valid": {"expr": f"_.length <= {most}"}}


def _number(field: Table) -> dict[str, Any]:
    enum = {"enum": field["enum"]} if "enum" in field else {}
    return {"id": field["name"], "type": NUMBERS[field["type"]], **enum, **_about(field)}


def _about(field: Table) -> dict[str, str]:
    unit = unit_of(field["name"])
    return {
        **({"-unit": unit} if unit else {}),
        **({"doc": field["doc"]} if "doc" in field else {}),
    }


def lua(table: Table) -> str:
    """Return the table as Lua, with what a reader of it would ask first."""
    names = {each["pid"]: each["name"] for each in table["packets"]}
    enums = {"pid": names} | {
        name: {int(number): label for number, label in labels.items()}
        for name, labels in table["enums"].items()
    }
    packets = {
        each["pid"]: {
            "name": each["name"],
            "id": snake(each["name"]),
            "from": each["from"],
            "fields": [_lua_field(field) for field in each["fields"]],
        }
        for each in table["packets"]
    }
    waypoint = [_lua_field(field) for field in table["waypoint"]["fields"]]
    return "\n".join(
        (
            f"-- {WARNING}",
            "-- How to use it: docs/how-to/look-at-packets-in-wireshark.md",
            f"local PORT, SYNC = {table['port']}, {table['sync']}",
            f"local LIMITS = {_lua(table['limits'])}",
            f"local ENUMS = {_lua(enums)}",
            f"local WAYPOINT = {_lua(waypoint)}",
            f"local PACKETS = {_lua(packets)}",
        )
    )


def _lua_field(field: Table) -> Table:
    """Return a field with its words for a person: `latitude (°)`."""
    unit = unit_of(field["name"])
    words = field["name"].rsplit("_", 1)[0] if unit else field["name"]
    shown = words.replace("_", " ") + (f" ({unit})" if unit else "")
    return {"id": field["name"], "shown": shown, **{k: v for k, v in field.items() if k != "name"}}


def _lua(value: object, indent: str = "") -> str:
    """Return a value as a Lua expression; tables that are long have a line for each item."""
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, int):
        return str(value)
    inner = indent + "    "
    if isinstance(value, Mapping):
        items = [f"{_lua_key(key)} = {_lua(item, inner)}" for key, item in value.items()]
    else:
        assert isinstance(value, list)
        items = [_lua(item, inner) for item in value]
    line = "{ " + ", ".join(items) + " }"
    if len(line) <= 96 - len(indent) and "\n" not in line:
        return line
    return "{\n" + "".join(f"{inner}{item},\n" for item in items) + indent + "}"


def _lua_key(key: object) -> str:
    return f"[{key}]" if isinstance(key, int) else str(key)


if __name__ == "__main__":
    main()
