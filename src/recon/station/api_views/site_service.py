"""The site's folder, edited while the station runs: changes are checked, saved, and in force.

Files are read and written on threads. One change at a time; the event that brings it into force
checks again what may have changed meanwhile, and what it refuses is put back.
"""

import asyncio
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Generic, Literal, TypeVar

import numpy as np

from recon.api import schema
from recon.model.airspace import SiteLayer, layers_text
from recon.model.command import Refusal
from recon.model.errors import ReconError, SiteError
from recon.model.event import ImagerMarked, SiteRedrawn
from recon.model.person import Person, Role
from recon.record import file_set
from recon.site import Imager, Site, demo_site_folder
from recon.site.drawing import (
    FENCES,
    DrawnFeature,
    DrawnFeatureError,
    StagedSite,
    drawing_digest,
    read_drawing,
    stage_drawing,
    stage_files,
)
from recon.site.imports import read_import
from recon.site.vehicle_rows import (
    VehicleRow,
    VehicleRowError,
    read_vehicle_rows,
    stage_vehicles,
)
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
IMPORT_IS_BUSY = "Another file is being read; try again when it is done"
CHANGED_MEANWHILE = "The site was changed meanwhile, perhaps on another screen; load it again"


@dataclass(slots=True)
class SiteService:
    """The site that is in force, and its folder."""

    driver: RunningStation
    site: Site
    folder: Path | None
    numbers: Callable[[], Mapping[str, int]] = dict
    """The vehicles' numbers in force, by serial."""
    _applied: str | None = None
    """The digest of the files that are in force; None before the first reading."""
    turn: asyncio.Lock = field(default_factory=asyncio.Lock)
    _reading: asyncio.Lock = field(default_factory=asyncio.Lock)
    """Held while a file is imported: each takes a process with memory of its own."""

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
        is_demo = self.folder.resolve() == demo_site_folder().resolve()
        return IS_DEMO if is_demo else None

    async def drawing(self) -> schema.SiteDrawingView:
        """Return the layers in the folder."""
        async with self.turn:
            return await asyncio.to_thread(self._view)

    async def save(
        self, asked: schema.SiteDrawingRequest, by: Person, *, is_check: bool
    ) -> schema.SiteDrawingResponse:
        """Check a drawing; then save it and bring it into force, unless it is only checked."""
        features = [_feature(each) for each in asked.features]

        def stage(folder: Path) -> StagedSite:
            return stage_drawing(folder, features)

        async with self.turn:
            try:
                staged = await self.staged(asked.revision, stage)
            except DrawnFeatureError as problem:
                return _refused(_refusal(str(problem)), feature=problem.index)
            if isinstance(staged, Refusal):
                return _refused(staged)
            event = self.event_of(staged, by, is_undo=False)
            refusal = await self.put_in_force(staged, event, by, is_check=is_check)
            if refusal is not None:
                return _refused(refusal, event.layers)
            view = None if is_check else await asyncio.to_thread(self._view)
        return _answer(event.layers, drawing=view)

    async def vehicles(self) -> schema.SiteVehiclesView:
        """Return the vehicles in the folder."""
        async with self.turn:
            return await asyncio.to_thread(self._vehicles_view)

    async def save_vehicles(
        self, asked: schema.SiteVehiclesRequest, by: Person, *, is_check: bool
    ) -> schema.SiteVehiclesResponse:
        """Check the vehicles; then save them and bring them into force, unless only checked."""
        rows = [VehicleRow(**row.model_dump()) for row in asked.vehicles]
        given = self.numbers()

        def stage(folder: Path) -> StagedSite:
            known = {row.serial: row.number for row in read_vehicle_rows(folder)}
            kept = [
                # The number that the station gave is not fixed in site.toml by a save.
                replace(row, number=known.get(row.serial))
                if row.number == given.get(row.serial)
                else row
                for row in rows
            ]
            return stage_vehicles(folder, kept)

        async with self.turn:
            try:
                self._refuse_numbers(rows, given)
                staged = await self.staged(asked.revision, stage)
            except VehicleRowError as problem:
                return _vehicles_answer(refusal=_refusal(str(problem)), row=problem.index)
            if isinstance(staged, Refusal):
                return _vehicles_answer(refusal=staged)
            event = self.event_of(staged, by, is_undo=False)
            changes = self._changes(event)
            refusal = await self.put_in_force(staged, event, by, is_check=is_check)
            if refusal is not None:
                return _vehicles_answer(refusal=refusal)
            view = None if is_check else await asyncio.to_thread(self._vehicles_view)
        return _vehicles_answer(changes=changes, view=view)

    async def undo(self, revision: str, by: Person) -> schema.SiteDrawingResponse:
        """Take back the newest change."""
        async with self.turn:
            folder = self.folder
            if folder is None or self.locked_reason is not None:
                return _refused(_refusal(self.locked_reason or NO_FOLDER))
            change = await asyncio.to_thread(file_set.last_change, folder)
            if change is None:
                return _refused(_refusal("No change of the site to undo"))

            def stage(folder: Path) -> StagedSite:
                edited = ", ".join(file_set.changed_since(folder, change))
                if edited:
                    raise SiteError(f"{edited} was edited since then; an undo would lose that")
                return stage_files(folder, file_set.files_before(folder, change))

            staged = await self.staged(revision, stage)
            if isinstance(staged, Refusal):
                return _refused(staged)
            event = self.event_of(staged, by, is_undo=True)
            after = await asyncio.to_thread(_contents, folder, staged.files)
            about = {"what": change.what, "by": change.by, "utc": change.utc}
            also = self._also(staged, event)
            refusal = self._refusal(event, by) or await self._commit(
                staged,
                event,
                write=lambda: file_set.undo(folder, change),
                put_back=lambda: file_set.replace_files(folder, after, **about),
            )
            if refusal is not None:
                return _refused(refusal, event.layers)
            view = await asyncio.to_thread(self._view)
        return _answer(event.layers, drawing=view, also=also)

    async def import_features(self, name: str, data: bytes) -> schema.ImportedView:
        """Return the polygons and points of a file, or why it is refused."""
        if self._reading.locked():
            return schema.ImportedView(features=[], left_out=0, reason=IMPORT_IS_BUSY)
        try:
            async with self._reading:
                found = await asyncio.to_thread(read_import, name, data)
        except ReconError as problem:
            return schema.ImportedView(features=[], left_out=0, reason=str(problem))
        features = [
            schema.ImportedFeatureView(
                name=each.name, geometry=schema.DrawnGeometry.model_validate(each.geometry)
            )
            for each in found.features
        ]
        return schema.ImportedView(features=features, left_out=found.left_out, reason=None)

    async def staged(
        self, revision: str | None, stage: Callable[[Path], StagedSite]
    ) -> StagedSite | Refusal:
        """Return a change of the folder, unless that is refused; without a revision of any."""
        if self.locked_reason is not None or self.folder is None:
            return _refusal(self.locked_reason or NO_FOLDER)
        folder = self.folder
        try:
            on_disk = await asyncio.to_thread(drawing_digest, folder)
            if on_disk != self._applied:
                return _refusal(CHANGED_BY_HAND)
            if revision is not None and on_disk != revision:
                return _refusal(CHANGED_MEANWHILE)
            return await asyncio.to_thread(stage, folder)
        except (DrawnFeatureError, VehicleRowError):
            raise
        except ReconError as problem:
            return _refusal(str(problem))
        except (OSError, ValueError) as problem:
            return _refusal(f"{folder} cannot be read: {problem}")

    def _refusal(self, event: SiteRedrawn, by: Person) -> Refusal | None:
        refusal = site_drawing.refusal(self.driver.station, event, self.driver.now_ns())
        needs_admin = bool(FENCES & set(event.layers) or self._changes(event))
        if refusal is None and needs_admin and not by.role.includes(Role.ADMIN):
            return _refusal(
                f"{by.name} has the role {by.role.value}; boundary, zones, pads and vehicles need "
                "admin"
            )
        return refusal

    def _also(self, staged: StagedSite, event: SiteRedrawn) -> list[AlsoChanged]:
        """Return what a change is about beside layers."""
        found: list[AlsoChanged] = []
        if self._changes(event):
            found.append("vehicles")
        if any(self._marked(staged.site, event.by)):
            found.append("calibration")
        return found

    def _marked(self, staged: Site, by: str) -> Iterator[ImagerMarked]:
        """Yield the imaging drones whose camera is placed otherwise than in force."""
        for serial, imager in staged.imagers.items():
            known = self.site.imagers.get(serial)
            if known is not None and not _is_placed_alike(known, imager):
                rms_px = None if imager.solution is None else imager.solution.rms_px
                yield ImagerMarked(
                    serial, imager.marked_pose, imager.marked_frame, imager.outlook, rms_px, by
                )

    def _changes(self, event: SiteRedrawn) -> list[str]:
        return list(site_drawing.changed_vehicles(self.site.profiles, event.profiles))

    def _refuse_numbers(self, rows: Sequence[VehicleRow], given: Mapping[str, int]) -> None:
        """Raise `VehicleRowError` for a number of another row, or of a vehicle that has no row."""
        listed = {row.serial for row in rows}
        connected = self.driver.station.fleet.vehicles
        others = {given[s]: s for s in connected if s in given and s not in listed}
        owners: dict[int, str] = {}
        for index, row in enumerate(rows):
            if row.number is None:
                continue
            if row.number in owners:
                owner = owners[row.number]
                raise VehicleRowError(index, f"Number: {row.number} is the number of {owner} too")
            if row.number in others:
                raise VehicleRowError(
                    index,
                    f"Number: {row.number} belongs to {others[row.number]}, which has connected "
                    "and is not in the table; add it, or choose another number",
                )
            owners[row.number] = row.name or row.serial

    async def put_in_force(
        self, staged: StagedSite, event: SiteRedrawn, by: Person, *, is_check: bool
    ) -> Refusal | None:
        """Save a staged change and bring it into force, unless that is refused or only checked."""
        refusal, folder = self._refusal(event, by), self.folder
        if refusal is not None or is_check or not staged.files or folder is None:
            return refusal
        parts = (layers_text(event.layers), *self._also(staged, event))
        what = ", ".join(part for part in parts if part) or "site"
        return await self._commit(
            staged,
            event,
            write=lambda: _save(folder, staged.files, event, what),
            put_back=lambda: _undo_last(folder),
        )

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
            return _refusal(f"{folder} cannot be written: {problem}")
        # A drone may have taken off while the disk was busy.
        refusal = site_drawing.refusal(self.driver.station, event, self.driver.now_ns())
        if refusal is not None:
            try:
                await asyncio.to_thread(put_back)
            except (OSError, ReconError) as problem:
                return _refusal(
                    f"{refusal.reason}. It is not in force, but its files could not be taken back "
                    f"({problem}): restore the layers before the next start"
                )
            return refusal
        # Without an await between: the fence in force and the one shown are the same.
        drawn = staged.site
        marked = tuple(self._marked(drawn, event.by))
        if not marked or event.layers or self._changes(event):
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

    def event_of(self, staged: StagedSite, by: Person, *, is_undo: bool) -> SiteRedrawn:
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

    def _view(self) -> schema.SiteDrawingView:
        read = self._read(read_drawing)
        features = [_feature_view(each) for each in read.found]
        return schema.SiteDrawingView(
            revision=read.revision, features=features, locked_reason=read.locked, undo=read.undo
        )

    def _vehicles_view(self) -> schema.SiteVehiclesView:
        read = self._read(read_vehicle_rows)
        numbers = self.numbers()
        rows = [
            schema.SiteVehicleView(**{**asdict(row), "number": numbers.get(row.serial, row.number)})
            for row in read.found
        ]
        return schema.SiteVehiclesView(
            revision=read.revision, vehicles=rows, locked_reason=read.locked, undo=read.undo
        )

    def _read(self, read: Callable[[Path], tuple[T, ...]]) -> "_Read[T]":
        """Return what is read of the folder, and why nothing can be saved in it, if so."""
        folder, locked = self.folder, self.locked_reason
        if folder is None:
            return _Read("", (), locked, None)
        try:
            revision = drawing_digest(folder)
            if locked is None and revision != self._applied:
                locked = CHANGED_BY_HAND
            found = read(folder)
        except (ReconError, OSError):
            return _Read("", (), CHANGED_BY_HAND, None)
        change = None if locked else file_set.last_change(folder)
        undo = None
        if change is not None:
            undo = schema.SavedChangeView(what=change.what, by=change.by, utc=change.utc)
        return _Read(revision, found, locked, undo)


