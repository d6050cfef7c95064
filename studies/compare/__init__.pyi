from .baselines import BASELINES as BASELINES
from .baselines import baseline as baseline
from .fronts import Comparison as Comparison
from .fronts import compare_fronts as compare_fronts
from .judged import Judged as Judged
from .judged import judge as judge
from .plans import compare_plans as compare_plans
