"""The users file: what was written is read, what is not a users file is one sentence."""

import stat
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.persons import user

from recon.model.errors import RecordError
from recon.model.person import Role, User, is_name
from recon.record.files.users_file import MAX_BYTES, MAX_USERS, change_users, read_users

HASH = "a" * 64
ROW = f'[[user]]\nname = "anna"\nrole = "pilot"\ntoken_sha256 = "{HASH}"\ncreated_utc = "x"\n'
USERS = (user("anna", Role.PILOT, "one"), user("bob", Role.ADMIN, "two"))


def written(path: Path, *users: User) -> Path:
    change_users(path, lambda known: users)
    return path


def test_what_was_written_is_read(tmp_path: Path) -> None:
    path = written(tmp_path / "new" / "users.toml", *USERS)
    assert read_users(path) == USERS
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert [each.name for each in path.parent.iterdir()] == ["users.toml"]


def test_without_a_file_there_are_no_users(tmp_path: Path) -> None:
    assert read_users(tmp_path / "users.toml") == ()


def test_a_change_that_fails_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    path = written(tmp_path / "users.toml", *USERS)

    def fails(known: tuple[User, ...]) -> tuple[User, ...]:
        raise KeyError

    with pytest.raises(KeyError):
        change_users(path, fails)
    assert read_users(path) == USERS
    assert len(list(tmp_path.iterdir())) == 1


def test_two_changes_at_once_lose_none(tmp_path: Path) -> None:
    path = written(tmp_path / "users.toml", *USERS)

    def with_another_inside(known: tuple[User, ...]) -> tuple[User, ...]:
        with pytest.raises(RecordError, match="another change of the users is under way"):
            change_users(path, lambda _: ())
        return known[:1]

    change_users(path, with_another_inside)
    assert read_users(path) == USERS[:1]


def test_a_file_that_others_can_write_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path / "users.toml", *USERS)
    path.chmod(0o620)
    with pytest.raises(RecordError, match="chmod 600"):
        read_users(path)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"\xff\xfe", "expected users as"),
        (b"[[user]", "expected users as"),
        (b"", "format"),
        (b"format = 2", "expected format 1, got 2"),
        (b"format = true", "format"),
        (b"format = 1\nuser = 3", "user"),
        (b"format = 1\nadmins = []", "admins"),
        (b"format = 1\n" + ROW.replace('"pilot"', '"king"').encode(), "king"),
        (b"format = 1\n" + ROW.replace("anna", "an na").encode(), "name must be"),
        (b"format = 1\n" + ROW.replace("anna", "a\u0430".encode().decode()).encode(), "name must"),
        (b"format = 1\n" + ROW.replace(HASH, "b" * 63).encode(), "64 hexadecimal digits"),
        (b"format = 1\n" + ROW.replace(HASH, "B" * 64).encode(), "64 hexadecimal digits"),
        (b"format = 1\n" + ROW.encode() * 2, "each name must appear once"),
        (b"format = 1\n" + ROW.encode() + ROW.replace("anna", "ANNA").encode(), "each name"),
        (b"format = 1\n" + ROW.encode() + ROW.replace("anna", "b").encode(), "same token"),
        (b"format = 1\n" + ROW.encode() * (MAX_USERS + 1), "length <= 64"),
        (b"format = 1\n#" + b"x" * MAX_BYTES, "up to 65536 bytes"),
        (b"format = " + b"[" * 5000, "expected users as"),
    ],
)
def test_what_is_not_a_users_file_is_one_sentence(
    content: bytes, sentence: str, tmp_path: Path
) -> None:
    path = tmp_path / "users.toml"
    path.write_bytes(content)
    path.chmod(0o600)
    with pytest.raises(RecordError, match=sentence) as problem:
        read_users(path)
    assert str(path) in str(problem.value)


def test_a_folder_is_no_users_file(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="users file"):
        read_users(tmp_path)


def test_there_is_a_limit(tmp_path: Path) -> None:
    path = tmp_path / "users.toml"
    many = [user(f"user-{number}", token=str(number)) for number in range(MAX_USERS + 1)]
    written(path, *many[:-1])
    with pytest.raises(RecordError, match="up to 64 users"):
        written(path, *many)
    assert len(read_users(path)) == MAX_USERS


@settings(max_examples=examples(300), deadline=None)
@given(st.binary(max_size=200), st.integers(0, 300), st.integers(0, 300))
def test_any_damage_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, noise: bytes, start: int, end: int
) -> None:
    path = tmp_path_factory.mktemp("users") / "users.toml"
    good = f"format = 1\n{ROW}".encode()
    path.write_bytes(good[:start] + noise + good[end:])
    path.chmod(0o600)
    try:
        users = read_users(path)
    except RecordError:
        return
    for each in users:
        assert is_name(each.name)
        assert len(each.token_sha256) == 32


@given(st.text(max_size=40))
def test_a_name_is_one_visible_word(text: str) -> None:
    if is_name(text):
        assert text.isascii()
        assert text.isprintable()
        assert " " not in text
        assert "(" not in text
