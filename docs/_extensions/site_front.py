"""The fronts of the page that the site shows first."""

from dataclasses import replace
from math import pi

import quietarm as qa
from quietarm.studies.reproduce.paper import paper_points
from quietarm.views import trade_off


def page_of_fronts():
    """The page to drag along fronts: two plants, a weaker motor, and a search beside them."""
    link, arm = qa.SingleLinkManipulator(), qa.ArmOnFlexibleLink()
    sixth = qa.PointToPoint(link, target=pi / 6, duration=0.8)
    weaker = replace(sixth, torque_limit=0.15)
    half = qa.PointToPoint(arm, target=pi / 2, duration=0.8)
    fronts = {
        "Flexible link": qa.epsilon_front(sixth, bound=0.2),
        "Same link, weaker motor": qa.epsilon_front(weaker, qa.CycloidPolynomial(6), bound=0.2),
        "Arm on a flexible link": qa.epsilon_front(half, bound=0.5),
        "searched": qa.search(sixth, algorithm="nsga2", bound=0.2, seed=0),
    }
    return trade_off(fronts, known_points=paper_points)
