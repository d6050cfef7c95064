from .film import Film as Film
from .film import animate as animate
from .formats import export_moves as export_moves
from .formats import export_plan as export_plan
from .tradeoff.page import TradeOffPage as TradeOffPage
from .tradeoff.page import trade_off as trade_off
