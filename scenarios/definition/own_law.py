"""A user's own law: made by the factory that its scenario names, and held to what a law is at every call.

Every mistake of the user's code is bad input, told in one line with the line of the file where there is one.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from formation import FormationLaw, Framework, needs
from formation.laws.protocol import LEADER_FIRST_FOLLOWER
from formation.measurements import ANGLE, KINDS, RATIO, perfect
from scenarios.definition.files.law_file import LawFile, defined
from scenarios.errors import InputError, did_you_mean

Real = NDArray[np.float64]

SAME = 1e-9
"""Relative to the greatest speed: velocities that differ by less are the same but for the order of additions."""


class OwnLaw:
    """A user's law as the runner calls it.

    Arguments are read-only for the user's code, what it returns is copied, and a law that takes one state at a time is
    called once for each state of a batch.

    Attributes:
        raw: what the user's factory made.
        needs_compass: whether an agent needs the common x axis in its own frame.
        needs_handedness, measures, graph, communicates: as the user's law declares them.
        batched: whether the user's code takes leading batch dimensions.
    """

    def __init__(self, file: LawFile, raw: FormationLaw, target: Framework, delta: Real | None) -> None:
        if not callable(raw):
            raise InputError(f"{file.path}: expected a law that can be called, got {_kind(raw)} without __call__")
        if not hasattr(raw, "needs_compass"):
            raise InputError(f"{file.path}: {_kind(raw)}.needs_compass: missing, expected True or False")
        if not isinstance(raw.needs_compass, bool):
            raise InputError(f"{file.path}: {_kind(raw)}.needs_compass: expected bool, got {raw.needs_compass!r:.80}")
        self.raw, self.needs_compass = raw, raw.needs_compass
        self._file, self._target = file, target
        declared = needs(raw)
        for kind in declared.measures:
            if kind not in KINDS:
                known = did_you_mean(str(kind), KINDS)
                raise InputError(f"{file.path}: {_kind(raw)}.measures: no such kind {kind!r:.80}, {known}")
        if not declared.measures:
            raise InputError(f"{file.path}: {_kind(raw)}.measures: expected at least one kind, got none")
        self.measures, self.graph, self.communicates = declared.measures, declared.graph, declared.communicates
        self.needs_handedness = declared.handedness
        self.batched = self._takes_batches(delta)

    def __call__(self, *arguments: Real | None) -> Real:
        """Velocities (..., n, 2), m/s, from what is measured, compass and delta; see :class:`FormationLaw`.

        Raises:
            InputError: the user's code raises, or returns something else.
        """
        given = [*arguments, *[None] * (len(self.measures) + 2 - len(arguments))]
        arrays = [array for array in given[: len(self.measures)] if array is not None]
        compass, delta = given[len(self.measures) :]
        batch = self._batch(arrays)
        if self.batched or not batch:
            return self._ask(arrays, compass, delta)
        velocities = np.empty((*batch, self._target.graph.n, 2))
        for index in np.ndindex(batch):
            own = None if compass is None else compass[index]
            velocities[index] = self._ask([array[index] for array in arrays], own, delta)
        return velocities

    def _batch(self, measured: Sequence[Real]) -> tuple[int, ...]:
        return measured[0].shape[: measured[0].ndim - KINDS[self.measures[0]]]

    def _ask(self, measured: Sequence[Real], compass: Real | None, delta: Real | None) -> Real:
        try:
            with np.errstate(all="ignore"):  # NaN is an outcome, not a warning
                answer = np.asarray(
                    self.raw(
                        *(_sealed(array) for array in measured),
                        None if compass is None else _sealed(compass),
                        None if delta is None else _sealed(delta),
                    )
                )
        except (Exception, SystemExit) as error:
            raise self._file.failure("a call of the law", error) from error
        shape = (*self._batch(measured), self._target.graph.n, 2)
        if answer.shape != shape:
            raise InputError(f"{self._file.path}: expected velocities of the shape {shape}, got {answer.shape}")
        if not np.issubdtype(answer.dtype, np.floating):
            raise InputError(f"{self._file.path}: expected velocities that are real floats, got {answer.dtype}")
        return np.array(answer, dtype=np.float64, order="C")

    def _takes_batches(self, delta: Real | None) -> bool:
        """Ask for two states apart and then together; what goes wrong apart is a mistake, together it is an answer."""
        graph, rng = self._target.graph, np.random.default_rng(0)
        p = self._target.positions + rng.normal(0.0, self._target.positions.std(), (2, graph.n, 2))
        relative = p[:, graph.edges[:, 1]] - p[:, graph.edges[:, 0]]
        compass = np.tile([1.0, 0.0], (2, graph.n, 1)) if self.needs_compass else None
        corners = graph.corners if {ANGLE, RATIO} & set(self.measures) else np.empty((0, 2), dtype=np.intp)
        measured = perfect(self.measures, relative, corners)
        apart = [self._ask([a[k] for a in measured], None if compass is None else compass[k], delta) for k in range(2)]
        try:
            together = self._ask(measured, compass, delta)
        except InputError:
            return False
        tolerance = SAME * np.abs(np.nan_to_num(apart)).max()
        return np.allclose(together, apart, rtol=0.0, atol=tolerance, equal_nan=True)


def condition(file: LawFile, factory: str) -> str:
    """The condition on the sensing graph that an own law declares, of the paper's kind where it says nothing.

    Whom agents sense must be known before the law is made, and of a run that is only looked at; so it is read in the
    file, which is not executed.
    """
    return file.literal(factory, "graph") or LEADER_FIRST_FOLLOWER


class NotLoaded:
    """In place of the own law of a run that is read back: to look at a run, nothing of it is executed."""

    needs_compass = False

    def __call__(self, *arguments: Real | None) -> Real:
        raise InputError("law: that of a run that was read back cannot run")


class OwnFactory:
    """What makes a user's law: executes the file and finds the factory in it.

    Args:
        scenario: the scenario file, for messages.
        file: of the law.
        name: of the function or class in the file.
        parameters: of the factory, by name.

    Attributes:
        graph: the condition on the sensing graph that the factory declares; see :func:`condition`.

    Raises:
        InputError: any mistake in the file or the names.
    """

    def __init__(self, scenario: str, file: LawFile, name: str, parameters: Mapping[str, float]) -> None:
        module = file.execute()
        make = getattr(module, name, None)
        if not callable(make):
            names = defined(module)
            known = did_you_mean(name, names) if names else "it has none at all"
            raise InputError(f"{scenario}: law.factory: {file.path} has no function or class {name!r}, {known}")
        check_parameters(scenario, name, make, parameters)
        self.graph, has = condition(file, name), getattr(make, "graph", LEADER_FIRST_FOLLOWER)
        if has != self.graph:
            raise InputError(
                f"{file.path}: {name}.graph: expected a literal text, got one that is computed: {has!r:.80}"
            )
        self._file, self._name, self._make, self._parameters = file, name, make, parameters

    def make(self, target: Framework, delta: tuple[float, float] | None) -> OwnLaw:
        """Call the factory once as ``factory(target, **parameters)``, and try the law that it makes.

        Args:
            target: the target formation.
            delta: commanded displacement of agent 2 from agent 1 in the first phase, metres; None where there is none.

        Raises:
            InputError: any mistake in the factory or the law.
        """
        try:
            raw = self._make(target, **self._parameters)
        except (Exception, SystemExit) as error:
            arguments = ", ".join(["target", *(f"{name}={value:g}" for name, value in self._parameters.items())])
            raise self._file.failure(f"{self._name}({arguments})", error) from error
        return OwnLaw(self._file, raw, target, None if delta is None else np.array(delta))


def check_parameters(scenario: str, factory: str, make: Callable[..., Any], given: Mapping[str, float]) -> None:
    """Refuse misspelt and missing parameters by the name that the scenario gives them."""
    try:
        takes = list(inspect.signature(make).parameters.values())[1:]
    except (TypeError, ValueError):  # compiled code may have no signature; calling it will tell
        return
    names = [p.name for p in takes if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
    for name in given:
        if name not in names and not any(p.kind is p.VAR_KEYWORD for p in takes):
            known = did_you_mean(name, names) if names else "it takes none"
            raise InputError(f"{scenario}: law.parameters.{name}: not a parameter of {factory}, {known}")
    for p in takes:
        if p.name in names and p.default is p.empty and p.name not in given:
            raise InputError(f"{scenario}: law.parameters.{p.name}: missing, {factory} needs it")


def _sealed(argument: Real) -> Real:
    view = argument.view()
    view.flags.writeable = False
    return view


def _kind(value: object) -> str:
    return type(value).__name__
