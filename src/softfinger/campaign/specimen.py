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

    quantity: Words
    unit: Unit


class Motion(Quantity):
    """The motion, and its noise [its unit]."""

    noise_sd: float | None = Field(default=None, gt=0.0)


class Specimen(DeclaredSection):
    """One motion that follows a load."""

    motion: Motion
    load: Quantity
