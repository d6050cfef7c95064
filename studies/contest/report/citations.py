"""BibTeX of what a contest used."""

from __future__ import annotations

from collections.abc import Iterable

from quietarm.metaheuristics.budget.run import MULTISTART, parts_of
from quietarm.studies.contest.names import is_own, method_in

_TEC = "IEEE Transactions on Evolutionary Computation"
_ALWAYS = ("casadi", "ipopt", "pymoo", "moocore", "numpy", "coco", "attainment")
_STATISTICS = ("scipy", "friedman", "demsar", "mannwhitney", "holm", "varghadelaney")
# kind, authors, title, where it appeared, year, volume, pages
_ENTRIES: dict[str, tuple[str, str, str, str, int, str, str]] = {
    "casadi": (
        "article", "Andersson, Joel A. E. and Gillis, Joris and Horn, Greg and Rawlings, James B. "
        "and Diehl, Moritz", "{CasADi}: a software framework for nonlinear optimization and "
        "optimal control", "Mathematical Programming Computation", 2019, "11", "1--36",
    ),
    "ipopt": (
        "article", "W{\\\"a}chter, Andreas and Biegler, Lorenz T.", "On the implementation of an "
        "interior-point filter line-search algorithm for large-scale nonlinear programming",
        "Mathematical Programming", 2006, "106", "25--57",
    ),
    "pymoo": (
        "article", "Blank, Julian and Deb, Kalyanmoy", "pymoo: multi-objective optimization in "
        "{Python}", "IEEE Access", 2020, "8", "89497--89509",
    ),
    "moocore": (
        "misc", "L{\\'o}pez-Ib{\\'a}{\\~n}ez, Manuel and Rook, Fergus", "moocore: core "
        "mathematical functions for multi-objective optimization",
        "https://multi-objective.github.io/moocore", 2024, "", "",
    ),
    "numpy": (
        "article", "Harris, Charles R. and others", "Array programming with {NumPy}", "Nature",
        2020, "585", "357--362",
    ),
    "coco": (
        "article", "Hansen, Nikolaus and Auger, Anne and Ros, Raymond and Mersmann, Olaf and "
        "Tu{\\v{s}}ar, Tea and Brockhoff, Dimo", "{COCO}: a platform for comparing continuous "
        "optimizers in a black-box setting", "Optimization Methods and Software", 2021, "36",
        "114--144",
    ),
    "attainment": (
        "incollection", "L{\\'o}pez-Ib{\\'a}{\\~n}ez, Manuel and Paquete, Lu{\\'i}s and "
        "St{\\\"u}tzle, Thomas", "Exploratory analysis of stochastic local search algorithms in "
        "biobjective optimization", "Experimental Methods for the Analysis of Optimization "
        "Algorithms, Springer", 2010, "", "209--222",
    ),
    "scipy": (
        "article", "Virtanen, Pauli and others", "{SciPy} 1.0: fundamental algorithms for "
        "scientific computing in {Python}", "Nature Methods", 2020, "17", "261--272",
    ),
    "friedman": (
        "article", "Friedman, Milton", "The use of ranks to avoid the assumption of normality "
        "implicit in the analysis of variance", "Journal of the American Statistical Association",
        1937, "32", "675--701",
    ),
    "demsar": (
        "article", "Dem{\\v{s}}ar, Janez", "Statistical comparisons of classifiers over multiple "
        "data sets", "Journal of Machine Learning Research", 2006, "7", "1--30",
    ),
    "mannwhitney": (
        "article", "Mann, Henry B. and Whitney, Donald R.", "On a test of whether one of two "
        "random variables is stochastically larger than the other",
        "Annals of Mathematical Statistics", 1947, "18", "50--60",
    ),
    "holm": (
        "article", "Holm, Sture", "A simple sequentially rejective multiple test procedure",
        "Scandinavian Journal of Statistics", 1979, "6", "65--70",
    ),
    "varghadelaney": (
        "article", "Vargha, Andr{\\'a}s and Delaney, Harold D.", "A critique and improvement of "
        "the {CL} common language effect size statistics of {McGraw} and {Wong}",
        "Journal of Educational and Behavioral Statistics", 2000, "25", "101--132",
    ),
    "vepso": (
        "inproceedings", "Parsopoulos, Konstantinos E. and Vrahatis, Michael N.", "Particle swarm "
        "optimization method in multiobjective problems", "ACM Symposium on Applied Computing",
        2002, "", "603--607",
    ),
    "nsga2": (
        "article", "Deb, Kalyanmoy and Pratap, Amrit and Agarwal, Sameer and Meyarivan, T.",
        "A fast and elitist multiobjective genetic algorithm: {NSGA-II}", _TEC, 2002, "6",
        "182--197",
    ),
    "nsga3": (
        "article", "Deb, Kalyanmoy and Jain, Himanshu", "An evolutionary many-objective "
        "optimization algorithm using reference-point-based nondominated sorting approach, part "
        "{I}", _TEC, 2014, "18", "577--601",
    ),
    "unsga3": (
        "article", "Seada, Haitham and Deb, Kalyanmoy", "A unified evolutionary optimization "
        "procedure for single, multiple, and many objectives", _TEC, 2016, "20", "358--369",
    ),
    "spea2": (
        "techreport", "Zitzler, Eckart and Laumanns, Marco and Thiele, Lothar", "{SPEA2}: "
        "improving the strength {Pareto} evolutionary algorithm", "TIK-Report 103, ETH Zurich",
        2001, "", "",
    ),
    "smsemoa": (
        "article", "Beume, Nicola and Naujoks, Boris and Emmerich, Michael", "{SMS-EMOA}: "
        "multiobjective selection based on dominated hypervolume",
        "European Journal of Operational Research", 2007, "181", "1653--1669",
    ),
    "moead": (
        "article", "Zhang, Qingfu and Li, Hui", "{MOEA/D}: a multiobjective evolutionary "
        "algorithm based on decomposition", _TEC, 2007, "11", "712--731",
    ),
    "rvea": (
        "article", "Cheng, Ran and Jin, Yaochu and Olhofer, Markus and Sendhoff, Bernhard",
        "A reference vector guided evolutionary algorithm for many-objective optimization", _TEC,
        2016, "20", "773--791",
    ),
    "ctaea": (
        "article", "Li, Ke and Chen, Renzhi and Fu, Guangtao and Yao, Xin", "Two-archive "
        "evolutionary algorithm for constrained multiobjective optimization", _TEC, 2019, "23",
        "303--315",
    ),
}  # fmt: skip
_PLACES = {
    "article": "journal", "incollection": "booktitle", "inproceedings": "booktitle",
    "techreport": "institution", "misc": "howpublished",
}  # fmt: skip