@dataclass(frozen=True, slots=True)
class _Read(Generic[T]):
    revision: str
    found: tuple[T, ...]
    locked: str | None
    undo: schema.SavedChangeView | None


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


def _feature(view: schema.DrawnFeatureView) -> DrawnFeature:
    geometry: dict[str, Any] = view.geometry.model_dump()
    return DrawnFeature(view.layer, geometry, view.properties)


def _feature_view(feature: DrawnFeature) -> schema.DrawnFeatureView:
    return schema.DrawnFeatureView(
        layer=feature.layer,
        geometry=schema.DrawnGeometry.model_validate(feature.geometry),
        properties=dict(feature.properties),
    )


def _refusal(reason: str) -> Refusal:
    return Refusal(site_drawing.RULE, reason)


def _refused(
    refusal: Refusal, layers: tuple[SiteLayer, ...] = (), feature: int | None = None
) -> schema.SiteDrawingResponse:
    return _answer(layers, refusal=refusal, feature=feature)


def _answer(
    layers: tuple[SiteLayer, ...],
    *,
    refusal: Refusal | None = None,
    feature: int | None = None,
    drawing: schema.SiteDrawingView | None = None,
    also: Sequence[AlsoChanged] = (),
) -> schema.SiteDrawingResponse:
    return schema.SiteDrawingResponse(
        accepted=refusal is None,
        rule=None if refusal is None else refusal.rule,
        reason=None if refusal is None else refusal.reason,
        feature=feature,
        layers=list(layers),
        also=list(also),
        drawing=drawing,
    )


def _vehicles_answer(
    *,
    refusal: Refusal | None = None,
    row: int | None = None,
    changes: Sequence[str] = (),
    view: schema.SiteVehiclesView | None = None,
) -> schema.SiteVehiclesResponse:
    return schema.SiteVehiclesResponse(
        accepted=refusal is None,
        rule=None if refusal is None else refusal.rule,
        reason=None if refusal is None else refusal.reason,
        row=row,
        changes=list(changes),
        vehicles=view,
    )
