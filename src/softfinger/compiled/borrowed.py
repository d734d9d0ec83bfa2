"""Structures that functions borrow to work in them.

Numba counts every reference to an array that is taken out of a structure, by two atomic
instructions each time, which small arrays do not repay. What is borrowed nobody counts: it lives as
long as its owner does (`keep_alive`).
"""

from __future__ import annotations

from typing import Any

from numba.core import cgutils, types
from numba.core.datamodel import default_manager, models
from numba.core.extending import infer_getattr, intrinsic, lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, Signature
from numba.experimental.structref import _Utils

from softfinger.compiled.digest import digest_function


def _take_field(context: Any, builder: Any, kind: Borrowed, place: Any, name: str) -> Any:  # noqa: ANN401
    """Read a field: a structure as borrowed, an array as nobody's."""
    payload, field = kind.owner.get_data_type(), kind.owner.field_dict[name]
    whole = context.data_model_manager[payload].get_value_type().as_pointer()
    data = cgutils.create_struct_proxy(payload)(context, builder, ref=builder.bitcast(place, whole))
    value = getattr(data, name)
    if isinstance(field, types.StructRef):
        return _point_at(context, builder, field, value)
    if isinstance(field, types.Array):
        array = context.make_array(field)(context, builder, value=value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    return value


def _point_at(context: Any, builder: Any, owner: types.StructRef, value: Any) -> Any:  # noqa: ANN401
    place = _Utils(context, builder, owner).get_data_pointer(value)
    return builder.bitcast(place, cgutils.voidptr_t)


LOWERED = digest_function(_take_field)[:16]
"""Part of the type, so that no machine code is older than this."""


class Borrowed(types.Type):
    """The type of a structure that is borrowed."""

    def __init__(self, owner: types.StructRef, lowered: str = LOWERED) -> None:
        self.owner = owner
        super().__init__(f"Borrowed({lowered}, {owner.name})")


default_manager.register(Borrowed, models.OpaqueModel)
lower_getattr_generic(Borrowed)(_take_field)


@infer_getattr
class _Fields(AttributeTemplate):
    key = Borrowed

    def generic_resolve(self, kind: Borrowed, name: str) -> types.Type | None:
        field = kind.owner.field_dict.get(name)
        return Borrowed(field) if isinstance(field, types.StructRef) else field


@intrinsic
def borrow(_: Any, owner: types.Type) -> tuple[Signature, Any]:  # noqa: ANN401
    """Borrow a structure, which must outlive all that work in it."""
    kind = Borrowed(owner, LOWERED)

    def lower(context: Any, builder: Any, given: Signature, values: list) -> Any:  # noqa: ANN401
        return _point_at(context, builder, given.args[0], values[0])

    return kind(owner), lower


@intrinsic
def keep_alive(_: Any, owner: types.Type) -> tuple[Signature, Any]:  # noqa: ANN401
    """Keep a structure until here, by using it."""
    return types.void(owner), lambda context, builder, given, values: context.get_dummy_value()
