"""Every ``prove_*`` function of every chapter, run."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import derivations

PROOFS = list(derivations.proofs())


def chapter_of(proof: Callable[[], None]) -> str:
    return proof.__module__.removeprefix("derivations.")


@pytest.mark.parametrize("proof", PROOFS, ids=lambda proof: f"{chapter_of(proof)}.{proof.__name__}")
def test_proof_holds(proof: Callable[[], None]) -> None:
    proof()


def test_every_chapter_has_a_proof() -> None:
    assert {chapter_of(proof) for proof in PROOFS} == set(derivations.CHAPTERS)


def test_every_proof_says_what_it_proves() -> None:
    assert [proof.__name__ for proof in PROOFS if not proof.__doc__] == []
