/* Table over the crank angle, friction and load; models/lookup.py, friction.py, polynomial.py and load.py. */
#ifndef HILPLANT_LOAD_H
#define HILPLANT_LOAD_H

#include "records.h"

enum { LEFT_ROCKER, RIGHT_ROCKER, INERTIA, GRAVITY, DRAG, LEFT_LIFT, RIGHT_LIFT, DAMPING, POINTS };
static const double SATURATED = 20.0, TACKY = 0.5, SLOWEST = 0.005, MM_PER_M = 1000.0;

/* Two neighbouring knots, and the weights of their values and derivatives. */
typedef struct {
    const double *near, *far;
    double value_0, value_1, slope_0, slope_1, value_rate, slope_0_rate, slope_1_rate;
} Place;
typedef struct { double mu, slope; } Coefficient;
typedef struct { double force, wetness, wear; } Pressing;
typedef struct { double inertia, bias, dry, slope; } Resistance;

static inline double within_turn(double angle)
{
    if (0.0 <= angle && angle < TURN) return angle;
    const double wrapped = angle - TURN * floor(angle / TURN);
    return 0.0 <= wrapped && wrapped < TURN ? wrapped : wrapped * 0.0;
}

static inline Place find(const Table *table, double angle)
{
    const long intervals = table->knots - 1, width_of_row = 2 * table->channels;
    const double width = TURN / intervals;
    double place = angle * (intervals / TURN);
    if (!(0.0 <= place && place < intervals)) place = 0.0;
    const long index = (long)place;
    const double u = place - index, value_1 = u * u * (3.0 - 2.0 * u), away = 1.0 - u;
    const double *near = table->numbers + index * width_of_row;
    return (Place){near, near + width_of_row, 1.0 - value_1, value_1, width * u * away * away, -width * u * u * away,
                   6.0 * u * away / width, away * (1.0 - 3.0 * u), u * (3.0 * u - 2.0)};
}

static inline double value(const Place *at, int channel)
{
    const double *near = at->near + 2 * channel, *far = at->far + 2 * channel;
    return (at->value_0 * near[0] + at->value_1 * far[0]) + (at->slope_0 * near[1] + at->slope_1 * far[1]);
}

static inline double derivative(const Place *at, int channel)
{
    const double *near = at->near + 2 * channel, *far = at->far + 2 * channel;
    return at->value_rate * (far[0] - near[0]) + (at->slope_0_rate * near[1] + at->slope_1_rate * far[1]);
}

static inline Coefficient bend(double rate, double velocity)
{
    const double x = rate * velocity;
    if (x > SATURATED) return (Coefficient){1.0, 0.0};
    const double e = exp(-2.0 * x), t = (1.0 - e) / (1.0 + e);
    return (Coefficient){t, rate * (1.0 - t * t)};
}

static inline Coefficient dry(double velocity, const double *c)
{
    const Coefficient knee = bend(c[1], velocity), step = bend(c[3], velocity);
    return (Coefficient){c[0] * knee.mu + c[2] * step.mu, c[0] * knee.slope + c[2] * step.slope};
}

static inline Coefficient tacky(double velocity, const double *c)
{
    const Coefficient rise = bend(c[1], velocity), fall = bend(c[3], velocity);
    const double both = c[0] + c[2];
    return (Coefficient){both * rise.mu - c[2] * fall.mu, both * rise.slope - c[2] * fall.slope};
}

static inline Coefficient wet(double velocity, double force, const double *c)
{
    const Coefficient rise = bend(c[1], velocity), fall = bend(c[2], velocity), step = bend(c[4], velocity);
    const double by_force = c[6] * force + c[3];
    const double shape = c[0] * (rise.mu - fall.mu) + c[3] * step.mu - c[5] * velocity;
    const double slope = c[0] * (rise.slope - fall.slope) + c[3] * step.slope - c[5];
    if (by_force <= 0.0 || shape <= 0.0) return (Coefficient){0.0, 0.0};
    return (Coefficient){by_force * shape, by_force * slope};
}

