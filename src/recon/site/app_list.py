"""The list of admitted companion apps, apps.toml: reading it, and writing it after a pairing.

A file of its own: the station rewrites it when an operator pairs an app, and never touches the
site.toml that a person wrote.
"""

import json
from ipaddress import ip_network
from pathlib import Path
from typing import Annotated, Any

from msgspec import Meta, Struct

from recon.fleet.admission import MAX_ENTRIES, AllowedApp, Network, network_text
from recon.model.errors import SiteError
from recon.site.load import PLACEHOLDER_SERIAL
from recon.site.reading import convert, read_toml, shown_value
from recon.site.schema import Serial

APPS_FILE = "apps.toml"
LARGEST_FILE_BYTES = 256 * 1024
HEADER = """\
# The companion apps that this station admits. An app that no entry agrees with is watched and can
# be stopped, but is not moved. `recon pair` rewrites this file without your comments.
"""

AddressText = Annotated[
    str,
    Meta(
        min_length=2,
        max_length=64,
        pattern=r"^[0-9A-Fa-f:./]+$",
        description="an IP address or network, such as 192.168.10.21 or 192.168.10.0/24",
    ),
]


class AppTable(Struct, frozen=True, forbid_unknown_fields=True):
    """One of [[apps]]: a serial, an address or network, or both."""

    serial: Serial | None = None
    address: AddressText | None = None


class AppsTable(Struct, frozen=True, forbid_unknown_fields=True):
    """The whole file; without an entry no app is admitted."""

    apps: list[dict[str, Any]] = []


def read_app_list(path: Path) -> tuple[AllowedApp, ...]:
    """Return the entries of a file; raises `SiteError` with file and key."""
    values = read_toml(path, LARGEST_FILE_BYTES, "a list of apps")
    tables = convert(path, values, AppsTable, "").apps
    if len(tables) > MAX_ENTRIES:
        raise SiteError(f"{path}: apps: expected at most {MAX_ENTRIES} entries, got {len(tables)}")
    return tuple(_entry(path, table, number) for number, table in enumerate(tables, start=1))


def app_list_text(entries: tuple[AllowedApp, ...]) -> str:
    """Return the file's text; `read_app_list` of it gives the same entries."""
    return HEADER + "".join(_table(entry) for entry in entries)


def _entry(path: Path, data: dict[str, Any], number: int) -> AllowedApp:
    key = f"apps (entry {number})"
    table = convert(path, data, AppTable, key)
    if table.serial is None and table.address is None:
        raise SiteError(f"{path}: {key}: expected a serial, an address, or both; got neither")
    if table.serial == PLACEHOLDER_SERIAL:
        raise SiteError(
            f"{path}: {key}.serial: expected an aircraft's own serial, got the placeholder "
            f"{PLACEHOLDER_SERIAL!r} that apps send before they know it"
        )
    network = None if table.address is None else _network(path, table.address, f"{key}.address")
    return AllowedApp(table.serial, network)


def _network(path: Path, text: str, key: str) -> Network:
    try:
        return ip_network(text)
    except ValueError as problem:
        raise SiteError(
            f"{path}: {key}: expected an IP address or network, such as 192.168.10.21 or "
            f"192.168.10.0/24, got {shown_value(text)} ({problem})"
        ) from problem


def _table(entry: AllowedApp) -> str:
    lines = ["", "[[apps]]"]
    # A serial is printable ASCII: there JSON's strings are TOML's.
    if entry.serial is not None:
        lines.append(f"serial = {json.dumps(entry.serial)}")
    if entry.network is not None:
        lines.append(f'address = "{network_text(entry.network)}"')
    return "\n".join(lines) + "\n"
