"""The proof of the step rule, and that it can fail: beyond its range, and on broken rules."""

import casadi as ca
import pytest

from gearmath.errors import ComputationError
from gearmath.gearbox.proof import prove_step_rule
from gearmath.gearbox.train import WIDEST


def rule(step, following=None):
    """A step rule with the arguments of gearbox_step from its equations."""
    names = ("remainder", "edge", "steps_numerator", "steps_denominator")
    a, d, N, D = symbols = [ca.SX.sym(name) for name in names]
    s = step(a + d * N, D)
    remainder = a + d * N - s * D if following is None else following(a + d * N, s, D)
    return ca.Function("rule", symbols, [s, remainder], list(names), ["step", "next_remainder"])


def test_exported_rule_is_proved_for_all_inputs(step_kernel):
    proved = prove_step_rule(step_kernel.function)
    assert "a' + s D = a + d N" in proved
    assert "|p - N e/D| <= 1/2 for every history from a_0 = floor(D/2)" in proved
    within_32_bits = [claim for claim in proved if "32 bits" in claim]
    outputs = step_kernel.function.n_out()
    assert len(within_32_bits) == step_kernel.function.n_instructions() - outputs  # every instruction that computes


def test_limit_is_two_to_the_thirty_and_tight(step_kernel):
    assert WIDEST == 2**30
    with pytest.raises(ComputationError, match=r"sum .* stays within 32 bits; .*steps_denominator = 1073741825"):
        prove_step_rule(step_kernel.function, WIDEST + 1)


@pytest.mark.parametrize(
    ("broken", "claim"),
    [
        (rule(lambda x, D: (x > D) - (x < 0)), "0 <= a' < D"),  # steps one edge late
        (rule(lambda x, D: x >= D), "0 <= a' < D"),  # forgets the way back
        (rule(lambda x, D: (x >= D) - (x < 0), lambda x, s, D: x - s * D + (s < 0)), "0 <= a' < D"),
        (rule(lambda x, D: (x >= D) - (x < 0), lambda x, s, D: x - x * (x < 0) - D * (x >= D)), "a' + s D = a + d N"),
        (rule(lambda x, D: (x >= D) - (x < 0), lambda x, s, D: ca.if_else(x >= D, x - D, ca.if_else(x < 0, x + D, x))),
         "32 bits"),  # both branches are evaluated, and the one not taken overflows
    ],
)  # fmt: skip
def test_broken_rule_is_not_proved(broken, claim):
    with pytest.raises(ComputationError) as caught:
        prove_step_rule(broken)
    assert str(caught.value).startswith("not true: ")
    assert claim in str(caught.value)
    assert "steps_denominator = " in str(caught.value)


def test_operation_without_a_meaning_in_whole_numbers_is_refused():
    halved = rule(lambda x, D: ca.floor(x / D))
    with pytest.raises(ComputationError, match="no whole-number meaning"):
        prove_step_rule(halved)
