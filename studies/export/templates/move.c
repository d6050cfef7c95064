/* {{ name }}: {{ move }}. By quietarm {{ version }}. */
#include "{{ name }}.h"

#include <math.h>

void {{ name }}_at(double time, double *angle, double *speed, double *acceleration)
{
{% set start, target, duration = guard ~ "_START", guard ~ "_TARGET", guard ~ "_DURATION" %}
{% include "export/templates/path.c" %}
}
