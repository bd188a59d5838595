"""Frozen values as msgpack and back, by their type hints: no pickle, because files are hostile.

A dataclass is a map of its fields by name; where a union allows several types, the key `TAG` names
the one. Arrays are raw bytes with dtype and shape. A type decodes to itself only: the set of
classes that a file can make is closed, and each field is checked against its hint. A field that the
file lacks takes its default, and one that its class does not have is noted and skipped. What is no
plain dataclass gets a `Custom` codec.
"""

import dataclasses
import types
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import MISSING, dataclass
from enum import Enum
from pathlib import Path
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

import msgspec
import numpy as np

from recon.model.errors import RecordError

TAG = "_"
"""The key that names a type where a union allows several."""

ARRAY_KINDS = "biufc"
MOST_DIMENSIONS = 4
MOST_SKIPPED = 64
_SCALARS: tuple[type[Any], ...] = (bool, int, float, str, bytes)


class CodecError(RecordError):
    """Bytes that are not the value they should be: where, what was expected, what came."""


Encode = Callable[[Any], Any]
Decode = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Custom:
    """How a type without hints is recorded: to built-in values, and back (None: it is not read)."""

    encode: Encode
    decode: Decode | None = None


@dataclass(frozen=True, slots=True)
class _Both:
    encode: Encode
    decode: Decode


@dataclass(frozen=True, slots=True)
class _Field:
    name: str
    is_required: bool
    codec: _Both | None
    """None: the value is written as it is, and checked against `plain` when read."""
    plain: type[Any] | None


