from .baselines import BASELINES as BASELINES
from .baselines import baseline as baseline
from .baselines import fastest_baseline as fastest_baseline
from .compared_motions import ComparedMotion as ComparedMotion
from .compared_motions import judge_motion as judge_motion
from .front_comparison import Comparison as Comparison
from .front_comparison import compare_fronts as compare_fronts
from .plan_comparison import compare_plans as compare_plans
