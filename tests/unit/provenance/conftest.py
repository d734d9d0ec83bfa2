"""Code that tests may edit, hashed as often as they like."""

import pytest

from softfinger.provenance import code, syntax


def forget() -> None:
    for cached in (
        code.code_hash, code._hash_file, code._locate_below, code._list_points, syntax.read_syntax
    ):  # fmt: skip
        cached.cache_clear()


@pytest.fixture
def rehash():
    """Hash of a stage's code as it is now."""

    def hash_again(*programs: str) -> str:
        forget()
        return code.code_hash(*programs)

    yield hash_again
    forget()


@pytest.fixture
def edit():
    """Replace the one place of a file where a text is."""

    def replace(path, old, new):
        text = path.read_text()
        assert text.count(old) == 1
        path.write_text(text.replace(old, new))

    return replace
