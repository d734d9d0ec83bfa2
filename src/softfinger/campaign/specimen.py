"""A specimen: anything with one degree of freedom.

It is measured in any unit.
"""

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
    """A measured quantity and its unit.

    "1" where it has none.
    """

    quantity: Words
    unit: Unit


class Motion(Quantity):
    """The motion, and its noise where known.

    The noise is an sd in the motion's own unit.
    """

    noise_sd: float | None = Field(default=None, gt=0.0)


class Specimen(DeclaredSection):
    """A motion that follows a load.

    It has one degree of freedom.
    """

    motion: Motion
    load: Quantity
