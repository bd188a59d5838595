"""The site's failsafe matrix in the terminal: what the station does when something fails."""

from collections.abc import Sequence

from recon.cli.output import print_line, print_table
from recon.client.messages import FailsafeCellStatus, FailsafeRowStatus

COLUMNS = ("when", "in a mission", "steered", "holding", "on the route home")


def print_failsafe_matrix(rows: Sequence[FailsafeRowStatus]) -> None:
    """Print one line per condition, then how many cells differ from the default."""
    table = [(row.name, *(_text(cell) for cell in row.cells)) for row in rows]
    print_table("failsafe matrix of the site", COLUMNS, table)
    cells = [cell for row in rows for cell in row.cells]
    changed = sum(cell.default is not None for cell in cells)
    weaker = sum(cell.is_weaker for cell in cells)
    if changed:
        print_line(f"failsafe matrix: {changed} of {len(cells)} cells changed, {weaker} do less")
    else:
        print_line("failsafe matrix: default")


def _text(cell: FailsafeCellStatus) -> str:
    if cell.default is None:
        return cell.text
    return f"{cell.text} ({'WEAKER, ' if cell.is_weaker else ''}default: {cell.default})"
