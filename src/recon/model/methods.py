"""Methods by name: our own, and those that installed packages offer as entry points.

A package's method is imported when it is first asked for. One that cannot be imported, or has a
name that is taken, is left out with a sentence; all others are as they were.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Generic, TypeVar

from recon.model.errors import ReconError, describe_fault

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

MethodT = TypeVar("MethodT")

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,49}")
"""Names as scenario files, command lines and the console take them."""


class MethodError(ReconError):
    """A method of an installed package cannot be used: its name, its package, and why."""


class MethodRegistry(Mapping[str, MethodT], Generic[MethodT]):
    """The methods of one kind; iterating skips those that cannot be used."""

    def __init__(
        self, group: str, own: Mapping[str, MethodT], is_method: Callable[[object], bool]
    ) -> None:
        """Take the entry points' group, our own methods, and a check of what a package gives."""
        self.group = group
        self._own = MappingProxyType(dict(own))
        self._is_method = is_method
        self._loaded: dict[str, MethodT | MethodError] = {}

    @cached_property
    def _offered(self) -> tuple[Mapping[str, "EntryPoint"], tuple[str, ...]]:
        """The usable entry points by name, and why others are not: no package is imported."""
        from importlib.metadata import entry_points

        found: dict[str, EntryPoint] = {}
        refused: dict[str, str] = {}
        for point in entry_points(group=self.group):
            name = point.name
            if not NAME.fullmatch(name):
                refused[name] = f"{self._of(point)}: expected a name of letters and digits"
            elif name in self._own:
                refused[name] = f"{self._of(point)}: expected another name, Recon has one of this"
            elif name in found and found[name] != point:
                both = f"{self._of(found[name])} and {self._of(point)}"
                refused[name] = f"{both}: expected one of this name, neither is used"
            else:
                found[name] = point
        usable = {name: point for name, point in found.items() if name not in refused}
        return MappingProxyType(usable), tuple(refused.values())

    def _of(self, point: "EntryPoint") -> str:
        package = "an unknown package" if point.dist is None else point.dist.name
        return f"{self.group}: {point.name!a:.60} of {package}"

    @property
    def outside(self) -> Mapping[str, "EntryPoint"]:
        """The entry points of packages by name, imported or not."""
        return self._offered[0]

    @property
    def names(self) -> tuple[str, ...]:
        """All names, also of methods that turn out not to be importable: nothing is imported."""
        return *self._own, *self.outside

    @property
    def refusals(self) -> tuple[str, ...]:
        """Why names of packages are not taken, a sentence each: nothing is imported."""
        return self._offered[1]

    @property
    def problems(self) -> tuple[str, ...]:
        """Why methods of packages are left out, a sentence each; imports all of them."""
        found = (self._load(name) for name in self.outside)
        failed = (str(each) for each in found if isinstance(each, MethodError))
        return *self.refusals, *failed

    def __getitem__(self, name: str) -> MethodT:
        """Return a method; raises KeyError, or `MethodError` for one that cannot be used."""
        if name in self._own:
            return self._own[name]
        found = self._load(name)
        if isinstance(found, MethodError):
            raise found
        return found

    def _load(self, name: str) -> MethodT | MethodError:
        if name not in self._loaded:
            self._loaded[name] = self._imported(self.outside[name])
        return self._loaded[name]

    def _imported(self, point: "EntryPoint") -> MethodT | MethodError:
        try:
            method = point.load()
        except (Exception, SystemExit) as problem:  # whatever the package does wrong
            why = describe_fault(problem)
            return MethodError(f"{self._of(point)}: expected a module to import, got {why}")
        if not self._is_method(method):
            got = type(method).__name__
            return MethodError(f"{self._of(point)}: expected a method of its kind, got {got}")
        return method  # type: ignore[no-any-return]

    def __contains__(self, name: object) -> bool:
        return name in self._own or name in self.outside

    def __iter__(self) -> Iterator[str]:
        yield from self._own
        yield from (n for n in self.outside if not isinstance(self._load(n), MethodError))

    def __len__(self) -> int:
        return sum(1 for _name in self)
