"""Persons that give orders in tests."""

from hashlib import sha256

from recon.model.person import Person, Role, User

ANN = Person("Ann", Role.OPERATOR)
BOB = Person("Bob", Role.OPERATOR)

TOKEN = "a-token-of-enough-letters"


def user(name: str = "cleo", role: Role = Role.OPERATOR, token: str = TOKEN) -> User:
    return User(name, role, sha256(token.encode()).digest(), "2026-05-01T09:30:00Z")
