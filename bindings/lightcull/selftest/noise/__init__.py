"""A battery of situations of few lights: is the default sampler right, and never much noisier than
the best of the others?"""

from .battery import all_situations
from .known_misses import KNOWN_EVEN_MISSES, KNOWN_MISSES
from .measure import Row, measure

__all__ = ["KNOWN_EVEN_MISSES", "KNOWN_MISSES", "Row", "all_situations", "measure"]
