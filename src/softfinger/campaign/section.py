"""Sections of ``campaign.yaml`` that refuse unknown keys."""

from pydantic import BaseModel, ConfigDict


class DeclaredSection(BaseModel):
    """Declared keys and values of one section."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=False, allow_inf_nan=False)
