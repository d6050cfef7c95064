{% set names = axes | map(attribute="name") | list %}
{% set places %}{% for one in names %}{{ ", " if loop.index > 1 }}double at_{{ one }}{% endfor %}{% endset %}
{% set given %}{% if axes %}const double coefficients[{{ size }}], {% for one in names if one in move %}double {{ one }}, {% endfor %}{% endif %}{% endset %}
{% set moving = move.values() | list %}
/* {{ name }}: {{ title | comment }}. By quietarm {{ version | comment }}.
   {{ figures | comment }}. */
#ifndef QUIETARM_{{ upper }}_H
#define QUIETARM_{{ upper }}_H

{% if axes %}
#define {{ upper }}_COEFFICIENTS {{ size }}

/* Coefficients of the move at {% for axis in axes %}{{ ", " if loop.index > 1 }}{{ axis.name | comment }} [{{ axis.unit | comment }}]{% endfor %}.
   Returns 0; or, without writing any, 1 beyond the grid and 2 next to a cell without a plan or
   at a change of motion. */
int {{ name }}_plan({{ places }}, double coefficients[{{ size }}]);

{% if joints %}
/* How many joints move, and their names. */
#define {{ upper }}_JOINTS {{ joints | length }}
extern const char *const {{ name }}_joints[{{ upper }}_JOINTS];

/* Positions [{{ unit }}], speeds [/s] and accelerations [/s^2] of all joints on such a move, a
   time [s] after its start. They rest at the start before the move, and where a time or the duration is
   no number; at the target after it. */
void {{ name }}_at({{ given }}double time, double position[{{ upper }}_JOINTS],
    double speed[{{ upper }}_JOINTS], double acceleration[{{ upper }}_JOINTS]);
{% else %}
/* The joint's {{ "angle" if unit == "rad" else "position" }} [{{ unit }}], speed [{{ unit }}/s] and acceleration [{{ unit }}/s^2] on such a move, a time [s]
   after its start. The joint rests at the start before the move, and where a time or the duration is no
   number; at the target after it. */
{% endif %}
{% elif joints %}
/* How long the move takes [s], how many joints it has, and their names. */
#define {{ upper }}_DURATION {{ move.duration }}
#define {{ upper }}_JOINTS {{ joints | length }}
extern const char *const {{ name }}_joints[{{ upper }}_JOINTS];

/* Positions [{{ unit }}], speeds [/s] and accelerations [/s^2] of all joints, a time [s]
   after the start. They rest at the start before the move, and at a time that is no number; at the target after it. */
void {{ name }}_at(double time, double position[{{ upper }}_JOINTS],
    double speed[{{ upper }}_JOINTS], double acceleration[{{ upper }}_JOINTS]);
{% else %}
/* How long the move takes [s], and where the joint rests before and after it [{{ unit }}]. */
#define {{ upper }}_DURATION {{ move.duration }}
#define {{ upper }}_START {{ move.start }}
#define {{ upper }}_TARGET {{ move.target }}

/* The joint's {{ "angle" if unit == "rad" else "position" }} [{{ unit }}], speed [{{ unit }}/s] and acceleration [{{ unit }}/s^2], a time [s] after the start.
   The joint rests at {{ upper }}_START before the move, and at a time that is no number; at {{ upper }}_TARGET after it. */
{% endif %}
{% if not joints %}
void {{ name }}_at({{ given }}double time,
    double *angle, double *speed, double *acceleration);
{% endif %}

#endif
