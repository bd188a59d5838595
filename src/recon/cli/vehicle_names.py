"""Which vehicles a person means: by serial, or by the name the site gives them."""

from collections.abc import Sequence

from recon.client import ClientError, Station, Telemetry


class NamingError(ClientError):
    """A name that is no vehicle's, or several vehicles'."""


def serials_of(station: Station, names: Sequence[str]) -> list[str]:
    """Return the serial of each name, each once; raises `NamingError`.

    A serial counts more than a name that reads the same. Case does not matter for names.
    """
    known = station.vehicles()
    return list(dict.fromkeys(_serial_of(name, known) for name in names))


def _serial_of(name: str, known: Sequence[Telemetry]) -> str:
    serials = [v.serial for v in known if v.serial is not None]
    if name in serials:
        return name
    named = [v.serial for v in known if v.name.casefold() == name.casefold() and v.serial]
    if len(named) == 1:
        return named[0]
    if named:
        raise NamingError(f"{len(named)} vehicles are called {name!r}: give a serial")
    told = ", ".join(f"{v.serial} ({v.name})" for v in known if v.serial) or "none"
    raise NamingError(f"expected a vehicle's serial or name, got {name!r}; there are: {told}")
