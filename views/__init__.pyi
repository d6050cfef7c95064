from . import pictures as pictures
from . import report as report
from .film import Film as Film
from .film import animate as animate
from .formats.formats import export_plan as export_plan
from .page.trade_off import TradeOffPage as TradeOffPage
from .page.trade_off import trade_off as trade_off
