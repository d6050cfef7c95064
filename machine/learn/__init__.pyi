from .learn import learn as learn
from .learning import Learning as Learning
