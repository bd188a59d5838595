"""A fast `replace` for frozen values that change with every packet.

It does what `dataclasses.replace` does, which reads and sets each field by name: 10 us for a value
of thirty fields. A value that keeps its fields in a dictionary (a dataclass without `slots`) is
copied as one instead, in 1 us; any other goes to `dataclasses.replace`.
"""

import dataclasses
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import replace as replace  # checked field by field, as the original is
else:

    def replace(value: Any, /, **changes: Any) -> Any:
        """Return a frozen value with some of its fields changed.

        Raises TypeError for an unknown field.
        """
        kind = type(value)
        names = _fields_copied(kind)
        if names is None:
            return dataclasses.replace(value, **changes)
        kept = value.__dict__ | changes  # half the time of {**a, **b}
        if len(kept) != len(names):
            unknown = ", ".join(sorted(changes.keys() - names))
            raise TypeError(f"{kind.__name__} has no field {unknown}")
        copied = object.__new__(kind)
        object.__setattr__(copied, "__dict__", kept)
        return copied


@cache
def _fields_copied(kind: type[Any]) -> frozenset[str] | None:
    """Return the names of a type's fields if its values may be copied as dictionaries, else None.

    Copying is wrong for types with `__post_init__`, `init=False` fields or cached properties.
    """
    if not dataclasses.is_dataclass(kind) or hasattr(kind, "__slots__"):
        return None
    fields = dataclasses.fields(kind)
    does_more = hasattr(kind, "__post_init__") or not all(field.init for field in fields)
    keeps_more = any(isinstance(part, cached_property) for part in vars(kind).values())
    if does_more or keeps_more:
        return None
    return frozenset(field.name for field in fields)
