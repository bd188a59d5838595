"""Restarts in virtual time: a station ends without a word, and another one reads its snapshot."""

from dataclasses import replace

from tests.station.station_world import World

from recon.station.recovery.restart import LastRun, restored
from recon.station.recovery.snapshot import (
    RecoverySnapshot,
    decode_snapshot,
    encode_snapshot,
    take_snapshot,
)
from recon.station.state.station import Station


def saved(station: Station, now_ns: int) -> RecoverySnapshot:
    """The snapshot of a station, as it comes back from its file."""
    return decode_snapshot(encode_snapshot(take_snapshot(station, now_ns)))


def restored_from(
    snapshot: RecoverySnapshot, now_ns: int, station: Station | None = None
) -> Station:
    return restored(station or Station(), LastRun(snapshot), now_ns)


def restart(here: World, snapshot: RecoverySnapshot | None = None) -> Station:
    """The station as another run begins with it now, without any link."""
    old, now_ns = here.driver.station, here.driver.now_ns
    fresh = replace(Station(settings=old.settings), airspace=old.airspace.with_temporary_zones(()))
    fresh = replace(fresh, fleet=replace(fresh.fleet, profiles=old.fleet.profiles))
    return restored_from(snapshot or saved(old, now_ns), now_ns, fresh)


def restart_world(here: World, gone_s: float = 2.0) -> None:
    """Kill the station, start another one, and let the apps reconnect.

    The driver's log then holds the events of the new run only.
    """
    snapshot = saved(here.driver.station, here.driver.now_ns)
    apps = [connected.app for connected in here.connected.values()]
    for connected in tuple(here.connected.values()):
        here.driver.disconnect(connected.link_id)
        connected.app.disconnected()
    here.run_for(gone_s)
    here.driver.station = restart(here, snapshot)
    here.driver.log.clear()
    for app in apps:
        here.connect(app)
