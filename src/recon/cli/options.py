"""Options as values: a frozen dataclass states each option of a command once, with its help.

    @dataclass(frozen=True, slots=True, kw_only=True)
    class LoudOptions:
        level: Annotated[int, typer.Option(help="From 1 to 10.")] = 3

    @with_options
    def loud_command(options: LoudOptions) -> None: ...

The command has the option `--level`. One dataclass may extend another, and a command may take
several; parameters of other types stay as they are.
"""

import inspect
from collections.abc import Callable, Iterator, Sequence
from dataclasses import MISSING, fields, is_dataclass
from functools import wraps
from inspect import Parameter
from typing import Any, TypeVar, get_type_hints

Result = TypeVar("Result")


def with_options(
    command: Callable[..., Result], parameters: Sequence[Parameter] | None = None
) -> Callable[..., Result]:
    """Return a command whose parameters are the fields of the dataclasses that it takes.

    `parameters` are its own ones, where its signature does not state them.
    """
    own = parameters or list(inspect.signature(command).parameters.values())
    kinds: dict[str, Any] = {p.name: p.annotation for p in own if is_dataclass(p.annotation)}

    @wraps(command)
    def run(**values: Any) -> Result:
        for name, kind in kinds.items():
            named = [each.name for each in fields(kind) if each.name in values]
            values[name] = kind(**{each: values.pop(each) for each in named})
        return command(**values)

    shown = [
        each.replace(kind=Parameter.KEYWORD_ONLY)
        for parameter in own
        for each in (_of(kinds[parameter.name]) if parameter.name in kinds else (parameter,))
    ]
    run.__signature__ = inspect.Signature(shown)  # type: ignore[attr-defined]
    run.__annotations__ = {each.name: each.annotation for each in shown}
    return run


def _of(kind: type[Any]) -> Iterator[Parameter]:
    """Yield the fields of a dataclass as parameters."""
    hints = get_type_hints(kind, include_extras=True)
    for each in fields(kind):
        default = Parameter.empty if each.default is MISSING else each.default
        annotation = hints[each.name]
        yield Parameter(each.name, Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
