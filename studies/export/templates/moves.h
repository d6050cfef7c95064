/* {{ name }}: moves of {{ plant }}. By quietarm {{ version }}.
   {{ figures }}. */
#ifndef {{ guard }}
#define {{ guard }}

#define {{ guard }}_COEFFICIENTS {{ size }}

/* Coefficients of the move at {{ values | join(", ") }}.
   Returns 0; or, without writing any, 1 beyond the grid and 2 next to a cell without a plan or
   at a change of motion. */
int {{ name }}_plan(double {{ names | join(", double ") }}, double coefficients[{{ size }}]);

/* The joint's angle [rad], speed [rad/s] and acceleration [rad/s^2] on such a move, a time [s]
   after its start. */
void {{ name }}_at(const double coefficients[{{ size }}]{% for name in move_axes %}, double {{ name }}{% endfor %}, double time,
    double *angle, double *speed, double *acceleration);

#endif
