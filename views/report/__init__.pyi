from .report import Report as Report
from .terminal import show as show
from .terminal import show_facts as show_facts
