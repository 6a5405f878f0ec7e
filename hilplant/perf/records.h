/* What the step in C reads, remembers and shows: rows as hilplant/models/records.py packs them, SI units. */
#ifndef HILPLANT_RECORDS_H
#define HILPLANT_RECORDS_H

#include <math.h>

#define TURN 6.283185307179586476925
enum { DIGITAL, MECHANICAL, DEPRESSED };
enum { WIPING, TURNING_BACK, PARKED };
enum { NO_LOAD, POLYNOMIAL, REDUCED };

typedef struct { double resistance, inductance, constant; } Brush;
typedef struct { Brush slow, fast; double inertia, damping, coulomb, ratio, efficiency, back_efficiency; } Motor;
typedef struct { double angle, half_window, hysteresis, bounce_ticks, circuit, reverse_angle; } ParkSwitch;
typedef struct { double dry[4], wet[7], tacky[4], velocity_limit; } Friction;
typedef struct { double force, wear; } Blade;
typedef struct { double model, c1, c2, points; Friction friction; Blade left, right; } Load;
typedef struct { double offset, length; } Arm;
typedef struct { double step; Motor motor; ParkSwitch park_switch; Load load; Arm left_arm, right_arm; } Parameters;

typedef struct { double current, speed, angle, contact, bounce_left, guard, park_phase; } State;

typedef struct {
    double relay_on, relay_fast, supply, screen, vehicle_speed, brake;
    double left_screen, right_screen, left_wear, right_wear, left_force, right_force;
} Inputs;

/* All are doubles alone, so a row is a record. */
_Static_assert(sizeof(Parameters) == 47 * sizeof(double), "parameters as records.py packs them");
_Static_assert(sizeof(State) == 7 * sizeof(double), "the state as records.py packs it");
_Static_assert(sizeof(Inputs) == 12 * sizeof(double), "the inputs as records.py packs them");

typedef struct { const double *numbers; long knots, channels; } Table;

#endif
