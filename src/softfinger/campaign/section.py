"""Base of every section of ``campaign.yaml``: no unknown key, no infinite number."""

from pydantic import BaseModel, ConfigDict


class DeclaredSection(BaseModel):
    """Keys and values of one section, all of them declared."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=False, allow_inf_nan=False)
