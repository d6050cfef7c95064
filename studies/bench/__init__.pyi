from .bench_page import bench_report as bench_report
from .results import Results as Results
from .results import quartiles as quartiles
