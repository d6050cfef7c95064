from .identification import identify as identify
from .identification import sought as sought
from .machine import Estimate as Estimate
from .machine import Identified as Identified
from .machine import Part as Part
from .prediction import Prediction as Prediction
from .prediction import predict as predict
from .signals.recording import Recording as Recording