class Codec:
    """Encodes and decodes values of the types it is asked for; each type is compiled once."""

    def __init__(self, customs: Mapping[type[Any], Custom] | None = None) -> None:
        self._customs = dict(customs or {})
        self._made: dict[Any, _Both] = {}
        self.skipped: set[str] = set()
        """Fields that were not read, for another version wrote them: some, as `Class.field`."""

    def encode(self, value: Any, hint: Any) -> bytes:
        """Return a value as msgpack; raises TypeError for a type without a codec."""
        return msgspec.msgpack.encode(self.to_builtins(value, hint))

    def to_builtins(self, value: Any, hint: Any) -> Any:
        """Return a value as maps, lists, numbers, text and bytes."""
        return self._both(hint).encode(value)

    def decode(self, data: bytes, hint: Any) -> Any:
        """Return the value of some bytes; raises `CodecError` for anything that is not one."""
        try:
            builtins = msgspec.msgpack.decode(data)
        except (msgspec.MsgspecError, ValueError, RecursionError) as problem:
            raise CodecError(f"expected msgpack, got: {problem}") from problem
        return self.from_builtins(builtins, hint)

    def from_builtins(self, builtins: Any, hint: Any) -> Any:
        """Return the value of maps and lists; raises `CodecError`."""
        try:
            return self._both(hint).decode(builtins)
        except CodecError:
            raise
        except (TypeError, ValueError, OverflowError, RecursionError) as problem:
            raise CodecError(f"expected a {_name(hint)}, got: {problem}") from problem

    def _both(self, hint: Any) -> _Both:
        made = self._made.get(hint)
        if made is None:
            made = self._made[hint] = self._make(hint)
        return made

    def _make(self, hint: Any) -> _Both:
        hint = _unaliased(hint)
        origin = get_origin(hint)
        custom = self._customs.get(hint) or self._customs.get(origin)
        if custom is not None:
            return _Both(custom.encode, custom.decode or _never_read)
        if hint in _SCALARS:
            return _scalar(hint)
        if hint is None or hint is type(None):
            return _Both(lambda value: None, lambda value: _expect(value, type(None)))
        if hint is Path:
            return _Both(str, lambda value: Path(_expect(value, str)))
        if origin in (Union, types.UnionType):
            return self._union(get_args(hint))
        if origin is np.ndarray or hint is np.ndarray:
            return _array(hint)
        if isinstance(origin or hint, type):
            return self._collection_or_class(hint, origin or hint)
        raise TypeError(f"no codec for {hint!r}: give it a Custom one")

    def _collection_or_class(self, hint: Any, kind: type[Any]) -> _Both:
        args = get_args(hint)
        if issubclass(kind, Enum):
            return _enum(kind)
        if dataclasses.is_dataclass(kind):
            return self._dataclass(kind, args)
        if issubclass(kind, tuple):
            if hasattr(kind, "_fields"):
                hints = get_type_hints(kind)
                return self._fixed([hints[name] for name in kind._fields], lambda v: kind(*v))
            if len(args) == 2 and args[1] is Ellipsis:
                return self._many(args[0], tuple)
            return self._fixed(args, tuple)
        if issubclass(kind, Mapping):
            return self._mapping(args)
        if issubclass(kind, Set):
            many = self._many(args[0], frozenset)
            return _Both(lambda value: sorted(many.encode(value), key=repr), many.decode)
        if issubclass(kind, Sequence | Iterable):
            return self._many(args[0], list if issubclass(kind, list) else tuple)
        raise TypeError(f"no codec for {hint!r}: give it a Custom one")

    def _many(self, hint: Any, kind: Callable[[Iterable[Any]], Any]) -> _Both:
        if hint in _SCALARS:
            each = _scalar(hint)
            return _Both(list, lambda value: kind(each.decode(v) for v in _expect(value, list)))
        both = self._both

        def encode(value: Iterable[Any]) -> list[Any]:
            each = both(hint).encode
            return [each(item) for item in value]

        def decode(value: Any) -> Any:
            each = both(hint).decode
            return kind([each(item) for item in _expect(value, list)])

        return _Both(encode, decode)

    def _fixed(self, hints: Iterable[Any], make: Callable[[list[Any]], Any]) -> _Both:
        each = [self._both(hint) for hint in hints]

        def decode(value: Any) -> Any:
            if len(_expect(value, list)) != len(each):
                raise CodecError(f"expected {len(each)} values, got {len(value)}")
            return make([both.decode(v) for both, v in zip(each, value, strict=True)])

        return _Both(lambda v: [b.encode(part) for b, part in zip(each, v, strict=True)], decode)

    def _mapping(self, args: tuple[Any, ...]) -> _Both:
        """A list of pairs: keys need not be text, and their order counts."""
        pair = self._fixed(args, tuple)
        return _Both(
            lambda value: [pair.encode(item) for item in value.items()],
            lambda value: dict(pair.decode(item) for item in _expect(value, list)),
        )

    def _dataclass(self, kind: type[Any], args: tuple[Any, ...]) -> _Both:
        # Compiled at the first use, not here: a type may hold values of its own type.
        fields: list[_Field] = []

        def compiled() -> list[_Field]:
            if not fields:
                fields.extend(self._fields(kind, args))
            return fields

        def encode(value: Any) -> dict[str, Any]:
            encoded = {}
            for each in fields or compiled():
                part = getattr(value, each.name)
                encoded[each.name] = part if each.codec is None else each.codec.encode(part)
            return encoded

        def decode(value: Any) -> Any:
            given = {}
            for each in fields or compiled():
                if each.name in _expect(value, dict):
                    given[each.name] = _decoded(kind, each, value[each.name])
                elif each.is_required:
                    raise CodecError(f"{kind.__name__}.{each.name} is missing")
            if len(value) > len(given):
                self.note_skipped(kind, value.keys() - given.keys())
            try:
                return kind(**given)
            except (TypeError, ValueError) as problem:
                raise CodecError(f"expected a {kind.__name__}, got: {problem}") from problem

        return _Both(encode, decode)

    def note_skipped(self, kind: type[Any], names: Iterable[Any]) -> None:
        """Note fields that a type does not have."""
        for name in names:
            if len(self.skipped) < MOST_SKIPPED:
                self.skipped.add(f"{kind.__name__}.{str(name)[:40]}")

    def _fields(self, kind: type[Any], args: tuple[Any, ...]) -> Iterable[_Field]:
        hints = get_type_hints(kind)
        variables = dict(zip(getattr(kind, "__parameters__", ()), args, strict=False))
        for each in dataclasses.fields(kind):
            if each.init:
                hint = _substituted(hints[each.name], variables)
                # Numbers of numpy may be in a field of numbers: only these stay as they are.
                plain = hint if hint in (str, bytes) else None
                is_required = each.default is MISSING and each.default_factory is MISSING
                codec = None if plain is not None else self._both(hint)
                yield _Field(each.name, is_required, codec, plain)

    def _union(self, hints: tuple[Any, ...]) -> _Both:
        others = [_unaliased(hint) for hint in hints if hint is not type(None)]
        if len(others) == 1:
            return self._optional(others[0])
        return self._tagged(others, is_optional=len(others) < len(hints))

    def _optional(self, hint: Any) -> _Both:
        both = self._both(hint)
        write, read = both.encode, both.decode
        return _Both(
            lambda value: None if value is None else write(value),
            lambda value: None if value is None else read(value),
        )

    def _tagged(self, hints: list[Any], is_optional: bool) -> _Both:
        plain = tuple(hint for hint in hints if hint in _SCALARS)
        kinds = {get_origin(hint) or hint: hint for hint in hints if hint not in _SCALARS}
        by_name = {kind.__name__: hint for kind, hint in kinds.items()}

        def encode(value: Any) -> Any:
            if value is None or (plain and isinstance(value, plain)):
                return value if value is None else _plain(value)
            kind = next((k for k in type(value).__mro__ if k in kinds), None)
            if kind is None:
                raise TypeError(f"expected one of {', '.join(by_name)}, got {type(value).__name__}")
            encoded = self._both(kinds[kind]).encode(value)
            tag = {TAG: kind.__name__}
            return tag | encoded if isinstance(encoded, dict) else tag | {"value": encoded}

        def decode(value: Any) -> Any:
            if (value is None and is_optional) or (plain and type(value) in plain):
                return value
            name = _expect(value, dict).get(TAG)
            if not isinstance(name, str) or name not in by_name:
                raise CodecError(f"expected one of {', '.join(by_name)}, got {name!a:.80}")
            hint = by_name[name]
            rest = {key: part for key, part in value.items() if key != TAG}
            is_wrapped = rest.keys() == {"value"} and not dataclasses.is_dataclass(
                get_origin(hint) or hint
            )
            return self._both(hint).decode(rest["value"] if is_wrapped else rest)

        return _Both(encode, decode)


