from . import identify as identify
from .recordings.recording import Recording as Recording
