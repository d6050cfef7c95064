"""Picture of when a tool may act against the energy that it takes."""

from __future__ import annotations

from matplotlib.figure import Figure

from quietarm.interrupts import interruptible
from quietarm.ocp.front.time_front import TimeFront
from quietarm.views.pictures.axes import head, new_figure
from quietarm.views.pictures.grammar import look
from quietarm.views.report.acting_words import ranges_words
from quietarm.views.report.words import title_of_picture
from quietarm.views.tips import tip_words


@interruptible
def time_front_figure(front: TimeFront) -> Figure:
    """Draw the energy of every duration over the time after which the tool may act.

    Each point has its duration beside it.
    """
    figure = new_figure(6.4, 4.4)
    ax = figure.subplots()
    ax.grid(alpha=0.25)
    line = look(0)
    ax.plot(front.times, front.energies, color=line.colour, marker=line.mark, linestyle="-")
    for point in front.points:
        ax.annotate(
            f"{point.duration:.3g} s",
            (point.acts_after, point.energy),
            textcoords="offset points",
            xytext=(6, 6),
        )
    band = tip_words(front.task.band or 0.0, "m")
    ax.set_xlabel(f"acts after [s], within {band} {ranges_words(front.task.ranges)}")
    ax.set_ylabel("energy [J]")
    ax.margins(0.12)  # for the words beside the points
    ax.set_ylim(bottom=0.0)
    head(figure, title_of_picture(front.task))
    return figure