def _decoded(kind: type[Any], field: _Field, value: Any) -> Any:
    try:
        if field.codec is None:
            assert field.plain is not None
            return _expect(value, field.plain)
        return field.codec.decode(value)
    except CodecError as problem:
        raise CodecError(f"{kind.__name__}.{field.name}: {problem}") from problem


def _expect(value: Any, kind: type[Any]) -> Any:
    if type(value) is not kind:
        raise CodecError(f"expected {kind.__name__}, got {type(value).__name__}")
    return value


def _plain(value: Any) -> Any:
    """Return a number, text or bytes as Python's own type, also where numpy's came."""
    for kind in _SCALARS:
        if isinstance(value, kind):
            return value if type(value) is kind else kind(value)
    return value


def _scalar(kind: type[Any]) -> _Both:
    if kind is float:
        # A whole number in a field of numbers stays one: 5 and 5.0 are not the same bits.
        return _Both(_number, _decoded_number)
    if kind is int:
        return _Both(lambda value: value if type(value) is int else int(value), _int)
    if kind is bool:
        return _Both(bool, lambda value: _expect(value, bool))
    return _Both(lambda value: value, lambda value: _expect(value, kind))


def _int(value: Any) -> int:
    return int(_expect(value, int))


def _number(value: Any) -> Any:
    return value if type(value) in (float, int) else float(value)


