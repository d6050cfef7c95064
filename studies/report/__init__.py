"""How results are reported: Markdown templates filled with values, tables and pictures."""

from quietarm.studies.report.report import Report as Report
from quietarm.studies.report.terminal import show as show
from quietarm.studies.report.terminal import show_facts as show_facts
