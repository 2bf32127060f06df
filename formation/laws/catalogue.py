"""All laws by the name that scenario files use."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from formation.laws.affine import AffineLaw, UndirectedAffineLaw
from formation.laws.angle import AngleLaw
from formation.laws.area import AreaLaw, UndirectedAreaLaw
from formation.laws.base import Law
from formation.laws.bearing import BearingLaw, UndirectedBearingLaw
from formation.laws.bisector import BisectorLaw
from formation.laws.cosine import CosineLaw
from formation.laws.displacement import DisplacementLaw, UndirectedDisplacementLaw
from formation.laws.distance import DistanceLaw, UndirectedDistanceLaw
from formation.laws.laplacian import LaplacianLaw
from formation.laws.persistent import PersistentLaw
from formation.laws.ratio import RatioLaw
from formation.laws.redundant import RedundantLaw
from formation.laws.triangle import BasiriLaw, BishopLaw
from formation.laws.triangular import TriangularLaw

LAWS: Mapping[str, type[Law]] = MappingProxyType(
    {
        law.name: law
        for law in (
            AngleLaw,
            RatioLaw,
            RedundantLaw,
            DisplacementLaw,
            UndirectedDisplacementLaw,
            BearingLaw,
            UndirectedBearingLaw,
            DistanceLaw,
            UndirectedDistanceLaw,
            AreaLaw,
            UndirectedAreaLaw,
            PersistentLaw,
            CosineLaw,
            TriangularLaw,
            BisectorLaw,
            LaplacianLaw,
            AffineLaw,
            UndirectedAffineLaw,
            BasiriLaw,
            BishopLaw,
        )
    }
)
"""The laws by the name that scenario files use."""
