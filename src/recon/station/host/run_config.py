"""How a station is started, and where it then listens."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from pathlib import Path

from recon.api.addresses import SharedAddress
from recon.detection import DetectionSettings
from recon.fleet.admission import AllowedApp
from recon.forecast import ForecastSettings
from recon.link.settings import LinkSettings
from recon.record.files.users_file import default_users_file
from recon.site import Site
from recon.station.audit.start import AuditPlace
from recon.station.host.http_servers import NetworkConfig
from recon.station.recording.keyframe import EVERYTHING, RecordDetail


@dataclass(frozen=True, slots=True)
class RunConfig:
    """How a station is started. Everything binds loopback by default."""

    site: Site
    link_host: str = "127.0.0.1"
    link_port: int = 3001
    is_announced: bool = False
    """Whether mDNS announces the link to apps on the network of `link_host`."""
    http_host: str = "127.0.0.1"
    http_port: int = 8080
    stop_port: int | None = None
    """The guard's port on loopback; None: no guard."""
    site_folder: Path | None = None
    """Where the site was read from; its digest goes into the audit."""
    record_folder: Path | None = None
    """Folder of the flight records; None: nothing is recorded."""
    is_record_required: bool = False
    """Whether a folder that cannot be written is an error at the start, not only an alarm."""
    record_detail: RecordDetail = EVERYTHING
    audit: AuditPlace | None = None
    """None: the place in the user's state folder that belongs to the link port."""
    users_file: Path | None = None
    """None: the one of this computer's user."""
    https_host: str | None = None
    """Address for other computers; None: they reach nothing."""
    https_port: int = 8443
    certificate: Path | None = None
    key: Path | None = None
    """The site's own certificate with its key; without one the station generates one."""
    console: Path | None = None
    link: LinkSettings = field(default_factory=LinkSettings)
    apps_file: Path | None = None
    """The list of admitted apps; None: any app is admitted."""
    apps: tuple[AllowedApp, ...] | None = None
    """The entries of that file."""
    wind_aloft_mps: tuple[float, float] | None = None
    """Wind at the clouds' height, east and north, by a forecast fetched before; None: unknown."""
    detection: str = DetectionSettings().method
    forecast: str = ForecastSettings().method
    sun_time_ahead_s: float = 0.0
    """How far the time of day of simulated drones is ahead of the computer's clock."""
    light_sensors: str | None = None
    """Where loggers of light sensors are read: `tcp://HOST:PORT` or a CSV file; None: nowhere."""
    repeats_surveys: bool = False
    """Whether this is a demonstration, which begins one survey after another."""
    scenario: str = ""
    """The simulated world, for the record (`score/truth.py`); empty for real aircraft."""

    @property
    def network(self) -> NetworkConfig:
        """The part about other computers."""
        users = self.users_file or default_users_file()
        return NetworkConfig(users, self.https_host, self.https_port, self.certificate, self.key)


@dataclass(frozen=True, slots=True)
class Started:
    """Where a station listens."""

    link_addresses: list[str]
    link_port: int
    console_url: str
    stop_url: str | None = None
    """Where a person stops all vehicles when the station does not answer; None without a guard."""
    audit_folder: str = ""
    record_folder: str = ""
    light_sensors: str = ""
    """Where loggers of light sensors are read; empty: nowhere."""
    apps_listed: int | None = None
    """Entries of the list of apps; None without a list."""
    network: SharedAddress | None = None
    """What other computers use; None when they reach nothing."""
    app_url: str | None = None
    """Address for apps on other devices, as in QR codes; None when they cannot connect."""
    resumed: str = ""
    """What this run continues from the last one, in words; empty if nothing."""


OnStart = Callable[[Started], Awaitable[None]]
