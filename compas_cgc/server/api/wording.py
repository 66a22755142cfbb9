"""Messages of the checks with fields of a request instead of Python functions."""

from __future__ import annotations

from ...errors import Sentence
from ...errors import sentence_of

__all__ = ["in_request_words"]

WORDS = (
    ("mesh.set_supports('boundary') or --supports boundary fixes the whole boundary", 'supports "boundary" fixes the whole boundary'),
    ("mesh.set_supports([...])", "a list of vertices as supports"),
    (" (mesh.set_creases)", ""),
    (" (mesh.set_target(K), or --target K)", ", as targets"),
    (" (mesh.set_target(K, region=r))", " in targets"),
    (" (mesh.set_target(K))", ", as targets"),
)


def in_request_words(sentence: object) -> Sentence:
    """Return a message, or that of an error, with fields of a request instead of calls of Python functions; its remedies are kept."""
    said = sentence_of(sentence) if isinstance(sentence, BaseException) else sentence
    text = str(said)
    for call, field in WORDS:
        text = text.replace(call, field)
    return Sentence(text, getattr(said, "remedies", ()))
