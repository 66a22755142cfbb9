from .method import METHOD as METHOD
from .normal_newton import newton as newton
from .settings import NewtonSettings as NewtonSettings
