"""A photo's XMP packet: simple values by namespace and name.

Attributes and elements state the same; prefixes are a writer's choice, so only namespaces count.
The packet is hostile: its size, depth and values are bounded, and a packet with a document type,
which entities need, is refused. Parts outside the packet (extended XMP) are not read.
"""

import math
from dataclasses import dataclass, field
from xml.parsers import expat

from recon.model.errors import ReconError

MOST_XMP_BYTES = 1024 * 1024
MOST_DEPTH = 32
MOST_VALUES = 2_000
MOST_VALUE_CHARACTERS = 4_096
"""DJI keeps binary data in values; what is longer is no statement that anything here reads."""

DJI = "http://www.dji.com/drone-dji/1.0"
RDF = "http://www.w3.org/1999/02/22-rdf-syntax-ns"
XMP_TOOLS = "adobe:ns:meta"
BETWEEN = "\n"
"""Stands between namespace, name and prefix: no character of any."""
USUAL = f"{BETWEEN}drone-dji"
"""End of a name with the prefix that DJI writes."""


Name = tuple[str, str]
"""Namespace and name."""


class XmpError(ReconError):
    """A packet that is no XMP, or more of it than a photo has; the text gives the reason."""


@dataclass(frozen=True, slots=True)
class Xmp:
    """Values in their order, by namespace, without slash or hash at its end, and name."""

    values: dict[Name, tuple[str, ...]] = field(default_factory=dict)
    plain: frozenset[Name] = frozenset()
    """Those of DJI's that stand as most programs look for them: attributes with the usual prefix,
    of the packet's only description, in eight-bit text."""

    def text(self, space: str, *names: str) -> str | None:
        """Return the first value that one of some names has; None without one."""
        found = (self.values.get((space, name), ()) for name in names)
        return next((values[0] for values in found if values), None)

    def number(self, space: str, *names: str) -> float | None:
        """Return the same as a finite number, or a fraction as EXIF writes it; None without one."""
        text = self.text(space, *names)
        return None if text is None else as_number(text)

    def numbers(self, space: str, name: str) -> tuple[float, ...]:
        """Return the numbers of a list, or of one text that separates them by commas."""
        texts = [part for each in self.values.get((space, name), ()) for part in each.split(",")]
        found = [as_number(text) for text in texts]
        return tuple(each for each in found if each is not None)


def as_number(text: str) -> float | None:
    """Return a text's finite number, `a` or `a/b`; None where it is none."""
    above, _slash, below = text.partition("/")
    try:
        number = float(above) / float(below) if below else float(above)
    except (ValueError, ZeroDivisionError):
        return None
    return number if math.isfinite(number) else None


def read_xmp(packet: bytes) -> Xmp:
    """Return a packet's values; raises `XmpError`."""
    if len(packet) > MOST_XMP_BYTES:
        raise XmpError(f"{len(packet)} bytes, limit {MOST_XMP_BYTES}")
    reader = _XmpReader()
    parser = expat.ParserCreate(namespace_separator=BETWEEN)
    parser.buffer_text = parser.namespace_prefixes = True
    parser.StartElementHandler = reader.begin
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.text
    parser.StartDoctypeDeclHandler = _refuse_document_type
    try:
        # Software pads packets, some of it with zeros.
        parser.Parse(packet.rstrip(b"\x00 \t\r\n") if _is_eight_bit(packet) else packet, True)
    except expat.ExpatError as problem:
        raise XmpError(f"no well-formed XML ({expat.ErrorString(problem.code)})") from problem
    except (ValueError, LookupError) as problem:
        raise XmpError(f"text in an unknown encoding ({problem!s:.80})") from problem
    is_plain = _is_eight_bit(packet) and reader.descriptions == 1
    plain = frozenset(reader.usual if is_plain else ())
    return Xmp({name: tuple(values) for name, values in reader.values.items()}, plain)


def _is_eight_bit(packet: bytes) -> bool:
    return b"\x00" not in packet[:4] and not packet.startswith((b"\xff\xfe", b"\xfe\xff"))


def _refuse_document_type(*_about: object) -> None:
    raise XmpError("a document type, which XMP never has")


class _XmpReader:
    """Collects attributes, and texts of elements: those of list items under their list's name."""

    def __init__(self) -> None:
        self.values: dict[Name, list[str]] = {}
        self.usual: set[Name] = set()
        self.descriptions = 0
        self._open: list[Name] = []
        self._text: list[str] = []
        self._count = 0

    def begin(self, name: str, attributes: dict[str, str]) -> None:
        self._open.append(_split(name))
        if len(self._open) > MOST_DEPTH:
            raise XmpError(f"more than {MOST_DEPTH} elements inside one another")
        self._text.clear()
        self.descriptions += self._open[-1] == (RDF, "Description")
        for each, value in attributes.items():
            self._keep(_split(each), value)
            if each.endswith(USUAL):
                self.usual.add(_split(each))

    def text(self, text: str) -> None:
        self._text.append(text)

    def end(self, _name: str) -> None:
        text = "".join(self._text).strip()
        self._text.clear()
        if text:
            outer = [each for each in self._open if each[0] not in (RDF, XMP_TOOLS)]
            if outer:
                self._keep(outer[-1], text)
        self._open.pop()

    def _keep(self, name: Name, value: str) -> None:
        if name[0] == RDF or len(value) > MOST_VALUE_CHARACTERS:
            return
        self._count += 1
        if self._count > MOST_VALUES:
            raise XmpError(f"more than {MOST_VALUES} values")
        self.values.setdefault(name, []).append(value.strip())


def _split(name: str) -> Name:
    if BETWEEN not in name:
        return "", name
    space, local, *_prefix = name.split(BETWEEN)
    return space.rstrip("/#"), local
