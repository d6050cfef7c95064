from .bench_page import bench_report as bench_report
from .iohprofiler import write_iohprofiler as write_iohprofiler
from .results import Results as Results
from .results import quartiles as quartiles