def _decoded_number(value: Any) -> Any:
    if type(value) not in (float, int):
        raise CodecError(f"expected a number, got {type(value).__name__}")
    return value


def _enum(kind: type[Enum]) -> _Both:
    def decode(value: Any) -> Enum:
        try:
            return kind(value)
        except ValueError as problem:
            raise CodecError(f"expected a {kind.__name__}, got {value!a:.80}") from problem

    return _Both(lambda value: kind(value).value, decode)


def _array(hint: Any) -> _Both:
    args = get_args(hint)
    wanted = get_args(args[1])[0] if len(args) == 2 and get_args(args[1]) else None

    def decode(value: Any) -> Any:
        given = _expect(value, dict)
        dtype, shape, data = (given.get(name) for name in ("dtype", "shape", "data"))
        is_by_column = given.get("order") == "F"
        sizes = _expect(shape, list)[:: -1 if is_by_column else 1]
        array = decode_array(_expect(dtype, str), sizes, _expect(data, bytes), wanted)
        return array.T if is_by_column else array

    return _Both(encode_array, decode)


def encode_array(array: Any) -> dict[str, Any]:
    """Return an array as dtype, shape and raw bytes; one in column order stays so.

    Sums and products run in the order of memory: another order gives other last bits.
    """
    if array.dtype.kind not in ARRAY_KINDS:
        raise TypeError(f"expected an array of numbers, got {array.dtype}")
    is_by_column = array.flags.f_contiguous and not array.flags.c_contiguous
    encoded = {
        "dtype": array.dtype.newbyteorder("<").str,
        "shape": list(array.shape),
        "data": (array.T if is_by_column else array)
        .astype(array.dtype.newbyteorder("<"), copy=False)
        .tobytes(),
    }
    return encoded | {"order": "F"} if is_by_column else encoded


def decode_array(dtype: str, shape: list[Any], data: bytes, wanted: Any) -> Any:
    """Return an array; raises `CodecError` unless dtype, shape and bytes fit each other."""
    try:
        kind = np.dtype(dtype)
    except TypeError as problem:
        raise CodecError(f"expected a dtype, got {dtype!a:.40}") from problem
    if kind.kind not in ARRAY_KINDS or kind.itemsize > 8:
        raise CodecError(f"expected an array of numbers, got dtype {dtype!a:.40}")
    if isinstance(wanted, type) and not np.issubdtype(kind, wanted):
        raise CodecError(f"expected an array of {wanted.__name__}, got {dtype!a:.40}")
    if len(shape) > MOST_DIMENSIONS or not all(type(n) is int and 0 <= n < 2**31 for n in shape):
        raise CodecError(f"expected a shape of up to {MOST_DIMENSIONS} sizes, got {shape!a:.80}")
    count = 1
    for size in shape:
        count *= size
    if count * kind.itemsize != len(data):
        raise CodecError(f"expected {count} values of {dtype}, got {len(data)} bytes")
    return np.frombuffer(data, kind).astype(kind.newbyteorder("="), copy=True).reshape(shape)


def _unaliased(hint: Any) -> Any:
    """Return the type that an alias names: `NDArray` is an alias since NumPy 2.5."""
    alias = get_origin(hint) or hint
    if isinstance(alias, type) or not hasattr(alias, "__value__"):
        return hint
    args = get_args(hint)
    return alias.__value__[args] if args else alias.__value__


def _substituted(hint: Any, variables: Mapping[Any, Any]) -> Any:
    """Return a hint with the type variables of its generic class replaced."""
    if isinstance(hint, TypeVar):
        return variables.get(hint, hint)
    parameters = getattr(hint, "__parameters__", ())
    if not variables or not parameters or isinstance(hint, type):
        return hint
    return hint[tuple(variables.get(each, each) for each in parameters)]


def _name(hint: Any) -> str:
    return str(getattr(hint, "__name__", hint))[:80]


def _never_read(_value: Any) -> Any:
    raise CodecError("this value is written for comparison only and never read back")
