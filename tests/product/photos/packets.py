"""XMP packets as cameras and software write them."""

from collections.abc import Mapping

DJI = "http://www.dji.com/drone-dji/1.0/"
SPACES = {
    "drone-dji": DJI,
    "Camera": "http://pix4d.com/camera/1.0",
    "DLS": "http://micasense.com/DLS/1.0/",
    "MicaSense": "http://micasense.com/MicaSense/1.0/",
    "exif": "http://ns.adobe.com/exif/1.0/",
}


def packet(values: Mapping[str, str], quote: str = '"') -> bytes:
    """A packet with `prefix:name` values as attributes."""
    lines = " ".join(f"{name}={quote}{value}{quote}" for name, value in values.items())
    return wrapped(f"<rdf:Description {declared(quote)} {lines}/>")


def declared(quote: str = '"') -> str:
    return " ".join(f"xmlns:{name}={quote}{space}{quote}" for name, space in SPACES.items())


def wrapped(descriptions: str) -> bytes:
    """A packet around its descriptions."""
    return (
        '<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>'
        '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF '
        f'xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">{descriptions}'
        '</rdf:RDF></x:xmpmeta>\n   \n<?xpacket end="w"?>'
    ).encode()
