from .baselines import BASELINES as BASELINES
from .baselines import baseline as baseline
from .front_comparison import Comparison as Comparison
from .front_comparison import compare_fronts as compare_fronts
from .judged_motions import Judged as Judged
from .judged_motions import judge as judge
from .plan_comparison import compare_plans as compare_plans
