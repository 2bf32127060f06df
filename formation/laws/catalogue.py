"""All laws by the name that scenario files use."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from formation.laws.angle import AngleLaw
from formation.laws.base import Law
from formation.laws.bearing import BearingLaw, UndirectedBearingLaw
from formation.laws.displacement import DisplacementLaw, UndirectedDisplacementLaw
from formation.laws.distance import DistanceLaw, UndirectedDistanceLaw

LAWS: Mapping[str, type[Law]] = MappingProxyType(
    {
        law.name: law
        for law in (
            AngleLaw,
            DisplacementLaw,
            UndirectedDisplacementLaw,
            BearingLaw,
            UndirectedBearingLaw,
            DistanceLaw,
            UndirectedDistanceLaw,
        )
    }
)
