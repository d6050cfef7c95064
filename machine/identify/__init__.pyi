from .identification import identify as identify
from .identification import sought as sought
from .identified import Estimate as Estimate
from .identified import Identified as Identified
from .identified import Part as Part
from .prediction import Prediction as Prediction
from .prediction import predict as predict
