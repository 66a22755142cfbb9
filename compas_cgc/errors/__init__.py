"""Errors of the package; every message is a sentence that says how to solve the problem."""

from .arguments import is_own_sentence as is_own_sentence
from .arguments import names_what_was_meant as names_what_was_meant
from .classes import ArgumentError
from .classes import CGCError
from .classes import FileError
from .classes import MeshError
from .classes import ProblemError
from .names import did_you_mean as did_you_mean
from .names import find_attribute as find_attribute
from .names import nearest_name as nearest_name

__all__ = ["ArgumentError", "CGCError", "FileError", "MeshError", "ProblemError"]
