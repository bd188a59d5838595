"""Alarms about apps that the list does not admit, and about the list's file."""

from collections.abc import Iterator

from recon.fleet import pairing
from recon.fleet.admission import host_of
from recon.fleet.state import Fleet, LinkRecord
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.station import Station

MAX_HOSTS = 8
"""Waiting apps of more hosts share one alarm: many connections must not fill the list."""


def conditions(station: Station) -> Iterator[Condition]:
    """Yield an alarm for each host with waiting apps, and one if the list cannot be written."""
    if station.app_list_problem is not None:
        text = f"{station.app_list_problem}: apps admitted since are admitted for this run only"
        yield Condition("app_list", Severity.ERROR, "app_list", "", text)
    if not station.fleet.admission.is_in_force:
        return
    by_host: dict[str, list[LinkRecord]] = {}
    for link in station.fleet.links.values():
        if link.is_waiting:
            by_host.setdefault(host_of(link.remote_address), []).append(link)
    for host in list(by_host)[:MAX_HOSTS]:
        yield _of_host(station, host, by_host[host])
    if len(by_host) > MAX_HOSTS:
        text = f"apps of {len(by_host) - MAX_HOSTS} more hosts wait to be admitted"
        yield Condition("app_waits:more", Severity.ERROR, "app_waits", "", text)


def _of_host(station: Station, host: str, links: list[LinkRecord]) -> Condition:
    """Name what matters most: a serial of the list, then flight, then the oldest."""
    fleet = station.fleet
    links = sorted(links, key=lambda link: not _is_grave(fleet, link))
    first = links[0]
    serial = first.waiting_serial
    what = "without a serial yet" if serial is None else f"with serial {serial}"
    flies = ", in flight" if first.own_state.is_flying.value is True else ""
    more = f" and {len(links) - 1} more" if len(links) > 1 else ""
    text = (
        f"app from {host} {what}{flies} (link {first.id}{more}) waits: "
        f"{pairing.objection(fleet, first)}. It is watched as traffic and only stopped, not "
        "moved: admit it, or refuse it"
    )
    is_grave = any(_is_grave(fleet, link) for link in links)
    return Condition(
        key=f"app_waits:{host}",
        severity=Severity.ERROR if is_grave else Severity.WARNING,
        rule="app_waits",
        vehicle_name="",
        text=text,
        link_id=first.id,
        after_s=0.0 if serial is not None else station.settings.serial_wait_s,
    )


def _is_grave(fleet: Fleet, link: LinkRecord) -> bool:
    """Whether a listed serial is reported from elsewhere, or the app reports flight."""
    is_listed = link.waiting_serial is not None and fleet.admission.is_listed(link.waiting_serial)
    return is_listed or link.own_state.is_flying.value is True
