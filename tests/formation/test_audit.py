"""An audit passes the laws that the theory vouches for, and finds each fault in a law that has just that one."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import LAWS, AngleLaw, SensingGraph, TargetFormation, random_target
from formation.audit import Finding, Subject, audit
from formation.graph.designs import design

Real = np.ndarray

GRAPH = SensingGraph(np.array([[0, 1], [1, 2], [0, 3], [0, 3]]))
TARGET = TargetFormation(GRAPH, np.array([[0, 0], [1, 0], [0, 1], [1, 1], [1.5, -0.5], [-0.5, 1.5]], dtype=float))
PERIOD = 0.033
DISPLACEMENT = (0.5, -0.7)


class Bent:
    """The angle law, with its velocities (n, 2) changed by a function of them and of what is measured."""

    def __init__(self, bend: Callable[[Real, Real, Real], Real], needs_compass: bool = False) -> None:
        self._law, self._bend, self.needs_compass = AngleLaw(TARGET), bend, needs_compass

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        u = self._law(relative)
        return self._bend(u, relative, u if compass is None else compass)


class Counting:
    """The angle law, faster with every call."""

    needs_compass = False

    def __init__(self) -> None:
        self._law, self._calls = AngleLaw(TARGET), 0

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        self._calls += 1
        return self._law(relative) * (1.0 + 0.01 * self._calls)


def findings(law: object, delta: tuple[float, float] | None = None) -> dict[str, Finding]:
    return {f.check: f for f in audit(Subject(law, TARGET, delta), PERIOD)}  # type: ignore[arg-type]


def failed(found: dict[str, Finding]) -> set[str]:
    return {name for name, finding in found.items() if finding.holds is False}


# What passes


@settings(max_examples=25)  # of seven laws each
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(3, 9))
def test_every_built_in_law_passes_on_every_target_and_fixes_what_theory_says(seed: int, n: int) -> None:
    target = random_target(n, np.random.default_rng(seed), np.radians(20.0))
    laws = [
        (AngleLaw(target), None, "shape;"),
        (AngleLaw(target, "displacement"), DISPLACEMENT, "shape, scale and orientation;"),
        (AngleLaw(target, "distance"), DISPLACEMENT, "shape and scale;"),
        (AngleLaw(target, "bearing"), DISPLACEMENT, "shape and orientation;"),
        (LAWS["displacement"](target), None, "shape, scale and orientation;"),
        (LAWS["distance"](target), None, "shape and scale;"),
        (LAWS["bearing"](target), None, "shape and orientation;"),
    ]
    for law, delta, fixes in laws:
        found = {f.check: f for f in audit(Subject(law, target, delta), 1e-6)}  # type: ignore[arg-type]
        assert failed(found) == set(), (law, found)
        assert found["what it fixes"].remark.startswith(fixes)
        assert found["batches"].remark.startswith("taken")


def test_only_the_distance_law_needs_no_common_sense_of_rotation_and_rests_in_the_mirror_image() -> None:
    for law in (AngleLaw(TARGET), LAWS["distance"](TARGET), LAWS["bearing"](TARGET)):
        found, free = findings(law), not isinstance(law, AngleLaw) and not law.needs_compass
        assert found["mirrored frames"].remark.startswith("no common") == free
        assert found["mirror image"].remark.startswith("at rest") == free


def test_the_slowest_decay_is_that_of_the_flattest_follower_with_its_edges() -> None:
    stability = findings(AngleLaw(TARGET))["local stability"]
    assert stability.measured == pytest.approx(0.5, abs=1e-6)
    assert stability.remark == "the slowest decay, agent 3, edges (3, 1) (3, 2)"


def test_a_law_with_a_length_far_below_the_formations_is_seen_to_be_smooth() -> None:
    """Its speed saturates a tenth of a millimetre from the target."""
    found = findings(Bent(lambda u, relative, _: 1e-4 * np.tanh(u / 1e-4)))
    assert failed(found) == {"local frames"}
    assert found["local stability"].measured == pytest.approx(0.5, abs=1e-6)


# What fails, and nothing else with it


def peeks(u: Real, relative: Real, _: Real) -> Real:
    """Agent 6 goes faster while agent 4 is far from agent 3: by a distance alone, so that frames do not matter."""
    distance = np.hypot(*relative[4])
    u[5] *= 1.0 + 0.1 * np.tanh(distance)
    return u


def peeks_by_zero(u: Real, relative: Real, _: Real) -> Real:
    """A sum over all rows, with the weight 0."""
    u[5] += 0.0 * relative.sum()
    return u


def reads_others_compass(u: Real, _: Real, compass: Real) -> Real:
    u[3] *= np.hypot(*compass[4])
    return u


def world_vector(u: Real, _: Real, compass: Real) -> Real:
    return u + 0.01 * compass


def frame_dependent(u: Real, relative: Real, _: Real) -> Real:
    """Follower 4 goes faster where agent 3 lies along its own x axis."""
    u[3] *= 1.0 + 0.5 * relative[4, 0] / np.hypot(*relative[4])
    return u


def sign_flipped(u: Real, _: Real, __: Real) -> Real:
    return -u


def too_fast(u: Real, _: Real, __: Real) -> Real:
    return 100.0 * u


def infinitely_steep(u: Real, _: Real, __: Real) -> Real:
    """Like a square root, which makes rounding visible: 1e-16 becomes 1e-8, and that is no rest."""
    return u / np.sqrt(np.maximum(np.linalg.norm(u, axis=-1, keepdims=True), 1e-300))


def flat(u: Real, _: Real, __: Real) -> Real:
    """Slower than linear: the linearisation does not see it move."""
    return u * (u**2).sum(axis=-1, keepdims=True)


def one_idle(u: Real, _: Real, __: Real) -> Real:
    u[4] = 0.0
    return u


AT_TARGET = {"zero modes", "local stability", "control period"}

FAULTS = {
    "locality": (peeks, False, {"locality"}),
    "locality, by NaN": (peeks_by_zero, False, {"locality"}),
    "locality, compass": (reads_others_compass, True, {"locality"}),
    "rest": (world_vector, True, {"rest at the target", "zero modes"}),
    "frames": (frame_dependent, False, {"local frames"}),
    "stability": (sign_flipped, False, {"local stability", "control period"}),
    "clock": (too_fast, False, {"control period"}),
    "derivative": (infinitely_steep, False, {"rest at the target", "derivative"} | AT_TARGET),
    "no modes": (flat, False, {"zero modes", "local stability"}),
    "idle": (one_idle, False, {"zero modes"}),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found_and_no_other_with_it(fault: str) -> None:
    bend, needs_compass, expected = FAULTS[fault]
    assert failed(findings(Bent(bend, needs_compass))) == expected


@pytest.mark.parametrize(
    ("bend", "needs_compass", "check", "remark"),
    [
        (peeks, False, "locality", "agent 6 reads edge (4, 3)"),
        (peeks_by_zero, False, "locality", "agent 6 reads edge (2, 1), if only its NaN"),
        (reads_others_compass, True, "locality", "agent 4 reads the compass of others, if only its NaN"),
        (frame_dependent, False, "local frames", "the frame moves agent 4, edges (4, 2) (4, 3)"),
        (sign_flipped, False, "local stability", "does not decay, agent 4, edges (4, 2) (4, 3)"),
    ],
)
def test_a_fault_is_told_with_its_agent_and_its_edge_by_number(
    bend: Callable[[Real, Real, Real], Real], needs_compass: bool, check: str, remark: str
) -> None:
    assert findings(Bent(bend, needs_compass))[check].remark == remark


def test_a_law_with_a_memory_does_not_give_the_same_answer_again() -> None:
    again = findings(Counting())["same answer again"]
    assert again.holds is False
    assert again.remark.startswith("a memory in agent ")


def test_the_law_of_the_mirrored_target_rests_in_the_mirror_image_and_not_at_the_target() -> None:
    law, mirror = AngleLaw(TARGET), np.array([1.0, -1.0])
    found = findings(Bent(lambda u, relative, _: law(relative * mirror) * mirror))
    assert failed(found) == {"rest at the target", "zero modes"}
    assert found["mirror image"].remark.startswith("at rest")


def test_a_law_that_mirrors_its_output_hangs_on_its_frame() -> None:
    assert "local frames" in failed(findings(Bent(lambda u, relative, _: u * [1.0, -1.0])))


@pytest.mark.parametrize(
    ("bend", "remark"),
    [
        (lambda u, relative, _: u[:-1], "expected the shape (6, 2), got (5, 2)"),
        (lambda u, relative, _: u[..., 0] + 1j * u[..., 1], "expected the shape (6, 2), got (6,)"),
        (lambda u, relative, _: u.astype(complex), "expected real floats, got complex128"),
        (lambda u, relative, _: np.where(np.arange(6)[:, None] == 3, np.nan, u), "not finite for agent 4, edges"),
        (lambda u, relative, _: u[7], "raised IndexError"),
    ],
    ids=["shape", "complex-shape", "dtype", "nan", "raises"],
)
def test_an_output_that_cannot_be_used_is_the_only_finding(
    bend: Callable[[Real, Real, Real], Real], remark: str
) -> None:
    found = findings(Bent(bend))
    assert list(found) == ["output"]
    assert found["output"].holds is False
    assert found["output"].remark.startswith(remark)


def test_a_law_that_refuses_what_others_measure_has_read_it() -> None:
    def strict(u: Real, relative: Real, _: Real) -> Real:
        if not np.isfinite(relative).all():
            raise ValueError("bad measurement")
        return u

    assert findings(Bent(strict))["locality"].remark == "raised ValueError: bad measurement"


@pytest.mark.parametrize(
    ("bend", "remark"),
    [
        (lambda u, relative, _: u[:, :].reshape(6, 2), "not taken (ValueError)"),
        (lambda u, relative, _: u[0] if u.ndim == 3 else u, "not taken (got (6, 2))"),
        (lambda u, relative, _: u - u[:1] if u.ndim == 3 else u, "other than state by state"),
    ],
    ids=["raises", "shape", "other"],
)
def test_a_law_that_takes_no_batches_passes_and_is_told(bend: Callable[[Real, Real, Real], Real], remark: str) -> None:
    found = findings(Bent(bend))
    assert failed(found) == set()
    assert found["batches"].remark.startswith(remark)


def test_a_law_that_answers_from_one_array_of_its_own_is_not_confused_with_itself() -> None:
    answer = np.zeros((6, 2))

    def reused(u: Real, relative: Real, _: Real) -> Real:
        answer[:] = u
        return answer

    assert failed(findings(Bent(reused))) == set()


def test_velocities_that_differ_by_a_billionth_of_the_greatest_speed_are_the_same() -> None:
    def leaning(share: float) -> Finding:
        def bend(u: Real, relative: Real, _: Real) -> Real:
            u[3] *= 1.0 + share * relative[4, 0] / np.hypot(*relative[4])
            return u

        return findings(Bent(bend))["local frames"]

    slope = (leaning(1e-4).measured or 0.0) / 1e-4
    assert leaning(0.9e-9 / slope).holds is True
    assert leaning(1.1e-9 / slope).holds is False


def test_a_law_that_never_moves_anybody_reads_nothing_of_others_and_uses_nothing() -> None:
    found = findings(Bent(lambda u, relative, _: 0.0 * np.nan_to_num(u)))
    assert failed(found) == {"measurements", "zero modes", "local stability"}


# What is measured


def test_the_figure_of_a_check_is_of_the_agent_that_fares_worst() -> None:
    def pushed(u: Real, _: Real, __: Real) -> Real:
        u[3] += [0.0, 0.02]
        return u

    at_rest = findings(Bent(pushed))["rest at the target"]
    assert at_rest.measured == pytest.approx(0.02)
    assert at_rest.remark == "not for agent 4, edges (4, 2) (4, 3)"
    assert findings(Bent(flat))["local stability"].measured == 0.0
    leaning = findings(Bent(frame_dependent))["local frames"].measured
    assert leaning is not None
    assert 0.05 < leaning <= 1.0  # a share of the greatest speed
    mirrored = findings(Bent(lambda u, relative, _: u))["mirrored frames"]
    assert (mirrored.holds, mirrored.remark) == (None, "a common sense of rotation is needed")
    assert mirrored.measured is not None
    assert mirrored.measured > 0.1


def test_what_is_declared_otherwise_is_told_and_what_is_no_cascade_has_no_owner() -> None:
    class Declared(Bent):
        """A law with a word about mirrored frames."""

        needs_handedness = False

    assert findings(Declared(lambda u, _, __: u))["mirrored frames"].remark.endswith("is needed, declared otherwise")
    Declared.needs_handedness = True
    assert findings(Declared(lambda u, _, __: u))["mirrored frames"].remark.endswith("is needed, as declared")
    undirected = design("undirected", TARGET)
    found = audit(Subject(LAWS["displacement-undirected"](undirected), undirected), PERIOD)  # type: ignore[call-arg,arg-type]
    stability = {finding.check: finding for finding in found}["local stability"]
    assert (stability.holds, stability.remark) == (True, "the slowest decay")


@pytest.mark.parametrize("moves", [np.greater, np.less])
def test_a_scale_is_free_only_if_larger_and_smaller_copies_rest(moves: Callable[[float, float], bool]) -> None:
    def bend(u: Real, relative: Real, _: Real) -> Real:
        size = np.hypot(*relative.T).sum()
        away = size - np.hypot(*Subject(AngleLaw(TARGET), TARGET).measure(TARGET.positions)[0][0].T).sum()
        return u + (0.1 * away if moves(away, 0.0) else 0.0)

    assert findings(Bent(lambda u, _, __: u))["what it fixes"].remark == "shape; free: position, orientation, scale"
    assert findings(Bent(bend))["what it fixes"].remark == "shape and scale; free: position, orientation"
