"""The list of apps: what it may say, and that what is written is read back."""

import re
import string
from ipaddress import ip_network
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples

from recon.fleet.admission import MAX_ENTRIES, AllowedApp
from recon.site import SiteError
from recon.site.app_list import app_list_text, read_app_list


def written(folder: Path, text: str | bytes) -> Path:
    path = folder / "apps.toml"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def refusal(folder: Path, text: str | bytes) -> str:
    with pytest.raises(SiteError) as caught:
        read_app_list(written(folder, text))
    message = str(caught.value)
    assert message.isprintable()
    return message


def test_serials_addresses_and_networks(tmp_path: Path) -> None:
    text = (
        '[[apps]]\nserial = "1ZN"\naddress = "192.168.10.21"\n'
        '[[apps]]\nserial = "2ZN"\n'
        '[[apps]]\naddress = "fe80::/64"\n'
    )
    assert read_app_list(written(tmp_path, text)) == (
        AllowedApp("1ZN", ip_network("192.168.10.21/32")),
        AllowedApp("2ZN"),
        AllowedApp(None, ip_network("fe80::/64")),
    )


def test_an_empty_file_admits_no_app(tmp_path: Path) -> None:
    assert read_app_list(written(tmp_path, "")) == ()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[[apps]]\n", "expected a serial, an address, or both"),
        ('[[apps]]\nserial = "00000"\n', "placeholder"),
        ('[[apps]]\nserial = "a b"\n', "printable ASCII"),
        ('[[apps]]\naddress = "10.0.0.1/24"\n', "has host bits set"),
        ('[[apps]]\naddress = "10.0.0.999"\n', "expected an IP address"),
        ('[[apps]]\naddress = "drone.local"\n', "an IP address or network"),
        ('[[apps]]\nserail = "A"\n', "did you mean 'serial'"),
        ("apps = 3\n", "expected a list"),
        ("[[apps\n", "expected a TOML file"),
        (b"\xff\xfe", "expected a TOML file"),
        ("a = " + "[" * 5000, "expected a TOML file"),
        ("x" * 300_000, "at most"),
        ('[[apps]]\nserial = "A"\n' * (MAX_ENTRIES + 1), f"at most {MAX_ENTRIES} entries"),
    ],
)
def test_what_is_refused(tmp_path: Path, text: str | bytes, sentence: str) -> None:
    assert sentence in refusal(tmp_path, text)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(SiteError, match="expected a list of apps"):
        read_app_list(tmp_path / "none.toml")


SERIALS = st.text(string.digits + string.ascii_letters + string.punctuation, min_size=1).filter(
    lambda text: text != "00000"
)
NETWORKS = st.one_of(
    st.ip_addresses(v=4).map(lambda a: ip_network(a)),
    st.ip_addresses(v=6).map(lambda a: ip_network(a)),
    st.builds(
        lambda a, bits: ip_network(f"{a}/{bits}", strict=False),
        st.ip_addresses(v=4),
        st.integers(0, 32),
    ),
)
ENTRIES = st.one_of(
    st.builds(AllowedApp, SERIALS, NETWORKS),
    st.builds(AllowedApp, SERIALS, st.none()),
    st.builds(AllowedApp, st.none(), NETWORKS),
)


@settings(max_examples=examples(200), deadline=None)
@given(entries=st.lists(ENTRIES, max_size=8))
def test_what_is_written_is_read_back(
    tmp_path_factory: pytest.TempPathFactory, entries: list[AllowedApp]
) -> None:
    path = written(tmp_path_factory.mktemp("apps"), app_list_text(tuple(entries)))
    assert read_app_list(path) == tuple(entries)


PIECES = ["[[apps]]", "\n", 'serial = "A"', "address = ", '"10.0.0.0/8"', '"', "\\", "\x00", "#"]


@settings(max_examples=examples(400), deadline=None)
@given(data=st.one_of(st.binary(max_size=200), st.lists(st.sampled_from(PIECES)).map("".join)))
def test_any_file_is_a_list_or_one_sentence(
    tmp_path_factory: pytest.TempPathFactory, data: bytes | str
) -> None:
    path = written(tmp_path_factory.mktemp("apps"), data)
    sentence = ""
    try:
        assert isinstance(read_app_list(path), tuple)
    except SiteError as problem:
        sentence = str(problem)
    assert not sentence or re.match(r".*apps\.toml: ", sentence)
    assert sentence.isprintable()
