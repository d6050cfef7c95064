from .answer import Estimate as Estimate
from .answer import Identified as Identified
from .answer import Part as Part
from .identification import identify as identify
from .prediction import Prediction as Prediction
from .prediction import predict as predict
from .recording import Recording as Recording
