{% set names = axes | map(attribute="name") | list %}
{% set places %}{% for one in names %}{{ ", " if loop.index > 1 }}double at_{{ one }}{% endfor %}{% endset %}
{% set given %}{% if axes %}const double coefficients[{{ size }}], {% for one in names if one in move %}double {{ one }}, {% endfor %}{% endif %}{% endset %}
{% set moving = move.values() | list %}
/* {{ name }}: {{ title | comment }}. By quietarm {{ version | comment }}. */
#include "{{ name }}.h"

#include <math.h>

{% for helper in helpers %}
static {{ helper }}

{% endfor %}
/* The path over the share of the duration arg[0], of coefficients arg[1] and of start, target and
   duration arg[2]: res[0] is {% if joints %}the joints' positions, speeds and accelerations{% else %}angle, speed and acceleration{% endif %}. */
static void path(const double **arg, double **res)
{
{{ statements }}
}
{% if axes %}

#define AXES {{ axes | length }}
#define MOST {{ most }}

{% for axis in axes %}
static const double values_{{ loop.index }}[] = { {{- axis.values | row -}} };
{% endfor %}
static const double *const values[AXES] = { {%- for _ in axes %}{{ ", " if loop.index > 1 }}values_{{ loop.index }}{% endfor %} };
static const int lengths[AXES] = { {%- for axis in axes %}{{ ", " if loop.index > 1 }}{{ axis.values | length }}{% endfor %} };

/* Cells along an axis that the polynomial of each box goes through; 0 where there is none. */
static const unsigned char orders[] = {
{% for box in between.orders.reshape(-1, between.orders.shape[-1]) %}
    {{ box | join(", ") }},
{% endfor %}
};
static const double cells[][{{ size }}] = {
{% for cell in no_plan(between.cells).reshape(-1, size) %}
    { {{- cell | row -}} },
{% endfor %}
};

int {{ name }}_plan({{ places }}, double coefficients[{{ size }}])
{
    const double at[AXES] = { {%- for one in names %}{{ ", " if loop.index > 1 }}at_{{ one }}{% endfor %} };
    int first[AXES], width[AXES], node[AXES], box = 0, order, i, j, k, cell;
    double weights[AXES][MOST], weight;

    for (k = 0; k < AXES; k++) {
        if (!(at[k] >= values[k][0] && at[k] <= values[k][lengths[k] - 1]))
            return 1;
        for (j = 0; j < lengths[k] - 2 && at[k] >= values[k][j + 1]; j++)
            ;
        first[k] = j;
        box = box * (lengths[k] - 1) + j;
    }
    order = orders[box];
    if (order == 0)
        return 2;
    for (k = 0; k < AXES; k++) {
        width[k] = order < lengths[k] ? order : lengths[k];
        first[k] -= width[k] / 2 - 1;
        if (first[k] > lengths[k] - width[k])
            first[k] = lengths[k] - width[k];
        if (first[k] < 0)
            first[k] = 0;
        for (i = 0; i < width[k]; i++) {
            const double *nodes = values[k] + first[k];
            weights[k][i] = 1.0;
            for (j = 0; j < width[k]; j++)
                if (j != i)
                    weights[k][i] *= (at[k] - nodes[j]) / (nodes[i] - nodes[j]);
        }
        node[k] = 0;
    }
    for (i = 0; i < {{ size }}; i++)
        coefficients[i] = 0.0;
    for (;;) {
        weight = 1.0;
        cell = 0;
        for (k = 0; k < AXES; k++) {
            weight *= weights[k][node[k]];
            cell = cell * lengths[k] + first[k] + node[k];
        }
        for (i = 0; i < {{ size }}; i++)
            coefficients[i] += weight * cells[cell][i];
        for (k = AXES - 1; k >= 0 && ++node[k] == width[k]; k--)
            node[k] = 0;
        if (k < 0)
            return 0;
    }
}
{% else %}

static const double coefficients[] = { {{- coefficients | row or "0.0" -}} };
{% endif %}

{% if joints %}
{% if not axes %}
/* Where the joints rest before and after the move. */
static const double start[] = { {{- ends[0] | row -}} };
static const double target[] = { {{- ends[1] | row -}} };

{% endif %}
const char *const {{ name }}_joints[{{ upper }}_JOINTS] = {
{% for joint in joints %}
    {{ joint | string }},
{% endfor %}
};

void {{ name }}_at({{ given }}double time, double position[{{ upper }}_JOINTS],
    double speed[{{ upper }}_JOINTS], double acceleration[{{ upper }}_JOINTS])
{
    const double move[] = { {{- moving | join(", ") -}} };
    double fraction, joint[3 * {{ upper }}_JOINTS];
    const double *arg[] = { &fraction, coefficients, move };
    double *res[] = { joint };
    int i, moves;

    fraction = time / move[2];
    moves = fraction > 0.0 && fraction < 1.0; /* not where it is no number */
{% if axes %}
    if (!moves)
        fraction = fraction >= 1.0 ? 1.0 : 0.0;
    path(arg, res);
{% else %}
    if (moves)
        path(arg, res);
{% endif %}
    for (i = 0; i < {{ upper }}_JOINTS; i++) {
        position[i] = {% if axes %}joint[i]{% else %}moves ? joint[i] : fraction >= 1.0 ? target[i] : start[i]{% endif %};
        speed[i] = moves ? joint[{{ upper }}_JOINTS + i] : 0.0;
        acceleration[i] = moves ? joint[2 * {{ upper }}_JOINTS + i] : 0.0;
    }
}
{% else %}
void {{ name }}_at({{ given }}double time,
    double *angle, double *speed, double *acceleration)
{
    const double move[] = { {{- moving | join(", ") -}} };
    double fraction, joint[3];
    const double *arg[] = { &fraction, coefficients, move };
    double *res[] = { joint };

    fraction = time / move[2];
    if (!(fraction > 0.0 && fraction < 1.0)) { /* also where it is no number */
        *angle = fraction >= 1.0 ? move[1] : move[0];
        *speed = 0.0;
        *acceleration = 0.0;
        return;
    }
    path(arg, res);
    *angle = joint[0];
    *speed = joint[1];
    *acceleration = joint[2];
}
{% endif %}
