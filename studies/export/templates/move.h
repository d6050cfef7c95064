/* {{ name }}: {{ move }}. By quietarm {{ version }}; {{ figures }}. */
#ifndef {{ guard }}
#define {{ guard }}

/* How long the move takes [s], and where the joint rests before and after it [rad]. */
#define {{ guard }}_DURATION {{ values[2] | c }}
#define {{ guard }}_START {{ values[0] | c }}
#define {{ guard }}_TARGET {{ values[1] | c }}

/* The joint's angle [rad], speed [rad/s] and acceleration [rad/s^2], a time [s] after the start. */
void {{ name }}_at(double time, double *angle, double *speed, double *acceleration);

#endif
