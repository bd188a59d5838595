"""Names of photos in what is written about them."""

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path


def unique_names(paths: Sequence[Path]) -> dict[Path, str]:
    """Return a name for each file: its own, with its folder's before it where two have the same.

    No two differ in their suffix alone, for masks and sidecars have another one. Spaces become
    underscores: OpenDroneMap ignores masks with a space in their name.
    """
    plain = [re.sub(r"[^\w.-]", "_", path.name) for path in paths]
    counts = Counter(plain)
    names: dict[Path, str] = {}
    taken: set[str] = set()
    for path, name in zip(paths, plain, strict=True):
        if counts[name] > 1:
            name = re.sub(r"[^\w.-]", "_", f"{path.parent.name}_{name}")
        stem, number, unique = Path(name), 1, name
        while Path(unique).stem.lower() in taken:
            number += 1
            unique = f"{stem.stem}-{number}{stem.suffix}"
        taken.add(Path(unique).stem.lower())
        names[path] = unique
    return names
