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
from .sentence import COARSER as COARSER
from .sentence import FINER as FINER
from .sentence import FOUND as FOUND
from .sentence import HALF as HALF
from .sentence import HALVED as HALVED
from .sentence import Remedy as Remedy
from .sentence import Sentence as Sentence
from .sentence import allow_more_steps as allow_more_steps
from .sentence import joined as joined
from .sentence import more_steps as more_steps
from .sentence import scaled as scaled
from .sentence import sentence_of as sentence_of
from .sentence import use_method as use_method
from .sentence import without_more_steps as without_more_steps

__all__ = ["ArgumentError", "CGCError", "FileError", "MeshError", "ProblemError"]
