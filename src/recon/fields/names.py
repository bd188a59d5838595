"""Names of shapes: found among a table's columns, cleaned, and each once."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

LONGEST = 64
"""As a site's names; a longer one is cut."""
COLUMNS = (
    *("name", "field_name", "fieldname", "field", "name_1", "field_nam", "fld_name", "parcel"),
    *("parcelname", "paddock", "block", "label", "title", "bezeichnung", "schlagname", "schlag"),
    *("nom", "nombre", "nome", "naam", "field_id", "fieldid", "id_field"),
)
"""What programs call the column of a field's name, the likeliest first, in lower case."""


def name_column(columns: Sequence[str], is_text: Sequence[bool]) -> int | None:
    """Return which of a table's columns has the names: by its title, or as the only one of text."""
    titles = [column.lower().replace(" ", "_") for column in columns]
    known = [titles.index(title) for title in COLUMNS if title in titles]
    texts = [number for number, is_one in enumerate(is_text) if is_one]
    return known[0] if known else texts[0] if len(texts) == 1 else None


def name_among(attributes: Mapping[str, object]) -> str:
    """Return the name among a shape's attributes; empty where none is one."""
    chosen = name_column(list(attributes), [isinstance(v, str) for v in attributes.values()])
    value = None if chosen is None else list(attributes.values())[chosen]
    return "" if value is None or isinstance(value, dict | list | bool) else str(value)


def cleaned(name: str) -> str:
    """Return a name on one line, without control characters, at most `LONGEST` long."""
    words = "".join(each if each.isprintable() else " " for each in name[:1000]).split()
    text = " ".join(words)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1].rstrip()}…"


def each_once(names: Sequence[str]) -> Iterator[str]:
    """Yield names numbered where several shapes have the same; empty ones stay."""
    counts, taken = Counter(names), set(names)
    numbers: Counter[str] = Counter()
    for name in names:
        if not name or counts[name] == 1:
            yield name
            continue
        numbers[name] += 1
        if numbers[name] == 1:
            yield name
            continue
        numbered = _numbered(name, numbers[name])
        while numbered in taken:
            numbers[name] += 1
            numbered = _numbered(name, numbers[name])
        taken.add(numbered)
        yield numbered


def _numbered(name: str, number: int) -> str:
    ending = f" {number}"
    return name[: LONGEST - len(ending)] + ending
