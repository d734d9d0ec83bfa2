"""The one gate for files of others."""

from softfinger.gate.document import Document, read_document, read_value
from softfinger.gate.files import find_obstacle, read_text

__all__ = ["Document", "find_obstacle", "read_document", "read_text", "read_value"]