static inline Coefficient coefficient(double velocity, double wetness, double force, const Friction *friction)
{
    const double moving = velocity > friction->velocity_limit ? friction->velocity_limit : velocity;
    const double water = wetness < 0.0 ? 0.0 : wetness > 1.0 ? 1.0 : wetness;
    const double share = 1.0 - fabs(water - TACKY) / TACKY;
    Coefficient sum = {0.0, 0.0};
    if (share > 0.0) {
        sum = tacky(moving, friction->tacky);
        sum = (Coefficient){share * sum.mu, share * sum.slope};
    }
    if (share < 1.0) {
        const Coefficient other = water > TACKY ? wet(moving, force, friction->wet) : dry(moving, friction->dry);
        sum = (Coefficient){sum.mu + (1.0 - share) * other.mu, sum.slope + (1.0 - share) * other.slope};
    }
    if (velocity > friction->velocity_limit) sum.slope = 0.0;
    return sum;
}

static inline double pressed(const Place *at, int lift, const Blade *blade, double factor, double vehicle_speed)
{
    double force = blade->force * factor;
    if (vehicle_speed != 0.0) force -= vehicle_speed * vehicle_speed * value(at, lift);
    return force > 0.0 ? force : 0.0;
}

static inline Pressing left_pressing(const Place *at, const Load *load, const Inputs *in)
{
    return (Pressing){pressed(at, LEFT_LIFT, &load->left, in->left_force, in->vehicle_speed),
                      in->left_screen >= 0.0 ? in->left_screen : in->screen, load->left.wear * in->left_wear};
}

static inline Pressing right_pressing(const Place *at, const Load *load, const Inputs *in)
{
    return (Pressing){pressed(at, RIGHT_LIFT, &load->right, in->right_force, in->vehicle_speed),
                      in->right_screen >= 0.0 ? in->right_screen : in->screen, load->right.wear * in->right_wear};
}

/* Torque of one blade's friction at the crank, and its derivative by the crank's speed. */
static inline Coefficient rub(const Place *at, int first, double speed, Pressing blade, const Load *load)
{
    Coefficient sum = {0.0, 0.0};
    if (blade.force == 0.0) return sum;
    const int points = (int)load->points;
    for (int point = 0; point < points; ++point) {
        const double way = fabs(value(at, first + point));
        const Coefficient one = coefficient(MM_PER_M * way * speed, blade.wetness, blade.force, &load->friction);
        sum.mu += way * one.mu;
        sum.slope += way * way * one.slope;
    }
    const double share = blade.wear * blade.force / points;
    return (Coefficient){share * sum.mu, share * MM_PER_M * sum.slope};
}

static inline Resistance reduced(const Place *at, double crank_speed, const Load *load, const Inputs *in)
{
    const double turning = fabs(crank_speed), squared = turning * turning;
    double bias = 0.5 * squared * derivative(at, INERTIA) + value(at, GRAVITY);
    if (in->vehicle_speed != 0.0) bias += in->vehicle_speed * in->vehicle_speed * value(at, DRAG);
    const double speed = turning > SLOWEST ? turning : SLOWEST;
    const Coefficient left = rub(at, POINTS, speed, left_pressing(at, load, in), load);
    const Coefficient right = rub(at, POINTS + (int)load->points, speed, right_pressing(at, load, in), load);
    const double torque = left.mu + right.mu;
    double slope = left.slope + right.slope;
    if (slope < 0.0 || turning <= SLOWEST || slope * speed > torque) slope = 0.0;
    const double dry = in->brake + torque - slope * speed, damping = value(at, DAMPING);
    return (Resistance){value(at, INERTIA), bias, dry, slope + damping};
}

static inline Resistance by_speed(double angle, double speed, const Load *load, const Inputs *in)
{
    if (load->model != POLYNOMIAL) return (Resistance){0.0, 0.0, in->brake, 0.0};
    const double x = sin(angle);
    double shape;
    if (x >= 0.0) {
        shape = (((-0.19224 * x + 0.021769) * x - 0.15435) * x + 0.077812) * x + 0.68626;
    } else {
        shape = ((0.4184 * x - 0.30315) * x - 0.42441) * x + 0.12634;
        shape = (((shape * x + 0.21484) * x - 0.10093) * x - 0.29859) * x + 0.63276;
    }
    const double slope = load->c2 * (shape + speed * load->c1);
    return (Resistance){0.0, 0.0, in->brake, slope > 0.0 ? slope : 0.0};
}

#endif
