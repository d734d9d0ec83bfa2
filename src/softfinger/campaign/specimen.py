"""A specimen: one degree of freedom, any unit."""

from typing import Annotated

from pydantic import AfterValidator, Field

from softfinger.campaign.section import DeclaredSection
from softfinger.campaign.units import parse_unit
from softfinger.faults import Fault


def _check_unit(text: str) -> str:
    try:
        parse_unit(text)
    except Fault as fault:
        raise ValueError(str(fault)) from None
    return text


Unit = Annotated[str, AfterValidator(_check_unit)]
Words = Annotated[str, Field(min_length=1, max_length=60)]


class Quantity(DeclaredSection):
    """A measured quantity and its unit, maybe "1"."""

    quantity: Words = Field(description="what is measured, in a word or two", examples=["force"])
    unit: Unit = Field(description="its unit, or 1 where it has none", examples=["N"])


class Motion(Quantity):
    """The motion, and its noise [its unit]."""

    noise_sd: float | None = Field(
        default=None,
        gt=0.0,
        description="the sd of its noise, in its unit; estimated where it is not given",
        examples=[0.01],
    )


class Specimen(DeclaredSection):
    """One motion that follows a load."""

    motion: Motion
    load: Quantity
