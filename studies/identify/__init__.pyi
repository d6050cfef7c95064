from .answer import Estimate as Estimate
from .answer import Fitted as Fitted
from .answer import Identified as Identified
from .identification import identify as identify
from .recording import Recording as Recording
