"""The site's failsafe matrix, as the API sends it."""

from recon.api import schema
from recon.model.failsafe_matrix import Activity, FailsafeCell, FailsafeMatrix
from recon.safety.failsafe import DEFAULT_MATRIX, ROWS, FailsafeRow, cell_words


def failsafe_view(matrix: FailsafeMatrix) -> list[schema.FailsafeRowView]:
    """Return every row, with the cells that differ from the default marked."""
    return [
        schema.FailsafeRowView(
            condition=condition.value,
            name=condition.words,
            begins=row.begins,
            cells=[_cell(row, activity, cell) for activity, cell in matrix.rows[condition].items()],
        )
        for condition, row in ROWS.items()
    ]


def _cell(row: FailsafeRow, activity: Activity, cell: FailsafeCell) -> schema.FailsafeCellView:
    default = DEFAULT_MATRIX.cell(row.condition, activity)
    return schema.FailsafeCellView(
        activity=activity.value,
        reaction=cell.reaction.value,
        after_s=cell.after_s,
        text=cell_words(row, cell),
        default=None if cell == default else cell_words(row, default),
        is_weaker=cell.is_weaker_than(default),
    )
