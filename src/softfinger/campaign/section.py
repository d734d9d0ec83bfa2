"""Sections of ``campaign.yaml`` that refuse unknown keys."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

# Bounds far outside any soft finger: what they refuse is a slip of the unit.
Length = Annotated[float, Field(gt=1e-5, lt=2.0)]


class DeclaredSection(BaseModel):
    """Declared keys and values of one section."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=False, allow_inf_nan=False)