def bibtex(methods: Iterable[str], *, statistics: bool) -> str:
    """References to the methods, the software and the statistics of a contest."""
    methods = list(methods)
    searches = dict.fromkeys(parts_of(method_in(method))[0] for method in methods if is_own(method))
    elsewhere = [method for method in methods if not is_own(method)]
    keys = [*_ALWAYS, *(_STATISTICS if statistics else ())]
    unknown = [one for one in searches if one not in _ENTRIES and one != MULTISTART]
    keys += [one for one in searches if one in _ENTRIES]
    comments = [f"% {one}: see {source_of(one)}" for one in unknown]
    comments += [f"% {one}: results from elsewhere" for one in elsewhere]
    return "\n\n".join([*(_entry(key) for key in keys), *comments]) + "\n"


def source_of(search: str) -> str:
    """Who published a search, and when, as its preset says."""
    from quietarm.metaheuristics import PRESETS

    return PRESETS[search].source


def _entry(key: str) -> str:
    kind, authors, title, place, year, volume, pages = _ENTRIES[key]
    fields = {"author": authors, "title": title, _PLACES[kind]: place, "year": str(year),
              "volume": volume, "pages": pages}  # fmt: skip
    lines = [f"  {name} = {{{value}}}," for name, value in fields.items() if value]
    return "\n".join([f"@{kind}{{{key},", *lines, "}"])
