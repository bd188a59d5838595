"""The site that is in force and its folder: changes are staged, saved, and in force at once.

Theory of operation. A change is staged by the service that edits (`site_service`, `site_vehicles`,
`calibration_service`), who holds `turn` meanwhile: one change at a time. Files are read and written
on threads. The event that brings a change into force checks again what may have changed while the
disk was busy; what is refused then is put back.
"""

import asyncio
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Generic, Literal, TypeVar

import numpy as np

from recon.api import schema
from recon.model.airspace import SiteLayer, layers_text
from recon.model.command import Refusal
from recon.model.errors import ReconError, SiteError
from recon.model.event import ImagerMarked, SiteRedrawn
from recon.model.person import Person, Role
from recon.record.files import file_set
from recon.site import Imager, Site, own_folder
from recon.site.drawing import (
    FENCES,
    DrawnFeatureError,
    StagedSite,
    drawing_digest,
    stage_files,
)
from recon.site.vehicle_rows import VehicleRowError
from recon.station.api_views import RunningStation
from recon.station.api_views.site_view import site_view
from recon.station.control import site_drawing

T = TypeVar("T")
AlsoChanged = Literal["vehicles", "calibration"]

NO_FOLDER = (
    "The station was started without a site's folder; make one with recon site new FOLDER and "
    "start with recon run --site FOLDER"
)
IS_DEMO = (
    "The demonstration's site is part of the program; make your own with recon site new FOLDER and "
    "rehearse there with recon demo --site FOLDER"
)
CHANGED_BY_HAND = (
    "site.toml or a layer's file was changed by hand since the start; restart the station to use it"
)
CHANGED_MEANWHILE = "The site was changed meanwhile, perhaps on another screen; load it again"


@dataclass(frozen=True, slots=True)
class SiteChange:
    """What a change did, or would do; with a `refusal`, what it was about."""

    layers: tuple[SiteLayer, ...] = ()
    vehicles: tuple[str, ...] = ()
    """One sentence for each that changes."""
    also: tuple[AlsoChanged, ...] = ()
    """What changes beside layers."""
    refusal: Refusal | None = None


@dataclass(frozen=True, slots=True)
class FolderRead(Generic[T]):
    """What was read of the folder, and why nothing can be saved in it, if so."""

    revision: str
    found: tuple[T, ...]
    locked_reason: str | None
    undo: schema.SavedChangeView | None


