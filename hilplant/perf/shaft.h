/* Motor, gear and load together over one step; models/gear.py and models/shaft.py. */
#ifndef HILPLANT_SHAFT_H
#define HILPLANT_SHAFT_H

#include "armature.h"
#include "circuit.h"
#include "load.h"

enum { SHAFT_STRETCHES = 64 };
static const double CHANGE = 0.25, SLOW = 0.01, SHORTEST = 1.0 / 40.0;

typedef struct {
    const Connection *connection;
    const Table *table;
    const Inputs *in;
    const Parameters *p;
} Train;
typedef struct { double stretch; Motion half_way; } Ahead;

static inline Drive through_gear(const Resistance *load, double direction, Motion motion, const Train *train)
{
    const Connection *connection = train->connection;
    const Motor *motor = &train->p->motor;
    const Brush *brush = connection->brush;
    const double constant = connection->closed ? brush->constant : 0.0, ratio = motor->ratio;
    const double torque = direction * (constant * motion.current - motor->damping * motion.speed) - motor->coulomb;
    const double dry = direction * load->bias + load->dry;
    const int driving
        = load->inertia * torque / ratio + (dry + load->slope * fabs(motion.speed) / ratio) * motor->inertia >= 0.0;
    const double passing = driving ? 1.0 / (ratio * motor->efficiency) : motor->back_efficiency / ratio;
    return (Drive){connection->closed ? connection->terminal : 0.0, brush->resistance, brush->inductance, constant,
                   motor->inertia + load->inertia * passing / ratio, motor->damping + load->slope * passing / ratio,
                   motor->coulomb + dry * passing};
}

static inline double held_torque(const Resistance *load, double direction, const Motor *motor)
{
    const double torque = direction * load->bias + load->dry;
    if (torque > 0.0) return motor->coulomb + torque / (motor->ratio * motor->efficiency);
    return motor->coulomb + torque * motor->back_efficiency / motor->ratio;
}

static inline double load_torque(Motion motion, const Resistance *load, const Train *train)
{
    if (motion.speed == 0.0) return 0.0;
    const double direction = copysign(1.0, motion.speed), ratio = train->p->motor.ratio;
    double torque = direction * load->bias + load->dry + load->slope * fabs(motion.speed) / ratio;
    if (load->inertia != 0.0) {
        const Drive drive = through_gear(load, direction, motion, train);
        torque += load->inertia * direction * acceleration(motion, &drive, direction * drive.dry) / ratio;
    }
    return torque;
}

/* Moves the motion on, returns the time taken, and leaves the direction of breaking away or 0. */
static inline double let_go(Motion *motion, const Drive *drive, const Resistance *load, double left, double *direction,
                            const Motor *motor)
{
    const Hold hold = {held_torque(load, 1.0, motor), held_torque(load, -1.0, motor)};
    *direction = direction_of(*motion, drive, hold);
    if (*direction != 0.0) return 0.0;
    const double taken = stick(motion, drive, hold, left);
    *direction = direction_of(*motion, drive, hold);
    return taken;
}

static inline Ahead look_ahead(Motion motion, const Drive *drive, double direction, double left, const Parameters *p)
{
    if (direction == 0.0) return (Ahead){left, motion};
    const double slow = SLOW * p->motor.ratio, back_emf = drive->constant * motion.speed;
    const double rising = (drive->voltage - drive->resistance * motion.current - back_emf) / drive->inductance;
    const double push = acceleration(motion, drive, direction * drive->dry);
    const double jerk = drive->constant * rising / drive->inertia;
    const double limit = CHANGE * fmax(fabs(motion.speed), slow);
    double stretch = left;
    if (left * (fabs(push) + 0.5 * fabs(jerk) * left) > limit) {
        stretch = 2.0 * limit / (fabs(push) + sqrt(push * push + 2.0 * fabs(jerk) * limit));
        stretch = fmin(left, fmax(SHORTEST * p->step, stretch));
    }
    const double mean = motion.speed + stretch * (0.5 * push + stretch * jerk / 6.0);
    const double turned = motion.turned + 0.5 * stretch * (motion.speed + 0.25 * stretch * push);
    return (Ahead){stretch, {motion.current + 0.5 * stretch * rising, direction * mean > 0.0 ? mean : 0.0, turned}};
}

static inline Motion turn_in_stretches(Motion motion, double angle, const Resistance *at_start, const Train *train)
{
    const Parameters *p = train->p;
    const double ratio = p->motor.ratio;
    double left = p->step, direction = 0.0;
    Drive drive = through_gear(at_start, copysign(1.0, motion.speed), motion, train);
    if (motion.speed == 0.0) left -= let_go(&motion, &drive, at_start, left, &direction, &p->motor);
    for (int k = 0; k < SHAFT_STRETCHES; ++k) {
        if (left <= 0.0) return motion;
        if (motion.speed != 0.0) direction = copysign(1.0, motion.speed);
        const Ahead ahead = look_ahead(motion, &drive, direction, left, p);
        const Place at = find(train->table, within_turn(angle + ahead.half_way.turned / ratio));
        const Resistance load = reduced(&at, ahead.half_way.speed / ratio, &p->load, train->in);
        if (direction == 0.0) {
            left -= let_go(&motion, &drive, &load, left, &direction, &p->motor);
        } else {
            drive = through_gear(&load, direction, ahead.half_way, train);
            left -= slide(&motion, &drive, direction, fmin(ahead.stretch, half_period(&drive)));
            direction = 0.0;
        }
    }
    return stand(motion, &drive, left);
}

static inline Motion turn(Motion motion, double angle, const Resistance *at_start, const Train *train)
{
    const Parameters *p = train->p;
    if (p->load.model == REDUCED) return turn_in_stretches(motion, angle, at_start, train);
    const double speed = motion.speed / p->motor.ratio, half_way = angle + 0.5 * p->step * speed;
    const Resistance held = by_speed(half_way, speed, &p->load, train->in);
    const Drive drive = through_gear(&held, 1.0, motion, train);
    return advance(motion, &drive, p->step);
}

#endif
