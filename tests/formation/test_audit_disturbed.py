"""What an audit finds about delay, errors and noise is what the closed forms say of the same loop, and no more."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import LAWS, AngleLaw, TargetFormation, random_target
from formation.analysis.amplification import transient_gain
from formation.analysis.cascade import Cascade
from formation.analysis.margins import delay_margin, most_periods
from formation.analysis.noise import bias_gains, noise_power, noise_rms
from formation.audit import Finding, Subject, audit
from formation.audit.disturbed import UNKNOWN
from formation.graph.designs import design

PERIOD = 0.1
CHECKS = ("delay", "growth of errors", "bias", "noise")


def findings(subject: Subject, period: float = PERIOD) -> dict[str, Finding]:
    return {finding.check: finding for finding in audit(subject, period)}


@settings(max_examples=12)
@given(
    seed=st.integers(0, 2**32 - 1), n=st.integers(3, 8), first_follower=st.sampled_from(["stationary", "displacement"])
)
def test_the_figures_of_the_paper_s_law_are_those_of_its_cascade(seed: int, n: int, first_follower: str) -> None:
    target = random_target(n, np.random.default_rng(seed), np.radians(25.0))
    steered = first_follower == "displacement"
    delta = tuple((target.positions[1] - target.positions[0]).tolist()) if steered else None
    loop = Cascade.of(target, float(steered))
    found = findings(Subject(AngleLaw(target, first_follower), target, delta))
    rates = loop.rates[loop.rates > 0.0]
    assert found["delay"].measured == pytest.approx(delay_margin(-rates), rel=1e-6)
    assert found["delay"].remark.endswith(f"{most_periods(-rates, PERIOD)} control periods where commands are held")
    gain, when = transient_gain(loop)
    assert found["growth of errors"].measured == pytest.approx(gain, rel=0.01)
    if gain > 1.2:
        told = float(found["growth of errors"].remark.removeprefix("fold at most, after ").removesuffix(" s"))
        assert told == pytest.approx(when, abs=0.26 / rates.max())
    assert found["bias"].measured == pytest.approx(bias_gains(loop).max(), rel=1e-6)
    noise = noise_rms(loop, PERIOD, noise_power(loop, target.positions, 1.0))
    assert found["noise"].measured == pytest.approx(noise.max(), rel=1e-5)
    assert [found[check].unit for check in CHECKS] == ["s", "", "m/m", "m/m"]
    assert all(found[check].holds is None for check in CHECKS)


def test_errors_that_decay_from_the_start_are_told_so(paper: TargetFormation) -> None:
    grown = findings(Subject(AngleLaw(paper), paper))["growth of errors"]
    assert (grown.measured, grown.remark) == (1.0, "fold: they decay from the start")


def test_beyond_the_stable_control_period_noise_has_no_level_and_no_delay_is_stable(paper: TargetFormation) -> None:
    found = findings(Subject(AngleLaw(paper), paper), 2.5)
    assert found["noise"].measured is None
    assert found["noise"].remark == "unknown: the loop is not stable at the control period"
    assert found["delay"].remark == "that is stable; no delay is stable"
    assert found["delay"].measured == pytest.approx(np.pi / 2.0, rel=1e-6)


def test_of_loops_that_are_no_cascade_or_do_not_decay_or_have_a_kink_nothing_is_told(paper: TargetFormation) -> None:
    undirected = design("undirected", paper)
    found = findings(Subject(LAWS["displacement-undirected"](undirected), undirected))  # type: ignore[call-arg,arg-type]
    assert found["delay"].measured is not None
    assert [found[check].remark for check in CHECKS[1:]] == [UNKNOWN] * 3

    class Bent:
        """The angle law, made of another one."""

        needs_compass = False

        def __init__(self, kind: str) -> None:
            self.kind, self.law = kind, AngleLaw(paper)

        def __call__(self, relative: np.ndarray, *_: object) -> np.ndarray:
            u = self.law(relative)
            return {"still": 0.0 * u, "kinked": np.abs(u), "away": -u}[self.kind]

    for kind in ("still", "kinked"):
        found = findings(Subject(Bent(kind), paper))  # type: ignore[arg-type]
        assert [found[check].remark for check in CHECKS] == [UNKNOWN] * 4
    found = findings(Subject(Bent("away"), paper))  # type: ignore[arg-type]
    assert found["delay"].measured == 0.0
    assert [found[check].remark for check in CHECKS[1:]] == [UNKNOWN] * 3
