/* {{ name }}: {{ title }}. By quietarm {{ version }}.
   {{ figures }}. */
#ifndef QUIETARM_{{ upper }}_H
#define QUIETARM_{{ upper }}_H

{% if axes %}
#define {{ upper }}_COEFFICIENTS {{ size }}

/* Coefficients of the move at {{ units | join(", ") }}.
   Returns 0; or, without writing any, 1 beyond the grid and 2 next to a cell without a plan or
   at a change of motion. */
int {{ name }}_plan({{ places }}, double coefficients[{{ size }}]);

/* The joint's {{ way }}, speed [{{ unit }}/s] and acceleration [{{ unit }}/s^2] on such a move, a time [s]
   after its start. */
{% else %}
/* How long the move takes [s], and where the joint rests before and after it [{{ unit }}]. */
#define {{ upper }}_DURATION {{ move[2] }}
#define {{ upper }}_START {{ move[0] }}
#define {{ upper }}_TARGET {{ move[1] }}

/* The joint's {{ way }}, speed [{{ unit }}/s] and acceleration [{{ unit }}/s^2], a time [s] after the start. */
{% endif %}
void {{ name }}_at({{ given }}double time,
    double *angle, double *speed, double *acceleration);

#endif
