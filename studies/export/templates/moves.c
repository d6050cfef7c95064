/* {{ name }}: moves of {{ plant }}. By quietarm {{ version }}. */
#include "{{ name }}.h"

#include <math.h>

#define AXES {{ names | length }}
#define MOST {{ most }}

{% for axis, values in axes %}
static const double values_{{ axis }}[] = { {{- values | row -}} };
{% endfor %}
static const double *const values[AXES] = { {{- "values_" ~ names | join(", values_") -}} };
static const int lengths[AXES] = { {{- lengths | join(", ") -}} };

/* Cells along an axis that the polynomial of each box goes through; 0 where there is none. */
static const unsigned char orders[] = {
{% for box in orders %}
    {{ box | join(", ") }},
{% endfor %}
};
static const double cells[][{{ size }}] = {
{% for cell in cells %}
    { {{- cell | row -}} },
{% endfor %}
};

int {{ name }}_plan(double {{ names | join(", double ") }}, double coefficients[{{ size }}])
{
    const double at[AXES] = { {{- names | join(", ") -}} };
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

void {{ name }}_at(const double coefficients[{{ size }}]{% for name in move_axes %}, double {{ name }}{% endfor %}, double time,
    double *angle, double *speed, double *acceleration)
{
{% for name, value in constants.items() %}
    const double {{ name }} = {{ value | c }};
{% endfor %}
{% set start, target, duration = "start", "target", "duration" %}
{% include "export/templates/path.c" %}
}
