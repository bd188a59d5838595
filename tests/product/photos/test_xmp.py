"""XMP in the forms that cameras and software write, and hostile packets."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.product.photos.packets import DJI as SPACE
from tests.product.photos.packets import packet, wrapped

from recon.product.photos.xmp import DJI, MOST_XMP_BYTES, XmpError, read_xmp

YAW = "drone-dji:GimbalYawDegree"
AS_ATTRIBUTE = packet({YAW: "+123.40"})
FORMS = {
    "attributes": AS_ATTRIBUTE,
    "single quotes": packet({YAW: "+123.40"}, "'"),
    "elements": wrapped(
        f"<rdf:Description xmlns:drone-dji='{SPACE}'><{YAW}> +123.40\n</{YAW}></rdf:Description>"
    ),
    "a second description": wrapped(
        "<rdf:Description xmlns:tiff='http://ns.adobe.com/tiff/1.0/' tiff:Make='DJI'/>"
        f"<rdf:Description xmlns:drone-dji='{SPACE}' {YAW}='+123.40'/>"
    ),
    "another prefix": wrapped(
        f"<rdf:Description xmlns:ns1='{SPACE}' ns1:GimbalYawDegree='+123.40'/>"
    ),
    "a default namespace": wrapped(
        f"<rdf:Description><GimbalYawDegree xmlns='{SPACE}'>+123.40</GimbalYawDegree>"
        "</rdf:Description>"
    ),
    "no wrapper": b"".join(AS_ATTRIBUTE.partition(b"<rdf:RDF")[1:]).split(b"</x:")[0],
    "padded with zeros": AS_ATTRIBUTE + b"\0" * 99,
    "UTF-16, little end first": AS_ATTRIBUTE.decode().encode("utf-16-le"),
    "UTF-16, big end first": AS_ATTRIBUTE.decode().encode("utf-16-be"),
    "UTF-16 with its mark": AS_ATTRIBUTE.decode().encode("utf-16"),
    "a declaration": b'<?xml version="1.0" encoding="UTF-8"?>' + AS_ATTRIBUTE,
}


@pytest.mark.parametrize("form", FORMS)
def test_a_number_is_read_in_each_form(form: str) -> None:
    assert read_xmp(FORMS[form]).number(DJI, "GimbalYawDegree") == 123.4


def test_another_namespace_of_the_same_prefix_is_not_djis() -> None:
    found = read_xmp(AS_ATTRIBUTE.replace(SPACE.encode(), b"http://example.org/"))
    assert found.number(DJI, "GimbalYawDegree") is None


def test_lists_and_fractions_are_read() -> None:
    listed = "<rdf:Seq><rdf:li>475</rdf:li><rdf:li>1/4</rdf:li></rdf:Seq>"
    found = read_xmp(
        wrapped(f"<rdf:Description xmlns:a='{SPACE}'><a:W>{listed}</a:W><a:N/></rdf:Description>")
    )
    assert found.numbers(DJI, "W") == (475.0, 0.25)
    assert found.text(DJI, "N", "W") == "475"


@pytest.mark.parametrize("text", ["nan", "inf", "1/0", "", "12,5", "1e999"])
def test_what_is_no_number_is_not_taken_for_one(text: str) -> None:
    assert read_xmp(packet({YAW: text})).number(DJI, "GimbalYawDegree") is None


DEEP = "<a>" * 5_000 + "</a>" * 5_000
LAUGHS = (
    '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;">]><x>&b;</x>'
)
HOSTILE = {
    "document type": (LAUGHS.encode(), "a document type"),
    "outer file": (b'<!DOCTYPE x SYSTEM "file:///etc/passwd"><x/>', "a document type"),
    "deep": (DEEP.encode(), "inside one another"),
    "many values": (wrapped("<a b='1'/>" * 3_000), "more than 2000 values"),
    "large": (b" " * (MOST_XMP_BYTES + 1), "bytes, limit"),
    "cut": (AS_ATTRIBUTE[:-40], "well-formed"),
    "no XML": (b"drone-dji:GimbalYawDegree=5", "well-formed"),
    "unknown encoding": (b"<?xml version='1.0' encoding='none-such'?><x/>", "encoding"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_packet_is_refused_with_the_reason(name: str) -> None:
    data, sentence = HOSTILE[name]
    with pytest.raises(XmpError, match=sentence):
        read_xmp(data)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_damage_gives_values_or_the_reason(data: st.DataObject) -> None:
    damaged = bytearray(data.draw(st.sampled_from(sorted(FORMS.values()))))
    for at in data.draw(st.lists(st.integers(0, len(damaged) - 1), max_size=8)):
        damaged[at] = data.draw(st.integers(0, 255))
    try:
        found = read_xmp(bytes(damaged[: data.draw(st.integers(0, len(damaged)))]))
    except XmpError:
        return
    number = found.number(DJI, "GimbalYawDegree")
    assert number is None or abs(number) < 1e6
