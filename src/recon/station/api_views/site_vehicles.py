"""The site's vehicles as a person edits them in a table."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from recon.api import schema
from recon.model.person import Person
from recon.site.drawing import StagedSite
from recon.site.vehicle_rows import (
    VehicleRow,
    VehicleRowError,
    read_vehicle_rows,
    stage_vehicles,
)
from recon.station.api_views import outcome_of
from recon.station.api_views.edited_site import EditedSite, SiteChange, site_refusal


@dataclass(slots=True)
class SiteVehiclesService:
    """The table of a site's vehicles, with the number that is in force for each."""

    edited: EditedSite
    numbers: Callable[[], Mapping[str, int]] = dict
    """Returns the vehicles' numbers by serial."""

    async def vehicles(self) -> schema.SiteVehiclesView:
        """Return the vehicles in the folder."""
        async with self.edited.turn:
            return await self._view()

    async def save(
        self, asked: schema.SiteVehiclesRequest, by: Person, *, is_check: bool
    ) -> schema.SiteVehiclesResponse:
        """Check the vehicles; then save them and bring them into force, unless only checked."""
        rows = [VehicleRow(**row.model_dump()) for row in asked.vehicles]
        given = self.numbers()

        def stage(folder: Path) -> StagedSite:
            self._refuse_numbers(rows, given)
            return stage_vehicles(folder, _without_given(rows, given, folder))

        async with self.edited.turn:
            try:
                change = await self.edited.change(asked.revision, stage, by, is_check=is_check)
            except VehicleRowError as problem:
                change = SiteChange(refusal=site_refusal(str(problem)))
                return _answer(change, row=problem.index)
            is_saved = change.refusal is None and not is_check
            return _answer(change, view=await self._view() if is_saved else None)

    async def _view(self) -> schema.SiteVehiclesView:
        read, numbers = await self.edited.read(read_vehicle_rows), self.numbers()
        rows = [replace(row, number=numbers.get(row.serial, row.number)) for row in read.found]
        return schema.SiteVehiclesView(
            revision=read.revision,
            vehicles=[schema.SiteVehicleView(**asdict(row)) for row in rows],
            locked_reason=read.locked_reason,
            undo=read.undo,
        )

    def _refuse_numbers(self, rows: Sequence[VehicleRow], given: Mapping[str, int]) -> None:
        """Raise `VehicleRowError` for a number of another row, or of a vehicle that has no row."""
        listed = {row.serial for row in rows}
        connected = self.edited.driver.station.fleet.vehicles
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


def _without_given(
    rows: Sequence[VehicleRow], given: Mapping[str, int], folder: Path
) -> list[VehicleRow]:
    """Return the rows without numbers that the station gave: a save does not fix them."""
    known = {row.serial: row.number for row in read_vehicle_rows(folder)}
    return [
        replace(row, number=known.get(row.serial)) if row.number == given.get(row.serial) else row
        for row in rows
    ]


def _answer(
    change: SiteChange, *, row: int | None = None, view: schema.SiteVehiclesView | None = None
) -> schema.SiteVehiclesResponse:
    return schema.SiteVehiclesResponse(
        **outcome_of(change.refusal),
        row=row,
        changes=[] if change.refusal is not None else list(change.vehicles),
        vehicles=view,
    )
