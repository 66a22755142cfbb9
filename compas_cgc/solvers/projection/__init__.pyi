from .method import METHOD as METHOD
from .projector import Projector as Projector
from .projector import project as project
from .settings import ProjectionSettings as ProjectionSettings
