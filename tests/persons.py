"""Persons that give orders in tests."""

from recon.model.person import Person, Role

ANN = Person("Ann", Role.OPERATOR)
BOB = Person("Bob", Role.OPERATOR)
