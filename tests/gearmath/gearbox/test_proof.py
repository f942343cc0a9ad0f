"""The proofs of the step rules, and that they can fail: beyond their range, and on broken rules."""

import casadi as ca
import pytest

from derivations.gearbox import counter_motion, encoder_hysteresis, gearbox_edge
from gearmath.errors import ComputationError
from gearmath.gearbox.proof import WIDEST, prove_counter, prove_edge_rule, prove_hysteresis, prove_step_rule
from gearmath.lowering import lower


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
    assert WIDEST[32] == 2**30
    with pytest.raises(ComputationError, match=r"sum .* stays within 32 bits; .*steps_denominator = 1073741825"):
        prove_step_rule(step_kernel.function, WIDEST[32] + 1)


@pytest.mark.parametrize(
    ("broken", "claim"),
    [
        (rule(lambda x, D: (x > D) - (x < 0)), "0 <= a' < D"),  # steps one edge late
        (rule(lambda x, D: x >= D), "0 <= a' < D"),  # forgets the way back
        (rule(lambda x, D: (x >= D) - (x < 0), lambda x, s, D: x - s * D + (s < 0)), "0 <= a' < D"),
        (rule(lambda x, D: (x >= D) - (x < 0), lambda x, s, D: x - x * (x < 0) - D * (x >= D)), "a' + s D = a + d N"),
        (
            rule(
                lambda x, D: (x >= D) - (x < 0), lambda x, s, D: ca.if_else(x >= D, x - D, ca.if_else(x < 0, x + D, x))
            ),
            "32 bits",
        ),  # both branches are evaluated, and the one not taken overflows
    ],
)
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


def edge_rule(steps, following):
    """A rule with the arguments of gearbox_edge from its equations."""
    names = ("remainder", "edge", "increment", "base_step", "steps_denominator")
    a, d, N, q, D = symbols = [ca.SX.sym(name) for name in names]
    s = (a + d * N >= D) - (a + d * N < 0)
    outputs = [steps(d, q, s), following(a + d * N, s, D)]
    return ca.Function("rule", symbols, outputs, list(names), ["edge_steps", "next_remainder"])


def remains(x, s, D):
    return x - s * D


@pytest.mark.parametrize("bits", [32, 64])
def test_exported_edge_rule_is_proved_for_any_ratio_and_several_axes(bits):
    function = lower(gearbox_edge()).function
    proved = prove_edge_rule(function, bits)
    assert "a' + (steps) D = a + d (q D + N')" in proved
    assert "|p - (N_1 e_1 + N_2 e_2 + ...)/D| <= 1/2 for every history from a_0 = floor(D/2)" in proved
    assert sum(f"{bits} bits" in claim for claim in proved) == function.n_instructions() - function.n_out()


@pytest.mark.parametrize("bits", [32, 64])
def test_range_of_the_edge_rule_is_tight(bits):
    assert WIDEST[bits] == 2 ** (bits - 2)
    with pytest.raises(
        ComputationError, match=rf"stays within {bits} bits; .*steps_denominator = {2 ** (bits - 2) + 1}"
    ):
        prove_edge_rule(lower(gearbox_edge()).function, bits, WIDEST[bits] + 1)


@pytest.mark.parametrize(
    ("broken", "claim"),
    [
        (edge_rule(lambda d, q, s: q + s, remains), "(steps) D"),  # the base step goes forward on every edge
        (edge_rule(lambda d, q, s: d * q - s, remains), "(steps) D"),
        (edge_rule(lambda d, q, s: d * q + s, lambda x, s, D: x - s * D + s), "(steps) D"),  # 1/D lost a step
        (edge_rule(lambda d, q, s: d * q + s, lambda x, s, D: x), "0 <= a' < D"),  # the remainder runs away
        (edge_rule(lambda d, q, s: 1024 * d * q * q * q * q + s, remains), "32 bits"),
    ],
)
def test_broken_edge_rule_is_not_proved(broken, claim):
    with pytest.raises(ComputationError) as caught:
        prove_edge_rule(broken)
    assert str(caught.value).startswith("not true: ")
    assert claim in str(caught.value)


def test_exported_hysteresis_is_proved():
    proved = prove_hysteresis(lower(encoder_hysteresis()).function)
    assert {"the play stays in 0 <= x' <= H", "x' + d' = x + d"} < set(proved)


def test_hysteresis_that_loses_a_count_is_not_proved():
    x, d, H = (ca.SX.sym(name) for name in ("x", "d", "H"))
    passed = (x + d > H) - (x + d < 0)
    names = ["play", "edge", "hysteresis"]
    outputs = ["passed_edge", "next_play"]
    broken = ca.Function("rule", [x, d, H], [passed, (x + d) * (passed == 0)], names, outputs)
    with pytest.raises(ComputationError, match=r"not true: x' \+ d' = x \+ d; for .*hysteresis = "):
        prove_hysteresis(broken)
    with pytest.raises(ComputationError, match="hysteresis = 2147483648"):
        prove_hysteresis(lower(encoder_hysteresis()).function, 2**31)


def test_counter_of_the_board_is_proved_for_every_reading_and_motion():
    function = lower(counter_motion()).function
    assert "what is counted is the motion" in prove_counter(function)


def test_half_the_range_of_the_counter_is_tight():
    with pytest.raises(ComputationError, match=r"not true: what is counted is the motion; .*motion = (-32769|32768)"):
        prove_counter(lower(counter_motion()).function, 2**15 + 1)
