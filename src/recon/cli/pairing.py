"""`recon pair`: apps that wait to be admitted to a station with a list of apps."""

from dataclasses import dataclass
from typing import Annotated

import msgspec
import typer

from recon.cli.connection import JsonOption, StationOptions, VehicleNameError, run_at_station
from recon.cli.exit_codes import DONE, REFUSED
from recon.cli.options import with_options
from recon.cli.output import print_json, print_line, print_table, refused
from recon.client import LinkStatus, Refusal, Station


@dataclass(frozen=True, slots=True, kw_only=True)
class PairOptions:
    """An app that waits, and what becomes of it."""

    app: Annotated[
        str | None,
        typer.Argument(metavar="APP", help="Serial, or number of the link. Without: list them."),
    ] = None
    session: Annotated[
        bool, typer.Option("--session", help="Until the station stops; not on the list.")
    ] = False
    any_address: Annotated[
        bool, typer.Option("--any-address", help="This serial from any address.")
    ] = False
    refuse: Annotated[bool, typer.Option("--refuse", help="Close it, and again for 5 minutes.")] = (
        False
    )
    as_json: JsonOption = False


@with_options
def pair_command(options: PairOptions, at: StationOptions) -> None:
    """List the apps that wait to be admitted; admit or refuse one.

    Admitted: this serial, from its present address, on the list. Look at the aircraft's own serial
    first: the protocol has no secret, and any program in the network can report any serial.
    """
    if options.app is None and (options.session or options.any_address or options.refuse):
        raise VehicleNameError("name the app: its serial, or the number of its link")
    run_at_station(at, lambda station: _pair(station, options))


async def _pair(station: Station, options: PairOptions) -> int:
    waiting = await station.waiting_apps()
    if options.app is None:
        return _print_waiting(waiting, options.as_json)
    link = _chosen(options.app, waiting or ())
    if options.refuse:
        return _print_refusal(link, await station.refuse_app(link.id))
    return await _admit(station, link, options)


async def _admit(station: Station, link: LinkStatus, options: PairOptions) -> int:
    serial = None if link.waiting is None else link.waiting.serial
    if serial is None:
        raise VehicleNameError(f"link {link.id} has not reported a serial; wait until it does")
    refusal = await station.admit_app(
        link.id, serial, is_for_good=not options.session, any_address=options.any_address
    )
    if refusal is not None:
        print_line(f"{serial}: {refused(refusal)}")
        return REFUSED
    lasting = "until the station stops" if options.session else "on the list"
    place = "any address" if options.any_address else link.remote_address
    print_line(f"{serial}: admitted from {place}, {lasting} (audited)")
    return DONE


def _print_waiting(waiting: tuple[LinkStatus, ...] | None, as_json: bool) -> int:
    if as_json:
        print_json(msgspec.to_builtins(waiting))
    elif waiting is None:
        print_line("this station has no list of apps: any app is admitted")
    elif not waiting:
        print_line("no app waits to be admitted")
    else:
        columns = ("link", "address", "serial", "waits", "in flight", "why")
        print_table("apps that wait to be admitted", columns, [_row(link) for link in waiting])
    return DONE


def _row(link: LinkStatus) -> tuple[str, ...]:
    waits = link.waiting
    assert waits is not None, "only waiting apps are listed"
    flies = {True: "yes", False: "no", None: "unknown"}[waits.is_flying]
    place = link.remote_address
    return (str(link.id), place, waits.serial or "", f"{waits.age_s:.0f} s", flies, waits.reason)


def _chosen(name: str, waiting: tuple[LinkStatus, ...]) -> LinkStatus:
    """Return the waiting app with this serial, or on this link; raises `VehicleNameError`."""
    found = [link for link in waiting if link.waiting is not None and link.waiting.serial == name]
    found = found or [link for link in waiting if str(link.id) == name]
    if len(found) == 1:
        return found[0]
    if found:
        links = ", ".join(str(link.id) for link in found)
        raise VehicleNameError(f"links {links} report serial {name}: name the link")
    raise VehicleNameError(f"expected the serial or link of an app that waits, got {name!r}")


def _print_refusal(link: LinkStatus, refusal: Refusal | None) -> int:
    if refusal is None:
        print_line(f"link {link.id} from {link.remote_address}: refused for 5 minutes (audited)")
        return DONE
    print_line(f"link {link.id}: {refused(refusal)}")
    return REFUSED