@dataclass(slots=True)
class EditedSite:
    """The site that is in force, and its folder."""

    driver: RunningStation
    site: Site
    folder: Path | None
    turn: asyncio.Lock = field(default_factory=asyncio.Lock)
    _applied: str | None = None
    """The digest of the files that are in force; None before the first reading."""

    def __post_init__(self) -> None:
        # Simplifying outlines with very many corners takes a moment: now, not in flight.
        site_view(self.site)
        if self.folder is not None and self.locked_reason is None:
            self._applied = drawing_digest(self.folder)

    @property
    def locked_reason(self) -> str | None:
        """Why nothing can be saved; None if it can."""
        if self.folder is None:
            return NO_FOLDER
        return IS_DEMO if own_folder(self.folder) is None else None

    async def read(self, read: Callable[[Path], tuple[T, ...]]) -> FolderRead[T]:
        """Return what is read of the folder; nothing where it cannot be read."""
        return await asyncio.to_thread(self._read, read)

    async def change(
        self,
        revision: str | None,
        stage: Callable[[Path], StagedSite],
        by: Person,
        *,
        is_check: bool = False,
    ) -> SiteChange:
        """Save what is staged and bring it into force, unless that is refused or only checked.

        Without a revision it may be of any. Raises `DrawnFeatureError` and `VehicleRowError`, which
        are about a part of what was staged.
        """
        staged = await self._staged(revision, stage)
        if isinstance(staged, Refusal):
            return SiteChange(refusal=staged)
        event, folder = self._event_of(staged, by, is_undo=False), self.folder
        change = self._change(staged, event)
        refusal = self._refusal(event, by)
        if refusal is None and not is_check and staged.files and folder is not None:
            what = ", ".join(filter(None, (layers_text(event.layers), *change.also))) or "site"
            refusal = await self._commit(
                staged,
                event,
                write=lambda: _save(folder, staged.files, event, what),
                put_back=lambda: _undo_last(folder),
            )
        return replace(change, refusal=refusal)

    async def undo(self, revision: str, by: Person) -> SiteChange:
        """Take back the newest change."""
        folder = self.folder
        if folder is None or self.locked_reason is not None:
            return SiteChange(refusal=site_refusal(self.locked_reason or NO_FOLDER))
        newest = await asyncio.to_thread(file_set.last_change, folder)
        if newest is None:
            return SiteChange(refusal=site_refusal("No change of the site to undo"))

        def stage(folder: Path) -> StagedSite:
            edited = ", ".join(file_set.changed_since(folder, newest))
            if edited:
                raise SiteError(f"{edited} was edited since then; an undo would lose that")
            return stage_files(folder, file_set.files_before(folder, newest))

        staged = await self._staged(revision, stage)
        if isinstance(staged, Refusal):
            return SiteChange(refusal=staged)
        event = self._event_of(staged, by, is_undo=True)
        change = self._change(staged, event)
        after = await asyncio.to_thread(_contents, folder, staged.files)
        about = {"what": newest.what, "by": newest.by, "utc": newest.utc}
        refusal = self._refusal(event, by) or await self._commit(
            staged,
            event,
            write=lambda: file_set.undo(folder, newest),
            put_back=lambda: file_set.replace_files(folder, after, **about),
        )
        return replace(change, refusal=refusal)

    def _read(self, read: Callable[[Path], tuple[T, ...]]) -> FolderRead[T]:
        folder, locked = self.folder, self.locked_reason
        if folder is None:
            return FolderRead("", (), locked, None)
        try:
            revision = drawing_digest(folder)
            if locked is None and revision != self._applied:
                locked = CHANGED_BY_HAND
            found = read(folder)
        except (ReconError, OSError):
            return FolderRead("", (), CHANGED_BY_HAND, None)
        newest = None if locked else file_set.last_change(folder)
        undo = None
        if newest is not None:
            undo = schema.SavedChangeView(what=newest.what, by=newest.by, utc=newest.utc)
        return FolderRead(revision, found, locked, undo)

    async def _staged(
        self, revision: str | None, stage: Callable[[Path], StagedSite]
    ) -> StagedSite | Refusal:
        if self.locked_reason is not None or self.folder is None:
            return site_refusal(self.locked_reason or NO_FOLDER)
        folder = self.folder
        try:
            on_disk = await asyncio.to_thread(drawing_digest, folder)
            if on_disk != self._applied:
                return site_refusal(CHANGED_BY_HAND)
            if revision is not None and on_disk != revision:
                return site_refusal(CHANGED_MEANWHILE)
            return await asyncio.to_thread(stage, folder)
        except (DrawnFeatureError, VehicleRowError):
            raise
        except ReconError as problem:
            return site_refusal(str(problem))
        except (OSError, ValueError) as problem:
            return site_refusal(f"{folder} cannot be read: {problem}")

    def _refusal(self, event: SiteRedrawn, by: Person) -> Refusal | None:
        refusal = site_drawing.refusal(self.driver.station, event, self.driver.now_ns())
        needs_admin = bool(FENCES & set(event.layers) or self._vehicles(event))
        if refusal is None and needs_admin and not by.role.includes(Role.ADMIN):
            return site_refusal(
                f"{by.name} has the role {by.role.value}; boundary, zones, pads and vehicles need "
                "admin"
            )
        return refusal

    def _change(self, staged: StagedSite, event: SiteRedrawn) -> SiteChange:
        vehicles = self._vehicles(event)
        also: list[AlsoChanged] = ["vehicles"] if vehicles else []
        if any(self._marked(staged.site, event.by)):
            also.append("calibration")
        return SiteChange(event.layers, vehicles, tuple(also))

    def _marked(self, staged: Site, by: str) -> Iterator[ImagerMarked]:
        """Yield the imaging drones whose camera is placed otherwise than in force."""
        for serial, imager in staged.imagers.items():
            known = self.site.imagers.get(serial)
            if known is not None and not _is_placed_alike(known, imager):
                rms_px = None if imager.solution is None else imager.solution.rms_px
                yield ImagerMarked(
                    serial, imager.marked_pose, imager.marked_frame, imager.outlook, rms_px, by
                )

    def _vehicles(self, event: SiteRedrawn) -> tuple[str, ...]:
        return site_drawing.changed_vehicles(self.site.profiles, event.profiles)

    async def _commit(
        self,
        staged: StagedSite,
        event: SiteRedrawn,
        *,
        write: Callable[[], None],
        put_back: Callable[[], None],
    ) -> Refusal | None:
        """Write the files and bring them into force; what fails or is refused is put back."""
        folder = self.folder
        assert folder is not None, "a drawing was staged in it"
        try:
            await asyncio.to_thread(write)
        except (OSError, ReconError) as problem:
            return site_refusal(f"{folder} cannot be written: {problem}")
        # A drone may have taken off while the disk was busy.
        refusal = site_drawing.refusal(self.driver.station, event, self.driver.now_ns())
        if refusal is not None:
            try:
                await asyncio.to_thread(put_back)
            except (OSError, ReconError) as problem:
                return site_refusal(
                    f"{refusal.reason}. It is not in force, but its files could not be taken back "
                    f"({problem}): restore the layers before the next start"
                )
            return refusal
        # Without an await between: the fence in force and the one shown are the same.
        drawn = staged.site
        marked = tuple(self._marked(drawn, event.by))
        if not marked or event.layers or self._vehicles(event):
            self.driver.handle(event)
        for each in marked:
            self.driver.handle(each)
        elevation = self.site.elevation if event.elevation is None else event.elevation
        self.site = replace(
            self.site,
            layers=drawn.layers,
            profiles=drawn.profiles,
            imagers=drawn.imagers,
            elevation=elevation,
        )
        site_view(self.site)
        self._applied = await asyncio.to_thread(drawing_digest, folder)
        return None

    def _event_of(self, staged: StagedSite, by: Person, *, is_undo: bool) -> SiteRedrawn:
        """Return the event that brings a staged site into force."""
        airspace = staged.site.airspace
        known, read = self.site.elevation, airspace.elevation
        has_other_ground = known is not None and read is not None and known.grid != read.grid
        return SiteRedrawn(
            airspace.boundary,
            airspace.zones,
            airspace.landing_pads,
            staged.site.profiles,
            staged.changed,
            by.label,
            is_undo=is_undo,
            elevation=read if has_other_ground else None,
        )


def _is_placed_alike(one: Imager, other: Imager) -> bool:
    a, b = one.marked_pose, other.marked_pose
    return (
        one.marked_frame == other.marked_frame
        and np.array_equal(a.position_enu_m, b.position_enu_m)
        and np.array_equal(a.rotation_enu_camera, b.rotation_enu_camera)
    )


def _contents(folder: Path, files: file_set.Files) -> file_set.Files:
    """Return the present contents of some files."""
    paths = {name: folder / name for name in files}
    return {name: path.read_bytes() if path.is_file() else None for name, path in paths.items()}


def _save(folder: Path, files: file_set.Files, event: SiteRedrawn, what: str) -> None:
    utc = datetime.now(UTC).isoformat(timespec="seconds")
    file_set.replace_files(folder, files, what=what, by=event.by, utc=utc)


def _undo_last(folder: Path) -> None:
    change = file_set.last_change(folder)
    if change is not None:
        file_set.undo(folder, change)


def site_refusal(reason: str) -> Refusal:
    """Return a refusal of a change of the site."""
    return Refusal(site_drawing.RULE, reason)
