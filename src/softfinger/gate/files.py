"""Whether a file can be read, and its text."""

from pathlib import Path

from softfinger.faults import Fault


def find_obstacle(path: Path) -> str | None:
    """What prevents reading a file, or None.

    A folder, a pipe or a device is no file: reading one may never end.
    """
    try:
        if not path.exists():
            return "does not exist"
        if not path.is_file():
            return "is not an ordinary file"
        with path.open("rb"):
            return None
    except OSError as error:
        return f"cannot be read: {error.strerror or error}"
    except ValueError:
        return "has a name that no file can have"
    except RuntimeError:
        return "is a link that leads back to itself"


def read_text(path: Path, largest_bytes: int) -> str:
    """Text of a small file.

    It is UTF-8, with or without a byte-order mark, and with any line ends.

    Raises
    ------
    Fault
        It cannot be read, is larger than `largest_bytes`, is not UTF-8 or contains a NUL.
    """
    obstacle = find_obstacle(path)
    if obstacle:
        raise Fault(f"{str(path)[:300]}: the file {obstacle}")
    size = path.stat().st_size
    if size > largest_bytes:
        raise Fault(f"{path}: it has {size} bytes; expected at most {largest_bytes}")
    content = path.read_bytes()
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise Fault(
            f"{path}: byte {error.start} is not UTF-8 text; save the file as UTF-8"
        ) from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise Fault(f"{path}, line {line}: contains a NUL character; expected text")
    return text.replace("\r\n", "\n").replace("\r", "\n")
