"""XML of anyone as a tree: no document type, and bounded depth and number of elements.

Entities are a way to other files and to any size; a document type is the way to them.
"""

from typing import NoReturn
from xml.etree import ElementTree
from xml.parsers import expat

from recon.fields.shape import FieldFileError

MOST_ELEMENTS = 400_000
DEEPEST = 100


def xml_tree(data: bytes) -> ElementTree.Element:
    """Return the root element. Raises `FieldFileError`."""
    _check(data)
    try:
        return ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as problem:
        raise FieldFileError(f"expected valid XML, got {problem}") from problem


def _check(data: bytes) -> None:
    count = depth = 0

    def doctype(*_: object) -> NoReturn:
        raise FieldFileError("expected XML without a document type, got one; export the file again")

    def start(_name: str, _attributes: object) -> None:
        nonlocal count, depth
        count, depth = count + 1, depth + 1
        if count > MOST_ELEMENTS:
            raise FieldFileError(
                f"expected at most {MOST_ELEMENTS} XML elements, got more; export fewer fields"
            )
        if depth > DEEPEST:
            raise FieldFileError(f"expected XML at most {DEEPEST} elements deep, got a deeper one")

    def end(_name: str) -> None:
        nonlocal depth
        depth -= 1

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler, parser.StartElementHandler = doctype, start
    parser.EndElementHandler = end
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, ValueError, LookupError) as problem:
        raise FieldFileError(f"expected valid XML, got invalid XML: {problem}") from problem


def local(element: ElementTree.Element) -> str:
    """Return an element's name without its namespace; programs differ in that."""
    return str(element.tag).rpartition("}")[2]


def children(element: ElementTree.Element, name: str) -> list[ElementTree.Element]:
    """Return the direct children of a local name."""
    return [each for each in element if local(each) == name]


def child_text(element: ElementTree.Element, name: str) -> str:
    """Return the text of the first direct child of a local name; empty without one."""
    return next((each.text or "" for each in children(element, name)), "")
